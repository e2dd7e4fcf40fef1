// Solves the island's whole K at once: exact to round-off for every mass ratio and chain length.
#include "runtime/solve/direct.hpp"

#include <algorithm>
#include <limits>

#include <cdot/spaces.hpp>

#include "runtime/solve/loads.hpp"
#include "runtime/solve/longest_move.hpp"
#include "runtime/solve/misfits.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/rivals.hpp"
#include "runtime/solve/solver.hpp"

namespace cdot {
namespace {

constexpr int newton_rounds = 20;
// The share of the error that a Newton round may leave. At this rate newton_rounds reach round-off: 0.2^19 = 5e-14. At
// acceleration level a step that needs a new J is too long; error control must shorten it.
constexpr double enough = 0.2, enough_at_acceleration_level = 0.5;
// The round-off of K lambda, relative to the largest b, that a solve may leave. Each refinement leaves that share of
// the error before.
template <class T>
constexpr double rough = by_precision<T>(1e-5, 1e-12);
constexpr int most_refinements = 4;
template <class S>
bool is_held(const Batch<S>& batch, int i) {
  return !batch.law || holds(batch.mode[i]);
}

// True if the row has an error to correct, or is an end that has an impulse already. A step brings rows to their ends
// to round-off only.
template <class S>
bool has_error(const Batch<S>& batch, int i) {
  constexpr auto round_off = 8 * std::numeric_limits<typename S::Scalar>::epsilon();
  const bool acts = !is_held(batch, i) && batch.law->error && batch.correction[i] != 0;
  return is_held(batch, i) || (within_bounds(batch.mode[i]) && (std::abs(batch.error[i]) > round_off || acts));
}

template <class S>
[[gnu::always_inline]] inline void exert_solution(const WorldData<S>& world, const Island<S>& island, System<S>& system,
                                                  typename S::Velocity* to) {
  system.store([](Batch<S>& batch, int i, auto lambda) { batch.lambda[i] = typename S::Scalar(lambda); });
  exert(world, island, system, &BatchState<S>::lambda, to);
}

template <class S>
void forget_factor(WorldData<S>&, Island<S>& island) {
  island.factored = false;
}

template <class S>
void factor(WorldData<S>& world, Island<S>& island) {
  System<S>& system = island.at_work();
  system.choose([](const Batch<S>&, int) { return true; });
  system.assemble(world.bodies);
  system.factor();
}

// The same with bounds that grow with loads.
template <class S>
void solve_loaded(WorldData<S>& world, Island<S>& island, System<S>& system) {
  using T = typename S::Scalar;
  begin_loads(world, island);
  const auto solve = [&] {
    system.load_laws();
    solve_bounded(world, island, system);
    system.find_excess();
    system.store([](Batch<S>& batch, int i, auto lambda) { batch.lambda[i] = T(lambda); });
  };
  const auto solution = [&](const LoadedRow<S>& row) {
    const int r = system.blocks[static_cast<size_t>(row.block)].first;
    return RowSolution<T>{T(system.lambda[r]), T(system.excess(r)), T(system.diagonal(r))};
  };
  if (settle_loads(island, solve, impulse_of_rows(island), solution)) {
    if (!island.acceleration_level) unload(island);
  } else if (island.acceleration_level) island.jams = true;
  else island.trouble = StepProblem::jams;
}

// An end that is not met yet stops its bodies by what C does at first order. Beside joints that nearly imply its row,
// as those of an arm with a rope across it, C bends away as quickly: whether the end is met at all is of the step's
// error. That begins so far from the loss of rank, in rad or arms.
constexpr double in_line = 0.05;

// True if the row is an end with an impulse, though its gap is open.
template <class S>
bool acts_before_it_is_met(const Island<S>& island, const Batch<S>& batch, int i) {
  using T = typename S::Scalar;
  if (batch.lambda[i] == 0) return false;
  Guard<T> guards[most_rows];
  batch.law->guard(batch, i / batch.ops->rows, guards);
  const Guard<T>& guard = guards[i % batch.ops->rows];
  return guard.one_sided() && guard.gap() > foreign<T> * island.scale;
}

template <class S>
void count_undecided_ends(WorldData<S>& world, const Island<S>& island, System<S>& system) {
  bool any = false;
  for (const auto& [batch, begin, end, whole] : island.segments)
    if (has_ends(*batch))
      for (int i = begin * batch->ops->rows; i < end * batch->ops->rows; ++i)
        any |= acts_before_it_is_met(island, *batch, i);
  if (!any) return;
  system.each_row([&](int row, const Batch<S>& batch, int i) {
    if (!has_ends(batch) || system.fixed[row] || !acts_before_it_is_met(island, batch, i)) return;
    std::fill(system.b.begin(), system.b.end(), 0);
    system.b[row] = 1;
    system.solve_factored(system.b.data());  // b[row]: 1 / K_rr of the row beside all others
    if (!(double(system.diagonal(row) * system.b[row]) > 1 / (in_line * in_line))) return;
    if (world.counts->undecided++ == 0) world.counts->undecided_joint = batch.joint[i / batch.ops->rows];
  });
}

// K lambda = -(J v + bias), lambda within its bounds.
template <class S>
void solve_velocities(WorldData<S>& world, Island<S>& island, typename S::Velocity* v, typename S::Scalar) {
  System<S>& system = island.at_work();
  if (system.rows() == 0) return;
  load_rates(island, system, v);
  system.load_tensions(v);
  if (!island.factored) system.assemble(world.bodies);
  if (!island.loads.empty()) {
    solve_loaded(world, island, system);
  } else if (system.lawful()) {
    system.load_laws();
    solve_bounded(world, island, system);
  } else {
    if (!island.factored) island.redundant_rows = system.factor();
    system.solve();
  }
  exert_solution(world, island, system, v);
  if (!system.lawful() || island.acceleration_level) return;
  if (!world.at_once) count_undecided_ends(world, island, system);
  count_rivals(world, system);
}

// System::share_loads() is set where joints may break.
template <class S>
void shared_already(WorldData<S>&, Island<S>&) {}

// Only a retry gets here: the rows are rigid.
template <class S>
void solve_soft(WorldData<S>& world, Island<S>& island, SoftSweep<typename S::Scalar> soft, typename S::Scalar share) {
  for (const auto& [batch, begin, end, whole] : island.segments)
    for (int i = begin * batch->ops->rows; !batch->law && i < end * batch->ops->rows; ++i)
      batch->bias[i] += soft.rate * batch->C[i];
  solve_velocities(world, island, world.bodies.velocity.data(), share);
}

// The largest |value(row)| of the rows that take part.
template <class S, class F>
double largest_of(const System<S>& system, F value) {
  double largest = 0;
  for (int r = 0; r < system.rows(); ++r)
    if (!system.fixed[r] && !system.broken[r]) largest = std::max(largest, std::abs(double(value(r))));
  return largest;
}

// Solves again for what is left of J v + bias, where the round-off of K lambda is more than the share `rough` of b.
// Bodies much lighter than their neighbours get large impulses that cancel.
template <class S>
void refine(WorldData<S>& world, Island<S>& island, System<S>& system, typename S::Velocity* v) {
  using T = typename S::Scalar;
  constexpr double epsilon = std::numeric_limits<ExactNumber<T>>::epsilon();
  const double allowed = rough<T> / epsilon * largest_of(system, [&](int r) { return system.b[r]; });
  for (int round = 0; round < most_refinements; ++round) {
    const double cancels = largest_of(system, [&](int r) { return system.diagonal(r) * system.lambda[r]; });
    if (!(cancels > allowed)) return;
    load_rates(island, system, v);
    system.give([](const Batch<S>&, int) { return 0.0; });
    system.solve();
    system.store([](Batch<S>& batch, int i, auto lambda) {
      batch.impulse[i] = T(lambda);
      batch.lambda[i] += T(lambda);
    });
    exert(world, island, system, &BatchWorkspace<S>::impulse, v);
  }
}

template <class S>
void solve_held(Island<S>& island, System<S>& system) {
  system.solve();
  if (system.share_held_loads()) island.factored = false;
}

// The same, where rows at a bound follow their load.
template <class S>
void solve_known_loads(WorldData<S>& world, Island<S>& island, System<S>& system) {
  begin_loads(world, island);
  const auto solve = [&] {
    system.give([](const Batch<S>& batch, int i) { return is_held(batch, i) ? batch.lambda[i] : batch.lower[i]; });
    solve_held(island, system);
    system.store([](Batch<S>& batch, int i, auto lambda) { batch.lambda[i] = typename S::Scalar(lambda); });
  };
  const auto known = [](const LoadedRow<S>&) { return RowSolution<typename S::Scalar>{}; };  // directions are known
  island.jams |= !settle_loads(island, solve, impulse_of_rows(island), known);
}

// K lambda = gamma - J dv/dt, with dv/dt without joints and known forces given.
template <class S>
void solve_accelerations(WorldData<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  System<S>& system = island.at_work();
  if (system.rows() == 0) return;
  auto* rate = world.bodies.velocity_rate.data();
  load_rates(island, system, rate);
  if (!island.factored) system.assemble(world.bodies);
  if (system.lawful()) {
    system.choose(is_held<S>);
    system.give([](const Batch<S>& batch, int i) { return batch.law ? batch.lower[i] : T(0); });
  }
  if (!island.factored) island.redundant_rows = system.factor();
  island.factored = true;
  if (island.loads.empty()) solve_held(island, system);
  else solve_known_loads(world, island, system);
  exert_solution(world, island, system, rate);
  refine(world, island, system, rate);
}

// The error that contradicting joints share in the last solve.
template <class S>
double largest_unmet(const System<S>& system) {
  double largest = 0;
  for (int r = 0; r < system.rows(); ++r) largest = std::max(largest, std::abs(double(system.unmet(r))));
  return largest;
}

// Selected rows are equations, but an end only has to be reached. Where equations contradict each other, as those of
// two ends of one coordinate, rows leave the selection that are at their end or get beyond it. True if there were some.
template <class S>
bool let_go_of_reached_ends(System<S>& system) {
  constexpr double plain = 1e-3;
  const double least = plain * largest_unmet(system);
  if (least == 0) return false;
  bool any = false;
  system.each_row([&](int row, const Batch<S>& batch, int i) {
    const double unmet = double(system.unmet(row));
    if (system.fixed[row] || is_held(batch, i) || !(std::abs(unmet) > least) || unmet * double(system.b[row]) > 0)
      return;
    system.fixed[row] = System<S>::at_lower, system.lambda[row] = 0;
    any = true;
  });
  return any;
}

// K lambda = -C, q += M^-1 J^T lambda.
template <class S>
void move_by_newton(WorldData<S>& world, Island<S>& island, System<S>& system) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  load_errors(system, T(-1));
  system.solve();
  if (let_go_of_reached_ends(system)) {
    system.factor();
    system.solve();
  }
  exert_correction(world, island, system, all.increment.data());
  for (int i : island.bodies) {
    all.pose[i] = S::moved(all.pose[i], all.increment[i]);
    all.displacement[i] = S::sum(all.displacement[i], all.increment[i], T(1));
    all.increment[i] = {};
  }
}

// A start may miss joints that nearly contradict each other. Where a round would move bodies too far, the rows that ask
// for it count as redundant. A row may return when another one is dropped, so rows could take turns for ever.
template <class S>
void drop_rows_that_move_far(WorldData<S>& world, Island<S>& island, System<S>& system, typename S::Scalar error) {
  auto& moves = world.bodies.increment;
  int drops = system.rows();
  for (bool far = true; far && drops > 0; --drops) {
    load_errors(system, typename S::Scalar(-1));
    system.solve();
    system.store([](Batch<S>& batch, int i, auto lambda) { batch.impulse[i] = typename S::Scalar(lambda); });
    exert(world, island, system, &BatchWorkspace<S>::impulse, moves.data());
    far = too_far(island, longest_move<S>(island, moves), double(error)) && system.drop_dominant_row();
    for (int i : island.bodies) moves[i] = {};
  }
}

// `fresh`: J and K are not yet those of the step. A round that leaves more than `enough` of the error renews them. If
// new ones do not halve the error, the rounds end: the joints contradict each other, C is at round-off, or the step was
// too long. Joints that fitted at the start first get back rows that were redundant there.
template <class S>
void solve_positions(WorldData<S>& world, Island<S>& island, typename S::Scalar time, bool fresh) {
  using T = typename S::Scalar;
  System<S>& system = island.at_work();
  T before = std::numeric_limits<T>::infinity();
  bool renewed = false,
       fitted = T(island.residual) <= std::max(converged<T> * island.scale, round_off_of(world, island));
  // Near a loss of rank the error is magnified, so nothing but round-off may stay.
  const T tolerance = island.flow.projects_stages ? std::numeric_limits<T>::epsilon() : converged<T>;
  system.blur(0);
  // Known forces do not act in a projection.
  system.give([](const Batch<S>&, int) { return 0.0; });
  // Without laws and at acceleration level the last solve left the right factor.
  const bool other_rows = system.lawful() && !island.acceleration_level;
  // There a correction that is to roll moves bodies far as well, to one side before the pose and to the other after it.
  const bool slips = island.flow.projects_stages && rolls(island);
  for (int round = 0;; ++round) {
    const T worst = find_errors(world, island, time);
    if (round == 0 && stays_misfit(world, island, worst, time - T(world.time))) return;
    island.residual = worst;
    note_errors(island);
    if (round == 0) island.misfit = 0;
    if (!(worst > tolerance * island.scale) || round == newton_rounds) return;
    // Adds rows that passed their bound since the selection. Selected rows stay.
    const bool more = round > 0 && other_rows && system.choose_more(has_error<S>);
    const bool slow = !more && worst > T(island.acceleration_level ? enough_at_acceleration_level : enough) * before;
    if (slow && renewed && worst > T(0.5) * before) {
      if (!fitted || !system.doubt_missed_rows()) return;
      fitted = false;
    }
    if (fresh) system.blur(double(worst / island.scale));
    if (slow || (fresh && round == 0)) {
      evaluate_anew(world, island, time);
      system.assemble(world.bodies);
      renewed |= slow;
    }
    if (round == 0 && (fresh || other_rows || slips))
      factor_rows_with_errors(system, slips ? Rates::free : Rates::kept, Factor::anew);
    else if (more || slow) system.factor();
    if (fresh && !island.acceleration_level) drop_rows_that_move_far(world, island, system, worst);
    before = worst;
    move_by_newton(world, island, system);
    island.misfit = largest_unmet(system);
  }
}

template <class S>
void project(WorldData<S>& world, Island<S>& island) {
  System<S>& system = island.at_work();
  load_rates(island, system, world.bodies.velocity.data());
  system.choose(is_held<S>);
  system.assemble(world.bodies);
  island.redundant_rows = system.factor();
  system.solve();
  count_rivals(world, system);
  exert_correction(world, island, system, world.bodies.velocity.data());
  island.factored = true;
}

template <class S>
void project_relaxed(WorldData<S>& world, Island<S>& island) {
  clear_correction(world, island);
  project(world, island);
  for (const auto& [batch, begin, end, whole] : island.segments)
    for (int i = begin * batch->ops->rows; i < end * batch->ops->rows; ++i) batch->lambda[i] += batch->correction[i];
}

}  // namespace

