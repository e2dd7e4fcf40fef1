// The implicit midpoint rule with joints: the forces of the joints and of springs act with the directions of the middle
// of the step, so that stiffness from tension and stiff springs is stable at every step. With the middle pose q_m,
//
//   M (v_m - v) = (h f + J(q_m)^T lambda) / 2,   q' = q + h v_m,   C(q') = 0,   v' = 2 v_m - v,
//
// then v' is projected onto J(q') v' = -dC/dt. Newton's matrix has the stiffness G = -d(J^T lambda)/dq of tension,
// whose part between bodies stands as rows in the direct solver's system (runtime/solve/tension.hpp):
//
//   (M + h G / 4) w - J^T y = M r,   J w = -C(q') / h,   y = (change of lambda) / 2,
//
// w being the change of v_m and r what it lacks. The rule is of second order and exact in the work of constant forces;
// the projection alone takes energy, by the fifth power of the angle turned in a step. (E. Hairer, C. Lubich, G.
// Wanner, "Geometric Numerical Integration", 2006, II.1 and IV.4.) Limits, motors and friction act at the ends of the
// step.
#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/motion/momentum.hpp"
#include "runtime/motion/motion.hpp"
#include "runtime/solve/direct.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/step/dampers.hpp"
#include "runtime/step/integrators.hpp"
#include "runtime/step/kick_drift.hpp"

