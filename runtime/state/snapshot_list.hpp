// What of a World changes while it runs: the one list from which states are saved, restored and compared.
//
// Whoever adds a member to one of the structs below gets a compiler error here. Bind its name, and then either hand it
// to the visitor or, if every step writes it before reading it or if it never changes, leave it at that.
#pragma once

#include "runtime/state/world_state.hpp"

namespace cdot {

// visit.item(name, index) begins an array, index telling those of one name apart; visit(x) hands it a number, a struct
// of numbers of the space's scalar type, or a vector of such.
struct StateList {
  template <class S, class Visitor>
  static void each(WorldState<S>& world, Visitor& visit) {
    auto& [settings, time, last_step, origin, bodies, ground, joints, batches, springs, drags, gyroscopes,
           breaking_loads, after_substep, notes, counts, on_failure, kept_time, kept_last_step, kept_counts,
           broken_in_step, prepared, islands, island_of, awake] = world;
    visit.item("time", -1);
    visit(time), visit(last_step);
    each_joint(joints, visit);  // must come second: restoring begins with it
    each_count(counts, visit);
    each_body(bodies, visit);
    if constexpr (S::has_gyroscopes)
      for (size_t k = 0; k < gyroscopes.size(); ++k) each_gyroscope(gyroscopes[k], static_cast<int>(k), visit);
    for (size_t k = 0; k < batches.size(); ++k) each_slot(*batches[k], static_cast<int>(k), visit);
    for (size_t k = 0; k < islands.size(); ++k)
      each_of_island(islands[k], static_cast<int>(k), world.needs_systems(), visit);
  }

  template <class S>
  static std::vector<unsigned char>& dependent(System<S>& system) {
    return system.ldlt_.dependent_;
  }

 private:
  template <class Visitor>
  static void each_joint(std::vector<JointRecord>& records, Visitor& visit) {
    visit.item("joints.broken", -1);
    for (JointRecord& record : records) visit(record.broken);
    visit.item("joints.slots", -1);  // those of broken joints have changed places
    for (JointRecord& record : records) {
      auto& [type, bodies, parameters, places, broken, added] = record;
      for (Place& place : places) visit(place.slot);
    }
    visit.item("joints.parameters", -1);
    for (JointRecord& record : records) visit(record.parameters);
  }

  template <class Visitor>
  static void each_count(StepCounts& counts, Visitor& visit) {
    auto& [evaluations, taken, rejected, events, rescued, retried, direct, shortest, longest] = counts;
    visit.item("counts", -1);
    visit(evaluations), visit(taken), visit(rejected), visit(events), visit(rescued), visit(retried), visit(direct);
    visit.item("counts.steps", -1);
    visit(shortest), visit(longest);
  }

  template <class S, class Visitor>
  static void each_body(Bodies<S>& all, Visitor& visit) {
    auto& [pose, velocity, inverse_mass, effective_mass, force, acceleration, velocity_rate, displacement, increment,
           stiffness, start] = all;
    visit.item("bodies.pose", -1), visit(pose);
    visit.item("bodies.velocity", -1), visit(velocity);
    visit.item("bodies.inverse_mass", -1), visit(inverse_mass);  // tensors turn
    visit.item("bodies.effective_mass", -1), visit(effective_mass);
    visit.item("bodies.force", -1), visit(force);
    visit.item("bodies.acceleration", -1), visit(acceleration);
    visit.item("bodies.velocity_rate", -1), visit(velocity_rate);
  }

  template <class T, class Visitor>
  static void each_gyroscope(spatial::Gyroscope<T>& gyroscope, int index, Visitor& visit) {
    auto& [body, inertia, inverse, world, torque, momentum, spin, lent] = gyroscope;
    visit.item("gyroscopes", index);
    visit(world), visit(torque), visit(momentum), visit(spin);
  }

