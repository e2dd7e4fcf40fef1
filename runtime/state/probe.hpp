// One joint or coordinate at the present poses, in its own slot: queries use it and leave the World's rows unchanged.
#pragma once

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include <cdot/detail/joint_table.hpp>

#include "runtime/number/arbitrary.hpp"
#include "runtime/state/world_data.hpp"

namespace cdot {

template <class S>
class Probe {
 public:
  using T = typename S::Scalar;
  explicit Probe(const WorldData<S>& world) : world_(&world) {}
  // For another World, or the same at a later time: arrays keep their memory.
  void move_to(const WorldData<S>& world) { world_ = &world; }

  // Evaluates the rows of a joint, or the row of one of its coordinates, by the block for general bodies.
  void look_at(const JointRecord& joint, int coordinate = -1) {
    fill_slot(joint, coordinate);
    ops_->evaluate(batch_, 0, 1, bodies_, T(world_->time));
  }
  // The same of C alone.
  void look_at_C(const JointRecord& joint) {
    fill_slot(joint, -1);
    ops_->position(batch_, 0, 1, bodies_, T(world_->time));
  }

  int rows() const { return ops_->rows; }
  double C(int row) const { return double(batch_.C[row]); }

  // J v + dC/dt of every row.
  const std::vector<T>& Cdot() {
    ops_->velocity(batch_, 0, 1, bodies_.velocity.data(), batch_.rate.data());
    for (int r = 0; r < ops_->rows; ++r) batch_.rate[r] += batch_.bias[r];
    return batch_.rate;
  }

  // The forces of an effect's law along its rows, at the present rates.
  std::vector<T> forces(const Law<S>& law) {
    Cdot();
    batch_.law = &law;
    batch_.factor.assign(1, T(1));  // laws of tapes are told the effective mass, read or not
    std::vector<T> force(static_cast<size_t>(rows()));
    law.force(batch_, 0, batch_.rate.data(), force.data());
    return force;
  }

  // True if the law of an effect has a force and an energy here.
  bool has_value(const Law<S>& law) {
    const std::vector<T> force = forces(law);
    return std::all_of(force.begin(), force.end(), [](T F) { return std::isfinite(F); }) &&
           (!law.energy || std::isfinite(law.energy(batch_, 0)));
  }

  // The acceleration of the row's coordinate by a force of 1 along it: J M^-1 J'.
  T mobility(int row) { return pull_row(row); }

  // True at a kink of C, as where two points of a distance meet. A step along the row's M^-1 J^T then changes C by as
  // much as the opposite step, so J does not predict the change of C.
  bool at_kink(int row) {
    const T promised = pull_row(row);
    if (!(promised > T(0))) return false;
    // A small joint may have a kink nearby, and a large one does not resolve small steps, nor the square of a length
    // small changes. A kink must show at every scale, of C and of the poses.
    const T least = T(1e3) * resolution(), moved = longest_way();
    for (const T wanted : {T(1e-3), T(1e-6), T(1e-9), least, moved > T(0) ? least * promised / moved : T(0)}) {
      if (wanted == T(0)) continue;  // all bodies are at the origin
      const T forth = C_after(wanted / promised)[row], back = C_after(-wanted / promised)[row];
      if (!(std::abs(forth - back) < T(0.01) * T(2) * wanted)) return false;
    }
    return true;
  }

  // The first row whose C jumps here, as an angle does between axes that point in opposite directions; -1 if none. A
  // small motion of a body and a thousandth of that motion change such a C by the same amount. Counted whole turns are
  // no jump.
  int jumping_row() {
    const T hair = T(by_precision<T>(1e-2, 1e-6)), least = std::max(T(0.01), T(1e3) * resolution());
    const std::vector<T> here = batch_.C;
    std::vector<T> near(here.size());
    for (size_t k = 0; k < bodies_.pose.size(); ++k)
      for (int c = 0; c < S::freedom; ++c) {
        const T by = c < S::lengths ? hair * reach() : hair;
        near = C_moved(k, c, T(1e-3) * by);
        C_moved(k, c, by);
        for (size_t r = 0; r < here.size(); ++r) {
          const T jump = std::abs(batch_.C[r] - here[r]);
          if (jump > least && std::abs(near[r] - here[r]) > jump / 2) return static_cast<int>(r);
        }
      }
    return -1;
  }

  // True if a parameter that is 0 makes J jump, as a pitch by which a row divides.
  bool jumps_at_zero(int parameter) {
    T& number = batch_.parameters[parameter];
    if (number != T(0)) return false;
    const std::vector<T> J = batch_.jacobian;
    number = T(by_precision<T>(1e-4, 1e-9));
    ops_->evaluate(batch_, 0, 1, bodies_, T(world_->time));
    bool jumps = false;
    for (size_t k = 0; k < J.size(); ++k)
      jumps |= !(std::abs(batch_.jacobian[k] - J[k]) <= T(0.1) * (T(1) + std::abs(J[k])));
    number = T(0);
    ops_->evaluate(batch_, 0, 1, bodies_, T(world_->time));
    return jumps;
  }