namespace cdot {

template <class S>
void step_rattle(WorldData<S>& world, Island<S>& island, typename S::Scalar h);  // rattle.cpp

namespace {

constexpr int most_rounds = 25;
// Of the joints in a part, as a share of the kinetic energy.
template <class T>
constexpr double slight_work = by_precision<T>(1e-2, 1e-4);
template <class T>
constexpr T shortest_part = T(by_precision<T>(1.0 / 8, 1.0 / 64));  // of a step
constexpr double slow = 0.2;  // share of the error that a round may leave without a new factor
// Goals of Newton: C, in units of Island::scale, and the change of a pose in units of Island::size and [rad].
template <class T>
constexpr T closed = T(by_precision<T>(1e-7, 1e-15));
template <class T>
constexpr T settled = T(by_precision<T>(1e-6, 1e-12));
// A larger change of a pose in one round means that the step is too long, in the same units.
template <class T>
constexpr T furthest = T(2);
// Round-off may stop Newton before its goals; these errors are still small.
template <class T>
constexpr T nearly = T(1e4);

template <class S, class F>
void each_row(const Batch<S>& batch, int begin, int end, F f) {
  for (int i = begin * batch.ops->rows; i < end * batch.ops->rows; ++i) f(i);
}
template <class S, class F>
void each_row(const Island<S>& island, F f) {
  for (const Segment<S>& segment : island.segments)
    each_row(*segment.batch, segment.begin, segment.end, [&](int i) { f(*segment.batch, i); });
}

// `correction` becomes the first guess of lambda, from the last step scaled by `share`; `lambda` the impulses of
// dampers at the start.
template <class S>
void push_at_start(WorldData<S>& world, Island<S>& island, typename S::Scalar h, typename S::Scalar share) {
  each_row(island, [&](Batch<S>& batch, int i) {
    batch.correction[i] = share * (batch.lambda[i] + batch.correction[i]);
    batch.lambda[i] = 0;
  });
  weigh_springs(world, island);
  push_dampers(world, island, h);
}

// v = exp(-d h) v of bodies with drag: exact for drag alone.
template <class S>
void drag(WorldData<S>& world, const Island<S>& island, typename S::Scalar h) {
  for (const Drag<S>& drag : island.drags) {
    auto& v = world.bodies.velocity[drag.body];
    const auto energy = [&] { return 0.5 * S::dot(S::force(world.bodies.inverse_mass[drag.body], v), v); };
    const double before = energy();
    v = S::damped(v, std::exp(-h * drag.linear), std::exp(-h * drag.angular));
    world.accounts.taken += before - energy();
  }
}

// C, J and dC/dt at the middle of the step. Of springs, into Batch::impulse and Batch::softness: their impulse without
// dampers, and the softness of their rows of y. With u = h^2 k K, a spring acts at the share theta of the step,
//   lambda = -h k (C + (theta - 1/2) h dC/dt),   theta = max(1/2, 1 - 1/(2 u)),   softness = 2 / (theta h^2 k):
// in the middle, or near the end if it is too stiff for the step.
template <class S>
void look_at_middle(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  drift(world, island, h / 2);
  for (const auto& [segment, begin, end, whole] : island.segments) {
    Batch<S>& batch = *segment;
    batch.ops->evaluate(batch, begin, end, world.bodies, T(world.time) + h / 2);
    if (!is_force(batch)) continue;
    find_spring_impulses(batch, begin, end, h);
    each_row(batch, begin, end, [&](int i) {
      batch.softness[i] = 0;
      batch.lower[i] = batch.upper[i] = batch.impulse[i];
    });
    batch.ops->velocity(batch, begin, end, world.bodies.velocity.data(), batch.rate.data());
    each_spring(batch, begin, end, [&](int i, const SpringNumbers<T>& spring, T K) {
      if (!(spring.k > T(0))) return;
      const T stiff = h * h * spring.k, theta = std::max(T(0.5), T(1) - T(0.5) * inverse(stiff * K));
      batch.impulse[i] -= (theta - T(0.5)) * stiff * (batch.rate[i] + batch.bias[i]);
      batch.softness[i] = T(2) / (theta * stiff);
      batch.lower[i] = pulls_only(batch, i) ? T(0) : -std::numeric_limits<T>::infinity();
      batch.upper[i] = std::numeric_limits<T>::infinity();
    });
  }
}

// The error of limits, motors and friction in the step, as a rate into Batch::impulse, and the bounds of their impulse.
// The middle has the speed of a motor; the end has the C of a limit, which must not pass its end.
template <class S>
void find_misses_of_bounded(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  for (const auto& [segment, begin, end, whole] : island.segments) {
    Batch<S>& batch = *segment;
    if (!is_bounded(batch)) continue;
    const bool of_rate = !batch.law->error;
    if (of_rate) batch.ops->velocity(batch, begin, end, world.bodies.velocity.data(), batch.rate.data());
    each_row(batch, begin, end, [&](int i) {
      batch.impulse[i] = batch.bias[i];
      if (!of_rate) batch.bias[i] = 0;
    });
    batch.law->fill(batch, begin, end, h, world.settings);
    each_row(batch, begin, end, [&](int i) {
      std::swap(batch.impulse[i], batch.bias[i]);
      if (of_rate) batch.impulse[i] += batch.rate[i];
      else if (batch.error[i] != T(0)) batch.impulse[i] = batch.error[i] / h;
    });
  }
}

// Velocity rows have no C. Their error is what they miss in the middle, as a displacement.
template <class S>
void find_errors_of_rates(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  for (const auto& [batch, begin, end, whole] : island.segments) {
    const auto& kinds = batch->kinds;
    if (batch->law || std::find(kinds.begin(), kinds.end(), RowKind::velocity) == kinds.end()) continue;
    batch->ops->velocity(*batch, begin, end, world.bodies.velocity.data(), batch->rate.data());
    each_row(*batch, begin, end, [&, of = batch](int i) {
      if (kinds[static_cast<size_t>(i % of->ops->rows)] != RowKind::velocity) return;
      of->error[i] = h * (of->rate[i] + of->bias[i]);
      island.residual = std::max<typename S::Scalar>(island.residual, std::abs(of->error[i]));
    });
  }
}

// A spring whose force changes with C is solved with the joints. Others (a slack rope, a constant force) take their
// present force.
template <class S>
bool is_soft(const Batch<S>& batch, int i) {
  return is_force(batch) && batch.softness[i] > 0;
}

// r = (v + h a / 2 + M^-1 J^T lambda / 2) - v_m, as (M + h G / 4)^-1 M r, into Bodies::increment; J r into Batch::rate.
template <class S>
void find_lack(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    const int i = island.bodies[k];
    const auto wanted = S::sum(island.flow.velocity[k], all.acceleration[i], h / 2);
    const auto lack = S::sum(wanted, all.velocity[i], T(-1));
    all.increment[i] = S::weighted(all.effective_mass[i], S::force(all.inverse_mass[i], lack));
  }
  for (const auto& [batch, begin, end, whole] : island.segments) {
    each_row(*batch, begin, end, [of = batch](int i) { of->rate[i] = T(0.5) * of->correction[i]; });
    batch->ops->apply(*batch, begin, end, all, batch->rate.data(), all.increment.data());
  }
  for (const auto& [batch, begin, end, whole] : island.segments)
    batch->ops->velocity(*batch, begin, end, all.increment.data(), batch->rate.data());
}

// Adds w to v_m. Returns the largest change of a pose.
template <class S>
typename S::Scalar move_middle(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  T largest = 0;
  for (int i : island.bodies) {
    T w[S::freedom];
    S::write(all.increment[i], w);
    for (int c = 0; c < S::freedom; ++c)
      largest = std::max(largest, std::abs(h * w[c]) / (c < S::lengths ? T(island.size) : T(1)));
    all.velocity[i] = S::sum(all.velocity[i], all.increment[i], T(1));
    all.increment[i] = {};
  }
  return largest;
}

// Softness and bounds of y, for rows under a law: the bounds of lambda = present lambda + 2 y.
template <class S>
void bound_changes(Island<S>& island) {
  using T = typename S::Scalar;
  island.at_work().load_laws();
  island.at_work().each_row([&](int row, const Batch<S>& batch, int i) {
    if (!batch.law) return;
    island.at_work().lower[row] = T(0.5) * (batch.lower[i] - batch.correction[i]);
    island.at_work().upper[row] = T(0.5) * (batch.upper[i] - batch.correction[i]);
  });
}

// Solves for y and w; adds 2 y to lambda. `renew`: with a new factor. Returns the largest change of a pose.
template <class S>
typename S::Scalar improve(WorldData<S>& world, Island<S>& island, typename S::Scalar h, bool renew) {
  using T = typename S::Scalar;
  System<S>& system = island.at_work();
  find_lack(world, island, h);
  system.load([&](const Batch<S>& batch, int i) {
    const T missed = is_soft(batch, i) ? T(0.5) * batch.softness[i] * (batch.correction[i] - batch.impulse[i])
                     : batch.law       ? batch.impulse[i]
                                       : batch.error[i] / h;
    return -(batch.rate[i] + missed);
  });
  system.load_tensions(world.bodies.increment.data());
  if (renew) system.assemble(world.bodies);
  if (system.lawful()) {
    bound_changes(island);
    island.redundant_rows = system.solve_bounded();
  } else {
    if (renew) {
      system.choose([](const Batch<S>&, int) { return true; });
      island.redundant_rows = system.factor();
    }
    system.solve();
  }
  system.store([&](Batch<S>& batch, int i, auto y) {
    batch.rate[i] = T(y);
    batch.correction[i] += T(2 * y);
  });
  exert(world, island, system, &BatchWorkspace<S>::rate, world.bodies.increment.data());
  return move_middle(world, island, h);
}

// The error that contradicting rows keep, as a motor and the limit it runs into.
template <class S>
typename S::Scalar shared_error(const Island<S>& island, typename S::Scalar at_start) {
  using T = typename S::Scalar;
  T shared = std::isfinite(at_start) ? at_start : T(0);
  for (int r = 0; r < island.at_work().rows(); ++r) shared = std::max(shared, T(std::abs(island.at_work().unmet(r))));
  return T(2) * shared;
}

// Newton for v_m and lambda. Leaves v_m in the velocities, lambda in Batch::correction and the end in the poses. False
// if the step is too long for it.
template <class S>
bool find_middle(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  const T time = T(world.time) + h;
  const T goal = std::max(closed<T> * island.scale, T(0.01) * round_off_of(world, island));
  const T at_start = island.residual;
  T before = std::numeric_limits<T>::infinity();
  bool renew = true;
  for (int round = 0; round < most_rounds; ++round) {
    look_at_middle(world, island, h);
    if (renew) stiffen_masses(world, island, h / 4);
    drift(world, island, h);
    island.residual = find_errors(world, island, time);
    find_errors_of_rates(world, island, h);
    if (!std::isfinite(island.residual)) return false;
    find_misses_of_bounded(world, island, h);
    const T change = improve(world, island, h, renew), miss = std::max(change / settled<T>, island.residual / goal);
    if (!(change < furthest<T>)) return false;
    const bool shared = change <= settled<T> && island.residual <= shared_error(island, at_start);
    if (miss <= T(1) || shared || (miss <= nearly<T> && miss > T(0.5) * before)) {
      drift(world, island, h);
      return true;
    }
    renew = !(miss < T(slow) * before);
    before = miss;
  }
  return false;
}

// The work of the joints, which is 0 along the exact motion: lambda (J v_m + dC/dt), in [J].
template <class S>
double work_of_joints(WorldData<S>& world, Island<S>& island) {
  double work = 0;
  for (const auto& [batch, begin, end, whole] : island.segments) {
    if (batch->law) continue;
    batch->ops->velocity(*batch, begin, end, world.bodies.velocity.data(), batch->rate.data());
    each_row(*batch, begin, end, [&, of = batch](int i) {
      work += double(of->correction[i]) * (double(of->rate[i]) + double(of->bias[i]));
    });
  }
  return work;
}

// The kinetic energy of the motions that the joints changed in this part. A wheel that merely spins has no say.
template <class S>
double moved_energy(const WorldData<S>& world, const Island<S>& island) {
  using T = typename S::Scalar;
  constexpr double same = by_precision<T>(1e-4, 1e-9);
  double energy = 0;
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    const int i = island.bodies[k];
    T v[S::freedom], before[S::freedom], momentum[S::freedom];
    S::write(world.bodies.velocity[i], v), S::write(island.flow.velocity[k], before);
    S::write(S::force(world.bodies.inverse_mass[i], world.bodies.velocity[i]), momentum);
    for (const auto& [from, to] : {std::pair{0, S::lengths}, std::pair{S::lengths, S::freedom}}) {
      double own = 0, change = 0, size = 0;
      for (int c = from; c < to; ++c) {
        own += 0.5 * double(momentum[c]) * double(v[c]);
        change += std::abs(double(v[c]) - double(before[c])), size += std::abs(double(v[c]));
      }
      if (change > same * size) energy += own;
    }
  }
  return energy;
}