  template <class S, class Visitor>
  static void each_slot(Batch<S>& batch, int index, Visitor& visit) {
    auto& [ops, law, kinds, joint, body, parameters, jacobian, factor, C, bias, lambda, correction, rate, error,
           impulse, counters, softness, lower, upper, mode, constants] = batch;
    visit.item("rows.joint", index), visit(joint);
    visit.item("rows.body", index), visit(body);
    visit.item("rows.parameters", index), visit(parameters);
    visit.item("rows.constants", index), visit(constants);
    visit.item("rows.jacobian", index), visit(jacobian);
    visit.item("rows.factor", index), visit(factor);
    visit.item("rows.C", index), visit(C);
    visit.item("rows.bias", index), visit(bias);
    visit.item("rows.lambda", index), visit(lambda);
    visit.item("rows.correction", index), visit(correction);
    visit.item("rows.counters", index), visit(counters);
    visit.item("rows.softness", index), visit(softness);
    visit.item("rows.lower", index), visit(lower);
    visit.item("rows.upper", index), visit(upper);
    visit.item("rows.mode", index), visit(mode);
  }

  template <class S, class Visitor>
  static void each_of_island(Island<S>& island, int index, bool direct, Visitor& visit) {
    auto& [bodies, segments, springs, drags, gyroscopes, system, rescue, solver, stiffened, redundant_rows, size, scale,
           restless, residual, evaluated, factored, continuous, flow, asleep, rested, kept, trouble] = island;
    visit.item("island.flags", index);
    visit(evaluated), visit(factored), visit(continuous), visit(asleep);
    visit.item("island.rows", index);
    visit(redundant_rows);
    for (Segment<S>& segment : segments) visit(segment.end);
    visit.item("island.residual", index), visit(residual), visit(size), visit(scale);
    visit.item("island.rested", index), visit(rested);
    each_of_flow(flow, index, visit);
    // The iterative solver alone needs none; projecting the start makes one nevertheless.
    if (direct) each_of_system(system, index, visit);
  }

  template <class S, class Visitor>
  static void each_of_flow(Flow<S>& flow, int index, Visitor& visit) {
    auto& [pose, velocity, search, start, now, rates, guarded, told, row_rates, margins, margins_chosen, low, high,
           at_start, next_step, longest, slivers, known, ahead, length, end_kept, end, end_forces, further_terms] =
        flow;
    visit.item("flow.told", index), visit(told);
    visit.item("flow.row_rates", index), visit(row_rates);
    visit.item("flow.margins", index), visit(margins), visit(margins_chosen);
    visit.item("flow.lengths", index);
    visit(next_step), visit(longest), visit(ahead), visit(length);
    visit.item("flow.slivers", index), visit(slivers);
    visit.item("flow.flags", index);
    visit(known), visit(end_kept);
    // The step whose end may lie ahead.
    visit.item("flow.start", index), visit(start);
    visit.item("flow.rates", index), visit(rates);
    visit.item("flow.end", index), visit(end);
    visit.item("flow.end_forces", index), visit(end_forces);
    visit.item("flow.further_terms", index), visit(further_terms);
  }

  template <class S, class Visitor>
  static void each_of_system(System<S>& system, int index, Visitor& visit) {
    auto& [b, lambda, softness, lower, upper, fixed, broken, blocks, tensions, built, lawful, taut, any_out,
           contradicted, softened, rows, dependent, ldlt, products, jacobian, weighted, right_side, product, shared,
           unmet, tension_of, out, held] = system;
    visit.item("system.slots", index);
    for (auto& block : blocks) visit(block.slot);
    for (auto& tension : tensions) visit(tension.slot);  // whose rows are slack between steps
    visit.item("system.lambda", index), visit(lambda);
    visit.item("system.softness", index), visit(softness);
    visit.item("system.lower", index), visit(lower);
    visit.item("system.upper", index), visit(upper);
    visit.item("system.unmet", index), visit(unmet);
    visit.item("system.dependent", index), visit(dependent);
    visit.item("system.flags", index);
    visit(fixed), visit(broken), visit(out), visit(held), visit(any_out), visit(contradicted), visit(softened);
    each_of_factor(ldlt, index, visit);
  }

  template <class Real, class Visitor>
  static void each_of_factor(BasicLdlt<Real>& ldlt, int index, Visitor& visit) {
    auto& [first, diagonal, column_of, columns, panel_row, updates, values, l, inverse, noise, doubtful, overstated,
           out, dependent, definite, any_out, factored, share, unscaled, given] = ldlt;
    visit.item("factor.K", index), visit(values);
    visit.item("factor.L", index), visit(l);
    visit.item("factor.inverse", index), visit(inverse), visit(noise);
    visit.item("factor.flags", index);
    visit(out), visit(dependent), visit(any_out), visit(factored);
  }
};

}  // namespace cdot