  // False if Newton on this row alone, M^-1 J^T lambda with K lambda = -C, reaches C = 0 neither from here nor from
  // generic poses. A distance of a negative length is such a row. Changes the probe's poses.
  bool can_be_satisfied(int row, bool one_sided) {
    constexpr int starts = 32, rounds = 40;
    const T first = std::abs(C(row)), enough = std::max(T(1e-6) * first, T(64) * resolution()),
            around = std::max(reach(), T(1e-3));
    const auto here = bodies_.pose;
    Arbitrary arbitrary;
    bool movable = false;
    for (int start = 0; start < starts; ++start) {
      for (size_t k = 0; start > 0 && k < here.size(); ++k) {
        T by[S::freedom];
        for (int c = 0; c < S::freedom; ++c) by[c] = T(4 * arbitrary() - 2) * (c < S::lengths ? around : T(1));
        bodies_.pose[k] = S::moved(here[k], S::read_velocity(by));
      }
      for (int round = 0; round < rounds; ++round) {
        ops_->evaluate(batch_, 0, 1, bodies_, T(world_->time));
        const T C = batch_.C[row];
        if (std::abs(C) <= enough || (one_sided && C > T(0))) return true;
        const T K = pull_row(row);
        if (!(K > T(0)) || !std::isfinite(C)) break;
        movable = true;
        // At most 1 rad at once: an angle of the row may not be counted beyond half a turn.
        const T share = std::min(T(1), T(1) / std::max(T(1), std::abs(C / K) * fastest_turn()));
        for (size_t k = 0; k < here.size(); ++k)
          bodies_.pose[k] = S::moved(bodies_.pose[k], S::sum({}, bodies_.displacement[k], -share * C / K));
      }
    }
    return !movable;
  }

  // J and (M^-1 J^T)^T, [rows][freedom * bodies].
  void dense(ExactNumber<T>* J, ExactNumber<T>* weighted) const {
    std::vector<ExactNumber<T>> K(static_cast<size_t>(ops_->rows * ops_->rows));
    ops_->dense(batch_, 0, bodies_, J, weighted, K.data(), ops_->rows);
  }

  // J^T lambda on the body at this position in the joint: the change of velocity of a body of mass and inertia 1.
  typename S::Velocity impulse_on(int position, const std::vector<T>& lambda) {
    std::fill(bodies_.effective_mass.begin(), bodies_.effective_mass.end(), S::unit_mass());
    std::fill(bodies_.displacement.begin(), bodies_.displacement.end(), typename S::Velocity{});
    ops_->apply(batch_, 0, 1, bodies_, lambda.data(), bodies_.displacement.data());
    return bodies_.displacement[position];
  }

 private:
  void fill_slot(const JointRecord& joint, int coordinate) {
    const JointEntry<S>& entry = joint_entries<S>()[joint.type];
    const BlockVariants<S>& variants = coordinate < 0 ? entry.rows : entry.coordinates[coordinate];
    ops_ = variants.general;
    batch_.ops = ops_;
    batch_.parameters.assign(joint.parameters.begin(), joint.parameters.end());
    follow_time(joint);
    batch_.jacobian.assign(static_cast<size_t>(ops_->jacobian_size), T(0));
    for (auto* array : {&batch_.C, &batch_.bias, &batch_.rate}) array->assign(static_cast<size_t>(ops_->rows), T(0));
    batch_.body.resize(joint.bodies.size());
    bodies_.velocity.resize(joint.bodies.size());
    bodies_.displacement.resize(joint.bodies.size());
    bodies_.pose.resize(joint.bodies.size());
    bodies_.effective_mass.resize(joint.bodies.size());
    for (size_t k = 0; k < joint.bodies.size(); ++k) {
      const auto i = static_cast<size_t>(joint.bodies[k]);
      batch_.body[k] = static_cast<int>(k);
      bodies_.pose[k] = world_->bodies.pose[i];
      bodies_.velocity[k] = world_->bodies.velocity[i];
      bodies_.effective_mass[k] = world_->bodies.inverse_mass[i];
    }
    if (ops_->start_counting) count_on(joint, variants);
  }

  // The joint's own numbers in time; those of its effects stand in rows of their own.
  void follow_time(const JointRecord& joint) {
    batch_.drives.clear();
    for (const JointDrive& drive : joint.drives)
      if (drive.place < 0) batch_.drives.push_back(drive.drive);
    constexpr ProfileSpan always;
    batch_.first_drive = {0, static_cast<int>(batch_.drives.size())};
    batch_.home.assign(1, 0);
    batch_.spans = {always.from, always.until};
  }

