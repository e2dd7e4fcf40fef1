// Stiffness of the forces that a step takes from its start. Within the joints, M dv/dt = f(q) + J(q)^T lambda with the
// present lambda. A small motion w feels -G w with
//
//   G w = -d/de [f(q + e w) + J(q + e w)^T lambda],  w <- P M^-1 G w,  P onto J w = 0,
//
// The largest eigenvalue is omega^2 of the stiffest oscillation. An explicit step h is stable while h omega < 2.
// Likewise
//
//   D w = -d/de f(q, v + e w),  w <- P M^-1 D w,
//
// whose largest eigenvalue is the rate of the fastest decay, by dampers.
#include "runtime/motion/motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <cdot/spaces.hpp>

#include "runtime/diagnose/equations.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"

namespace cdot {
namespace {

constexpr int most_rounds = 200;
constexpr double settled = 1e-3;  // relative change of the eigenvalue in ten rounds
// [sizes/s] Forces are taken as linear in it; round-off of the forces shows in rates less than it does.
template <class T>
constexpr T small_speed = T(by_precision<T>(1e-2, 1e-6));

template <class S>
class Motion {
 public:
  using T = typename S::Scalar;
  using Velocities = std::vector<typename S::Velocity>;  // in the order of the island's bodies

  Motion(WorldData<S>& world, Island<S>& island, Equations<S>& equations)
      : world_(world), island_(island), equations_(equations) {
    for (int i : island.bodies) pose_.push_back(world.bodies.pose[i]);
    for (const Segment<S>& segment : island.segments)
      if (segment.batch->law && segment.batch->law->force) forces_.push_back(segment);
  }

  // The present forces of the joints: J dv/dt = gamma.
  void find_forces(T h) {
    free_accelerations(world_, island_);
    for (const Segment<S>& segment : equations_.segments()) {
      Batch<S>& batch = *segment.batch;
      batch.ops->velocity(batch, segment.begin, segment.end, world_.bodies.velocity_rate.data(), batch.rate.data());
      batch.ops->gamma(batch, segment.begin, segment.end, world_.bodies, T(world_.time), batch.bias.data());
    }
    std::vector<double> b(equations_.size());
    equations_.each_row(
        [&](int row, Batch<S>& batch, int i) { b[row] = double(batch.bias[i]) - double(batch.rate[i]); });
    const std::vector<double> force = equations_.solve(b);
    // stiffen_bodies() takes the impulses of a step.
    equations_.each_row(
        [&](int row, Batch<S>& batch, int i) { batch.lambda[i] = T(force[row]) * h, batch.correction[i] = 0; });
    solves_as_step_ = island_.stiffened && island_.solver->exact;
    if (island_.stiffened) stiffen_bodies(world_, island_, h, double(h));
    equations_.each_row([&](int row, Batch<S>& batch, int i) { batch.lambda[i] = T(force[row]); });
    if (!solves_as_step_) return;
    island_.system.choose(Equations<S>::takes_part);
    island_.system.assemble(world_.bodies);
    island_.system.factor();
  }

  // P M^-1 G w by central differences, over a distance between the curvature of C and round-off.
  Velocities stiffened(const Velocities& w, bool tension, bool springs) {
    const T e = T(1e-3) * island_.size / std::max(T(largest(w)), T(1e-30));
    const Velocities ahead = rates(w, e, tension, springs), behind = rates(w, -e, tension, springs);
    Velocities change(w.size());
    for (size_t k = 0; k < w.size(); ++k) change[k] = S::sum(S::sum({}, behind[k], T(0.5) / e), ahead[k], T(-0.5) / e);
    for (size_t k = 0; k < w.size(); ++k) world_.bodies.pose[island_.bodies[k]] = pose_[k];
    equations_.evaluate();
    return within_joints(change);
  }

  // P M^-1 D w by central differences.
  Velocities slowed(const Velocities& w) {
    const T e = small_speed<T> * island_.size / std::max(T(largest(w)), T(1e-30));
    const Velocities faster = rates_by_velocity(w, e), slower = rates_by_velocity(w, -e);
    Velocities change(w.size());
    for (size_t k = 0; k < w.size(); ++k) change[k] = S::sum(S::sum({}, slower[k], T(0.5) / e), faster[k], T(-0.5) / e);
    return within_joints(change);
  }