template <class S>
void factor_rows_with_errors(System<S>& system, Rates rates, Factor last) {
  system.choose([rates](const Batch<S>& batch, int i) {
    const bool of_rate = batch.kinds[static_cast<size_t>(i % batch.ops->rows)] == RowKind::velocity;
    return (rates == Rates::kept || !of_rate) && has_error(batch, i);
  });
  if (last == Factor::anew || !system.factored_as_selected()) system.factor();
}

// At acceleration level the projection corrects the method's error, so it is not part of the joints' impulses.
template <class S>
void exert_correction(const WorldData<S>& world, const Island<S>& island, System<S>& system, typename S::Velocity* to) {
  using T = typename S::Scalar;
  system.store([&](Batch<S>& batch, int i, auto lambda) {
    batch.impulse[i] = T(lambda);
    if (!island.acceleration_level) batch.correction[i] += T(lambda);
  });
  exert(world, island, system, &BatchWorkspace<S>::impulse, to);
}

template <class S>
const RowSolver<S>& direct_solver() {
  static constexpr RowSolver<S> solver{.exact = true,
                                       .renew = forget_factor<S>,
                                       .factor = factor<S>,
                                       .velocities = solve_velocities<S>,
                                       .soften = solve_soft<S>,
                                       .relax = project_relaxed<S>,
                                       .accelerations = solve_accelerations<S>,
                                       .positions = solve_positions<S>,
                                       .projection = project<S>,
                                       .share = shared_already<S>};
  return solver;
}

#define CDOT_INSTANTIATE(S)                                                                        \
  template void factor_rows_with_errors(System<S>&, Rates, Factor);                                \
  template void exert_correction(const WorldData<S>&, const Island<S>&, System<S>&, S::Velocity*); \
  template const RowSolver<S>& direct_solver();
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
