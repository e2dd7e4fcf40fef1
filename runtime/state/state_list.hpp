// The one list of all StateNumbers and StateArrays. It determines their order in the block, their names and their
// islands.
//
// A new member of a State struct is a compiler error here until it is on the list.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// visit.item(name, index, in_steps) begins an item; index numbers items of the same name (-1: only one); in_steps: a
// step may change the item. visit(x) adds a StateNumber or a StateArray to the item. All numbers of an item have one
// type.
struct StateList {
  template <class S, class Visitor>
  static void each(WorldData<S>& world, Visitor& visit) {
    each_in_common(world, visit);
    each_body(world.bodies, true, visit);
    if constexpr (S::has_gyroscopes) visit.item("gyroscopes", -1, true), visit(world.gyroscopes);
    for (std::size_t k = 0; k < world.batches.size(); ++k)
      each_slot(*world.batches[k], static_cast<int>(k), true, visit);
    for (std::size_t k = 0; k < world.islands.size(); ++k)
      each_of_island(world.islands[k], static_cast<int>(k), world.needs_systems(), visit);
  }

  // masses_change: tensors turn, or steps add geometric stiffness.
  template <class S, class Visitor>
  static void each_body(Bodies<S>& bodies, bool masses_change, Visitor& visit) {
    auto& [pose, velocity, inverse_mass, effective_mass, force, acceleration, velocity_rate] =
        static_cast<BodiesState<S>&>(bodies);
    visit.item("bodies.pose", -1, true), visit(pose);
    visit.item("bodies.velocity", -1, true), visit(velocity);
    visit.item("bodies.inverse_mass", -1, masses_change), visit(inverse_mass);
    visit.item("bodies.effective_mass", -1, masses_change), visit(effective_mass);
    visit.item("bodies.force", -1, false), visit(force);
    visit.item("bodies.acceleration", -1, masses_change), visit(acceleration);
    visit.item("bodies.velocity_rate", -1, true), visit(velocity_rate);
  }

  // breaks: slots may change places.
  template <class S, class Visitor>
  static void each_slot(Batch<S>& batch, int index, bool breaks, Visitor& visit) {
    auto& [home, joint, body, parameters, counters, lambda, correction, mode, softness, lower, upper, constants,
           happened, spans] = static_cast<BatchState<S>&>(batch);
    const bool driven = batch.driven(), counts = batch.ops && batch.ops->start_counting;  // turns, in parameters too
    visit.item("rows.home", index, breaks), visit(home);
    visit.item("rows.joint", index, breaks), visit(joint);
    visit.item("rows.body", index, breaks), visit(body);
    visit.item("rows.parameters", index, breaks || counts || driven), visit(parameters);
    visit.item("rows.counters", index, true), visit(counters);
    visit.item("rows.lambda", index, true), visit(lambda);
    visit.item("rows.correction", index, true), visit(correction);
    visit.item("rows.mode", index, true), visit(mode);
    visit.item("rows.softness", index, true), visit(softness);
    visit.item("rows.bounds", index, true), visit(lower), visit(upper);
    const bool turns = batch.law && batch.law->cone_rows > 0;  // the direction of a force
    visit.item("rows.constants", index, breaks || driven || turns), visit(constants);
    if (batch.law && batch.law->distance) visit.item("rows.happened", index, true), visit(happened);
    if (!spans.empty()) visit.item("rows.spans", index, true), visit(spans);
  }

  // The iterative solver needs no system, but the projection of the start builds one.
  template <class S, class Visitor>
  static void each_of_island(Island<S>& island, int index, bool has_system, Visitor& visit) {
    auto& [size, scale, residual, left, evaluated_at, evaluated, factored, acceleration_level, asleep, rested,
           redundant_rows, gained, level, levelled, slack, momentum] = static_cast<IslandState<S>&>(island);
    visit.item("island.numbers", index, true), visit(size), visit(scale), visit(residual), visit(evaluated_at);
    visit.item("island.left", index, true), visit(left);
    visit.item("island.flags", index, true), visit(evaluated), visit(factored), visit(acceleration_level),
        visit(asleep), visit(levelled);
    visit.item("island.rested", index, true), visit(rested);
    visit.item("island.gained", index, true), visit(gained), visit(level);
    visit.item("island.slack", index, true), visit(slack);
    visit.item("island.redundant_rows", index, true), visit(redundant_rows);
    visit.item("island.momentum", index, true), visit(momentum);
    each_of_flow(island.flow, index, visit);
    if (has_system) each_of_system(island.system, index, visit);
  }

 private:
  template <class S, class Visitor>
  static void each_in_common(WorldData<S>& world, Visitor& visit) {
    auto& [time, last_step, counts, accounts, gyroscopes] = static_cast<State<S>&>(world);
    visit.item("time", -1, true), visit(time), visit(last_step);  // must come first: Snapshot::time()
    visit.counts(counts);
    auto& [open, changed, start, put_in, taken, before_change, by_source] = accounts;
    visit.item("accounts", -1, true), visit(start), visit(put_in), visit(taken), visit(before_change);
    visit.item("accounts.by_source", -1, true), visit(by_source);
    visit.item("accounts.flags", -1, true), visit(open), visit(changed);
    visit.common_ends();
    visit.item("joints.broken", -1, true);
    for (JointRecord& record : world.joints) visit(record.broken);
    visit.item("joints.left_out", -1, false);
    for (JointRecord& record : world.joints) visit(record.left_out);
    visit.item("joints.parameters", -1, false);
    for (JointRecord& record : world.joints) {
      auto& [broken, left_out, parameters] = static_cast<JointState&>(record);
      visit(parameters);
    }
  }

  template <class S, class Visitor>
  static void each_of_flow(Flow<S>& flow, int index, Visitor& visit) {
    auto& [resolution, row_rates, margins, margins_chosen, largest_diagonals, next_step, longest, slivers, exhausted,
           known, ahead, length, end_kept, start, end, end_forces, rates, further_terms, work] =
        static_cast<FlowState<S>&>(flow);
    visit.item("flow.resolution", index, true), visit(resolution);
    visit.item("flow.row_rates", index, true), visit(row_rates);
    visit.item("flow.margins", index, true), visit(margins), visit(margins_chosen);
    visit.item("flow.largest_diagonals", index, true), visit(largest_diagonals);
    visit.item("flow.lengths", index, true), visit(next_step), visit(longest), visit(ahead), visit(length);
    visit.item("flow.slivers", index, true), visit(slivers), visit(exhausted);
    visit.item("flow.flags", index, true), visit(known), visit(end_kept);
    visit.item("flow.start", index, true), visit(start);
    visit.item("flow.end", index, true), visit(end);
    visit.item("flow.end_forces", index, true), visit(end_forces);
    visit.item("flow.rates", index, true), visit(rates);
    visit.item("flow.further_terms", index, true), visit(further_terms);
    visit.item("flow.work", index, true), visit(work);
  }

  template <class S, class Visitor>
  static void each_of_system(System<S>& system, int index, Visitor& visit) {
    visit.item("system.active_set", index, true), visit(system.active_set());
    visit.item("system.redundant", index, true), visit(system.factors().dependent()),
        visit(system.factors().factored());
    visit.item("system.blur", index, true), visit(system.factors().blur());
  }
};

}  // namespace cdot