  // change - M^-1 J^T K^-1 J change
  Velocities within_joints(Velocities change) {
    auto& all = world_.bodies.increment;
    for (size_t k = 0; k < change.size(); ++k) all[island_.bodies[k]] = change[k];
    for (const Segment<S>& segment : equations_.segments()) {
      Batch<S>& batch = *segment.batch;
      batch.ops->velocity(batch, segment.begin, segment.end, all.data(), batch.rate.data());
    }
    find_corrections(all.data());
    for (const Segment<S>& segment : equations_.segments())
      segment.batch->ops->apply(*segment.batch, segment.begin, segment.end, world_.bodies,
                                segment.batch->correction.data(), all.data());
    if (solves_as_step_) island_.system.pull(world_.bodies, all.data());
    for (size_t k = 0; k < change.size(); ++k) change[k] = std::exchange(all[island_.bodies[k]], {});
    return change;
  }

  // Rotations count with the size of the mechanism as arm.
  double product(const Velocities& v, const Velocities& w) const {
    double sum = 0;
    for (size_t k = 0; k < v.size(); ++k) sum += product(v[k], w[k]);
    return sum;
  }
  double product(const typename S::Velocity& v, const typename S::Velocity& w) const {
    T a[S::freedom], b[S::freedom];
    S::write(v, a), S::write(w, b);
    const double arm = double(island_.size);
    double sum = 0;
    for (int k = 0; k < S::freedom; ++k) sum += double(a[k]) * double(b[k]) * (k < S::lengths ? 1 : arm * arm);
    return sum;
  }

 private:
  double largest(const Velocities& w) const {
    double square = 0;
    for (const auto& one : w) square = std::max(square, product(one, one));
    return std::sqrt(square);
  }

  // -K^-1 J change, J change being the rates. `change` is by body of the World.
  void find_corrections(const typename S::Velocity* change) {
    if (solves_as_step_) {
      island_.system.load([](const Batch<S>& batch, int i) { return -double(batch.rate[i]); });
      island_.system.load_tensions(change);
      island_.system.solve();
      island_.system.store([](Batch<S>& batch, int i, double lambda) { batch.correction[i] = T(lambda); });
      return;
    }
    std::vector<double> b(equations_.size());
    equations_.each_row([&](int row, Batch<S>& batch, int i) { b[row] = -double(batch.rate[i]); });
    const std::vector<double> impulse = equations_.solve(b);
    equations_.each_row([&](int row, Batch<S>& batch, int i) { batch.correction[i] = T(impulse[row]); });
  }

  Velocities rates(const Velocities& w, T e, bool tension, bool springs) {
    Bodies<S>& all = world_.bodies;
    for (size_t k = 0; k < w.size(); ++k) all.pose[island_.bodies[k]] = S::moved(pose_[k], S::sum({}, w[k], e));
    if (springs) {
      push_free_bodies(world_, island_);
      // Euler's methods solve for the forces of springs on coordinates. For others they are known forces.
      if (row_of(world_.settings.integrator).forces_springs)
        for (const Segment<S>& segment : forces_) push_by(segment);
    } else {
      for (int i : island_.bodies) all.velocity_rate[i] = {};
    }
    if (tension) {
      equations_.evaluate();
      for (const Segment<S>& segment : equations_.segments())
        segment.batch->ops->apply(*segment.batch, segment.begin, segment.end, all, segment.batch->lambda.data(),
                                  all.velocity_rate.data());
    }
    return rates_of_bodies();
  }

  Velocities rates_by_velocity(const Velocities& w, T e) {
    Bodies<S>& all = world_.bodies;
    Velocities before;
    for (size_t k = 0; k < w.size(); ++k) {
      auto& v = all.velocity[island_.bodies[k]];
      before.push_back(v);
      v = S::sum(v, w[k], e);
    }
    push_free_bodies(world_, island_);
    for (const Segment<S>& segment : forces_) push_by(segment);
    for (size_t k = 0; k < w.size(); ++k) all.velocity[island_.bodies[k]] = before[k];
    return rates_of_bodies();
  }

  Velocities rates_of_bodies() const {
    Velocities found;
    for (int i : island_.bodies) found.push_back(world_.bodies.velocity_rate[i]);
    return found;
  }

  void push_by(const Segment<S>& segment) {
    Batch<S>& batch = *segment.batch;
    batch.ops->evaluate(batch, segment.begin, segment.end, world_.bodies, T(world_.time));
    find_known_forces(world_, batch, segment.begin, segment.end, batch.impulse.data());
    batch.ops->apply(batch, segment.begin, segment.end, world_.bodies, batch.impulse.data(),
                     world_.bodies.velocity_rate.data());
  }