// Too slow for a judgement of its energy.
template <class S>
bool hardly_moves(const WorldData<S>& world, const Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  const T speed = T(by_precision<T>(1e-4, 1e-6)) * island.size / h;
  return std::all_of(island.bodies.begin(), island.bodies.end(),
                     [&](int i) { return S::slower(world.bodies.velocity[i], speed); });
}

template <class S>
void restore_masses(WorldData<S>& world, Island<S>& island) {
  for (int i : island.bodies) world.bodies.effective_mass[i] = world.bodies.inverse_mass[i];
  island.at_work().slacken();
  island.factored = false;
}

// v' = 2 v_m - v
template <class S>
void double_middle(WorldData<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    auto& v = world.bodies.velocity[island.bodies[k]];
    v = S::sum(S::sum({}, v, T(2)), island.flow.velocity[k], T(-1));
  }
  each_row(island, [](Batch<S>& batch, int i) { batch.correction[i] += batch.lambda[i]; });
}

// Softness and bounds of the rows under a law at the end of the step. The whole impulse of a limit, a motor or friction
// keeps its bounds, and a rope never pushes.
template <class S>
void bound_end(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  factorize_rows(world, island);
  for (const auto& [batch, begin, end, whole] : island.segments) {
    if (!batch->law) continue;
    if (is_bounded(*batch)) {
      batch->law->fill(*batch, begin, end, h, world.settings);
      each_row(*batch, begin, end, [of = batch](int i) {
        of->lower[i] -= of->correction[i];
        of->upper[i] -= of->correction[i];
      });
      continue;
    }
    const auto pulled = [](const Batch<S>& of, int i) { return of.correction[i]; };
    bound_dampers(*batch, begin, end, h, true, pulled);
  }
}