  // displacement = M^-1 J^T of the row. Returns K of the row, the change of C that this predicts.
  T pull_row(int row) {
    std::vector<T> lambda(static_cast<size_t>(ops_->rows), T(0));
    lambda[row] = T(1);
    auto& step = bodies_.displacement;
    std::fill(step.begin(), step.end(), typename S::Velocity{});
    ops_->apply(batch_, 0, 1, bodies_, lambda.data(), step.data());
    ops_->velocity(batch_, 0, 1, step.data(), batch_.rate.data());
    return batch_.rate[row];
  }

  // Takes the whole turns that the World has counted, if any; otherwise starts at none.
  void count_on(const JointRecord& joint, const BlockVariants<S>& variants) {
    batch_.counters.assign(static_cast<size_t>(ops_->counters), T(0));
    ops_->start_counting(batch_, 0, bodies_, T(world_->time));
    for (const Place& place : joint.places) {
      const Batch<S>& kept = *world_->batches[place.batch];
      if (!variants.has(kept.ops)) continue;
      const auto from = kept.counters.begin() + slot_of(*world_, place) * kept.ops->counters;
      std::copy_n(from, kept.ops->counters, batch_.counters.begin());
    }
  }

  // The largest component of a rotation in the displacements.
  T fastest_turn() const {
    T fastest = 0, numbers[S::freedom];
    for (const auto& displacement : bodies_.displacement) {
      S::write(displacement, numbers);
      for (int c = S::lengths; c < S::freedom; ++c) fastest = std::max(fastest, std::abs(numbers[c]));
    }
    return fastest;
  }

  // The largest distance of a body from the first one, by component.
  T reach() const {
    T far = 0, from[S::pose_numbers], to[S::pose_numbers];
    S::write(bodies_.pose[0], from);
    for (const auto& pose : bodies_.pose) {
      S::write(pose, to);
      for (int c = 0; c < S::lengths; ++c) far = std::max(far, std::abs(to[c] - from[c]));
    }
    return far;
  }

  // The resolution of positions at the bodies' distance from the origin.
  T resolution() const {
    T far = 0;
    for (const auto& pose : bodies_.pose) {
      far = std::max({far, std::abs(pose.x), std::abs(pose.y)});
      if constexpr (requires { pose.z; }) far = std::max(far, std::abs(pose.z));
    }
    return far * std::numeric_limits<T>::epsilon();
  }

  // Of the displacements.
  T longest_way() const {
    T longest = 0, numbers[S::freedom];
    for (const auto& displacement : bodies_.displacement) {
      S::write(displacement, numbers);
      for (int c = 0; c < S::lengths; ++c) longest = std::max(longest, std::abs(numbers[c]));
    }
    return longest;
  }

  const std::vector<T>& C_moved(size_t body, int component, T by) {
    T numbers[S::freedom] = {};
    numbers[component] = by;
    std::fill(bodies_.displacement.begin(), bodies_.displacement.end(), typename S::Velocity{});
    bodies_.displacement[body] = S::read_velocity(numbers);
    return C_after(T(1));
  }

  // C of all rows after `scale` times the displacements.
  const std::vector<T>& C_after(T scale) {
    const auto poses = bodies_.pose;
    for (size_t k = 0; k < poses.size(); ++k)
      bodies_.pose[k] = S::moved(poses[k], S::sum({}, bodies_.displacement[k], scale));
    ops_->position(batch_, 0, 1, bodies_, T(world_->time));
    bodies_.pose = poses;
    return batch_.C;
  }

  const WorldData<S>* world_;
  const BlockOps<S>* ops_ = nullptr;
  Batch<S> batch_;    // one slot
  Bodies<S> bodies_;  // those of the joint only, in its order
};

// lambda of a joint's rows in the last substep, with the drift correction; zeros for rows without a slot.
template <class S>
std::vector<typename S::Scalar> total_impulse(const WorldData<S>& world, const JointRecord& joint) {
  const auto rows = joint_types(S::dimension)[joint.type].row_kinds.size();
  std::vector<typename S::Scalar> lambda(rows, 0);
  if (joint.places.empty() || joint.broken) return lambda;
  const Batch<S>& batch = *world.batches[joint.places[0].batch];
  for (size_t r = 0; r < rows; ++r) {
    const size_t i = slot_of(world, joint.places[0]) * rows + r;
    lambda[r] = batch.lambda[i] + batch.correction[i];
  }
  return lambda;
}

template <class S>
bool is_soft(const WorldData<S>& world, const JointRecord& joint) {
  if (joint.places.empty()) return false;
  const Law<S>* law = world.batches[joint.places[0].batch]->law;
  return law && !law->reported;
}

}  // namespace cdot