  WorldData<S>& world_;
  Island<S>& island_;
  Equations<S>& equations_;
  std::vector<Segment<S>> forces_;      // known functions of coordinates and rates
  std::vector<typename S::Pose> pose_;  // in the order of the island's bodies
  bool solves_as_step_ = false;         // by the system of the linearly implicit step
};

template <class S>
std::vector<typename S::Velocity> any_motion(const Island<S>& island) {
  std::vector<typename S::Velocity> w;
  Arbitrary arbitrary;
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    typename S::Scalar numbers[S::freedom];
    for (auto& number : numbers) number = typename S::Scalar(arbitrary() - 0.5);
    w.push_back(S::read_velocity(numbers));
  }
  return w;
}

// The largest eigenvalue of `apply`, by a power iteration; w is near its eigenvector, of length 1.
template <class S, class Apply>
double largest_eigenvalue(const Motion<S>& motion, typename Motion<S>::Velocities& w, Apply apply) {
  using T = typename S::Scalar;
  double found = 0, before = 0;
  for (int round = 0; round < most_rounds; ++round) {
    const double length = std::sqrt(motion.product(w, w));
    if (!(length > 0) || !std::isfinite(length)) return found;
    for (auto& one : w) one = S::sum({}, one, T(1 / length));
    auto next = apply(w);
    found = motion.product(w, next);
    const double size = std::sqrt(motion.product(next, next));
    if (!(size > 0) || !std::isfinite(size)) return found;
    if (round % 10 == 9) {
      if (std::abs(size - before) < settled * size) break;
      before = size;
    }
    if (round + 1 < most_rounds) w = std::move(next);
  }
  return found;
}

template <class S>
int most_moved(const Island<S>& island, const Motion<S>& motion, const typename Motion<S>::Velocities& w) {
  size_t most = 0;
  for (size_t k = 1; k < w.size(); ++k)
    if (motion.product(w[k], w[k]) > motion.product(w[most], w[most])) most = k;
  return island.bodies[most];
}

}  // namespace

template <class S>
Diagnosis::Stiffest stiffest_motion(WorldData<S>& world, Island<S>& island, Equations<S>& equations,
                                    typename S::Scalar h) {
  Motion<S> motion(world, island, equations);
  motion.find_forces(h);
  auto w = motion.within_joints(any_motion(island));
  Diagnosis::Stiffest found;
  found.square = largest_eigenvalue<S>(motion, w, [&](const auto& now) { return motion.stiffened(now, true, true); });
  if (found.square == 0) return found;
  found.tension = motion.product(w, motion.stiffened(w, true, false));
  found.body = most_moved(island, motion, w);
  return found;
}

template <class S>
Diagnosis::Decay fastest_decay(WorldData<S>& world, Island<S>& island, Equations<S>& equations) {
  Motion<S> motion(world, island, equations);
  auto w = motion.within_joints(any_motion(island));
  const double rate = largest_eigenvalue<S>(motion, w, [&](const auto& now) { return motion.slowed(now); });
  return {rate, rate == 0 ? -1 : most_moved(island, motion, w)};
}

template <class S>
double stiffest_limited_force(WorldData<S>& world, const Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  double most = 0;
  for (const auto& [batch, begin, end, whole] : island.segments) {
    if (!batch->law || !batch->law->within_limits) continue;
    batch->ops->evaluate(*batch, begin, end, world.bodies, T(world.time));
    batch->ops->velocity(*batch, begin, end, world.bodies.velocity.data(), batch->rate.data());
    batch->ops->effective_mass(*batch, begin, end, world.bodies);
    SpringNumbers<T> springs[most_rows];
    for (int slot = begin; slot < end; ++slot) {
      batch->law->within_limits(*batch, slot, springs);
      for (int r = 0; r < batch->ops->rows; ++r) {
        const T K = batch->factor[slot * batch->triangle() + r * (r + 1) / 2 + r];
        most = std::max(most, double(h * (springs[r].d + h * springs[r].k) * K));
      }
    }
  }
  return most;
}

#define CDOT_INSTANTIATE(S)                                                                          \
  template double stiffest_limited_force(WorldData<S>&, const Island<S>&, S::Scalar);                \
  template Diagnosis::Stiffest stiffest_motion(WorldData<S>&, Island<S>&, Equations<S>&, S::Scalar); \
  template Diagnosis::Decay fastest_decay(WorldData<S>&, Island<S>&, Equations<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