// Keeps impulses, poses and velocities of the start of a part, and goes back to them.
template <class S>
void keep(WorldData<S>& world, Island<S>& island) {
  size_t k = 0;
  each_row(island, [&](const Batch<S>& batch, int i) {
    island.flow.now[k++] = batch.lambda[i];
    island.flow.now[k++] = batch.correction[i];
  });
  for (int i : island.bodies) world.bodies.displacement[i] = world.bodies.velocity[i];
}
template <class S>
void go_back_to_kept(WorldData<S>& world, Island<S>& island) {
  size_t k = 0;
  each_row(island, [&](Batch<S>& batch, int i) {
    batch.lambda[i] = island.flow.now[k++];
    batch.correction[i] = island.flow.now[k++];
  });
  for (size_t n = 0; n < island.bodies.size(); ++n) {
    const int i = island.bodies[n];
    world.bodies.pose[i] = island.flow.pose[n];
    world.bodies.velocity[i] = world.bodies.displacement[i];
    world.bodies.increment[i] = {};
  }
  if constexpr (S::has_gyroscopes) set_inertias(world, island);
  for (int i : island.bodies) world.bodies.effective_mass[i] = world.bodies.inverse_mass[i];
  island.evaluated = island.factored = false;
}

// The velocities at the end: J v = -dC/dt. Returns the energy that the projection takes, mu (J v + dC/dt) / 2 of its
// impulses mu [J]; 0 if a limit was hit, which takes energy by itself.
template <class S>
double solve_end_of_part(WorldData<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  auto* const v = world.bodies.velocity.data();
  for (const auto& [batch, begin, end, whole] : island.segments) {
    batch->ops->velocity(*batch, begin, end, v, batch->rate.data());
    each_row(*batch, begin, end, [of = batch](int i) { of->error[i] = of->rate[i] + of->bias[i]; });
  }
  island.solver->velocities(world, island, v, T(1));
  double loss = 0;
  bool hit = false;
  each_row(island, [&](const Batch<S>& batch, int i) {
    if (!batch.law) loss -= 0.5 * double(batch.lambda[i]) * double(batch.error[i]);
    else hit |= batch.law->error && batch.correction[i] + batch.lambda[i] != T(0);
  });
  return hit ? 0 : loss;
}

// One part of a step, of length h. False, with the state of its start, if it is too long: Newton fails, or the joints
// do work. A last part may lose energy.
template <class S>
bool take_part(WorldData<S>& world, Island<S>& island, typename S::Scalar h, bool last) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  const T share = begin_kick_drift(world, island, h);
  const auto momentum = island.floats ? momentum_of(world, island) : Momentum<T>{};
  keep(world, island);
  const double put_in = world.accounts.put_in, taken = world.accounts.taken;
  const auto give_up = [&] {
    go_back_to_kept(world, island);
    world.accounts.put_in = put_in, world.accounts.taken = taken;
    return false;
  };
  begin_kick(world, island);
  push_at_start(world, island, h, share);
  book_kick(world, island, Impulses::dampers, h);
  drag(world, island, h / 2);
  note_start(world, island);
  bool found = find_middle(world, island, h);
  restore_masses(world, island);
  if (found && !hardly_moves(world, island, h)) {
    const double work = work_of_joints(world, island);
    found = (last ? work : std::abs(work)) <= slight_work<T> * moved_energy(world, island);
  }
  if (!found) return give_up();
  island.evaluated_at = T(world.time) + h / 2;
  book_kick(world, island, Impulses::middle, h);
  double_middle(world, island);
  evaluate_anew(world, island, T(world.time) + h);
  for (int i : island.bodies) all.effective_mass[i] = all.inverse_mass[i];
  book_stiffness(world, island);
  if (island.floats) restore_momentum(world, island, momentum, h);
  drag(world, island, h / 2);
  bound_end(world, island, h);
  const double energy = moved_energy(world, island);
  begin_kick(world, island);
  const double loss = solve_end_of_part(world, island);
  if (!last && loss > slight_work<T> * energy && !hardly_moves(world, island, h)) return give_up();
  book_kick(world, island, Impulses::end, h);
  island.evaluated = true;
  return true;
}

// Linearly implicit Euler, which takes every step.
template <class S>
void fall_back(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  step_euler(world, island, h, 0);
  for (int i : island.bodies) world.bodies.effective_mass[i] = world.bodies.inverse_mass[i];
  island.factored = false;
}

// Impulses over `from` become those of the same forces over `to`.
template <class S>
void stretch_impulses(const Island<S>& island, typename S::Scalar from, typename S::Scalar to) {
  each_row(island, [by = to / from](Batch<S>& batch, int i) {
    batch.lambda[i] *= by;
    batch.correction[i] *= by;
  });
}

}  // namespace

// A step that is too long is taken in parts. Joints that contradict each other have no middle: Euler's step solves them
// by least squares.
template <class S>
void step_midpoint(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  begin_kick_drift(world, island, h);
  const T apart = std::max(foreign<T> * std::max<T>(island.size, island.scale), round_off_of(world, island));
  if (std::isfinite(island.residual) && island.residual > apart) return step_rattle(world, island, h);
  const double start = world.time, before = world.last_step;
  T part = h, done = 0;
  while (done < h) {
    const bool last = part / 2 < shortest_part<T> * h;
    const bool taken = take_part(world, island, part, last);
    if (!taken && !last) {
      part /= 2;
      continue;
    }
    if (!taken) {
      ++world.counts->rescued;
      fall_back(world, island, part);
    }
    done += part;
    world.last_step = double(part);
    world.time = start + double(done);
  }
  world.time = start, world.last_step = before;
  if (part != h) stretch_impulses(island, part, h);
}

#define CDOT_INSTANTIATE(S) template void step_midpoint(WorldData<S>&, Island<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
