#include "runtime/events/impacts.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/events/bonds.hpp"
#include "runtime/events/guarded.hpp"
#include "runtime/events/latch.hpp"
#include "runtime/solve/projection.hpp"

namespace cdot {
namespace {

// Blows follow as long as each strikes less hard than this share of the one before. Then a row waits for its own event.
constexpr double weaker = 0.5;

// True if a row stops or drives its bodies by an impulse: an end that is met, a latch that closes, or a clutch of
// unlimited force that meets a rate beyond its own. `missing` is what the row lacks to its rate; has_events: it may be
// a latch, which from its event on holds its bodies on both sides.
template <class T>
bool strikes(const Guard<T>& guard, const Resolution<T>& resolution, T missing, bool has_events) {
  const T bound = missing > T(0) ? guard.upper : guard.lower;
  const bool may_act = guard.one_sided() ? guard.gap() <= resolution.C
                       : guard.of_rate   ? !guard.bilateral()
                                         : has_events;
  return may_act && std::isinf(bound) && std::abs(missing) > resolution.rate;
}

// True for a motor of unlimited force that lacks its rate by `missing`.
template <class T>
bool is_stopped(const Guard<T>& guard, const Resolution<T>& resolution, T missing) {
  return guard.bilateral() && guard.of_rate && std::abs(missing) > T(4) * resolution.rate;
}

// True for a motor that ends stop, as find_pressed_ends() notes it.
template <class T>
bool stands(const Guard<T>& guard, Mode mode) {
  return guard.bilateral() && guard.of_rate && (mode == Mode::pushed || mode == Mode::pulled);
}

// True if an impact at another row may call for an impulse of this one.
template <class S>
bool may_strike(const Batch<S>& batch, int i, const Guard<typename S::Scalar>& guard,
                const Resolution<typename S::Scalar>& resolution) {
  if (stands(guard, batch.mode[i])) return false;
  if (batch.law->by_load) return true;
  if (guard.one_sided()) return guard.gap() <= resolution.C;
  return guard.bilateral() || (guard.of_rate && (std::isinf(guard.lower) || std::isinf(guard.upper)));
}

// The row that strikes hardest, in units of its resolution.
template <class S>
Blow what_hits(Island<S>& island) {
  using T = typename S::Scalar;
  T hardest = 0;
  Blow blow;
  each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>& guard, const Resolution<T>& resolution) {
    const T missing = missing_of(batch, i, guard), share = std::abs(missing) / resolution.rate;
    if (!strikes(guard, resolution, missing, batch.law->distance && island.kinked < 0) || !(share > hardest)) return;
    hardest = share;
    blow.source = static_cast<int>(batch.source), blow.joint = batch.joint[i / batch.ops->rows];
  });
  return blow;
}

// Bounds of impulses: rows at their ends only push, or hold where motors press; motors with a bounded force do not act.
// Loads begin at none: friction that jams would keep a load that it once had.
template <class S>
void offer_impulses(Island<S>& island) {
  using T = typename S::Scalar;
  clear_laws(island);
  fill_lambda(island, T(0));
  each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>& guard, const Resolution<T>& resolution) {
    if (!may_strike(batch, i, guard, resolution)) return;
    const bool pressed = batch.mode[i] == Mode::pressed;
    batch.lower[i] = pressed || std::isinf(guard.lower) ? -std::numeric_limits<T>::infinity() : T(0);
    batch.upper[i] = pressed || std::isinf(guard.upper) ? std::numeric_limits<T>::infinity() : T(0);
    batch.bias[i] -= guard.rate;
  });
}

// Takes back what offer_impulses() put into Batch::bias.
template <class S>
void take_back_rates(Island<S>& island) {
  using T = typename S::Scalar;
  each_guarded_row(island, [](Batch<S>& batch, int i, const Guard<T>& guard, const Resolution<T>& resolution) {
    if (may_strike(batch, i, guard, resolution)) batch.bias[i] += guard.rate;
  });
}

// Rows that have struck are `held`, because sweeps leave a rate that is not exactly 0.
template <class S>
void hold_what_struck(Island<S>& island) {
  using T = typename S::Scalar;
  each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>& guard, const Resolution<T>& resolution) {
    if (batch.mode[i] == Mode::pressed || !may_strike(batch, i, guard, resolution)) return;
    const bool slips = batch.law->by_load && !(batch.lower[i] < batch.lambda[i] && batch.lambda[i] < batch.upper[i]);
    if (batch.lambda[i] != T(0) && !slips) batch.mode[i] = Mode::held;
  });
}

// True if a motor of unlimited force that does not stand lacks its rate.
template <class S>
bool lacks_motors(Island<S>& island) {
  using T = typename S::Scalar;
  bool any = false;
  each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>& guard, const Resolution<T>& resolution) {
    any |= !stands(guard, batch.mode[i]) && is_stopped(guard, resolution, missing_of(batch, i, guard));
  });
  return any;
}

// True if an end is met beside a motor of unlimited force.
template <class S>
bool may_press(Island<S>& island) {
  using T = typename S::Scalar;
  bool met = false, motor = false;
  each_guarded_row(island, [&](Batch<S>&, int, const Guard<T>& guard, const Resolution<T>& resolution) {
    met |= guard.one_sided() && guard.gap() <= resolution.C;
    motor |= guard.bilateral() && guard.of_rate;
  });
  return met && motor;
}

// Rows that have struck stay `held`; others have no mode yet.
template <class S>
void forget_pressed_ends(Island<S>& island) {
  each_row(island, [](Batch<S>& batch, int i) {
    if (batch.law && batch.law->guard && batch.mode[i] != Mode::held) batch.mode[i] = Mode::bounded;
  });
}

// The impulses that rows need for their rates, which change the velocities.
template <class S>
void strike(WorldData<S>& world, Island<S>& island) {
  offer_impulses(island);
  solve(world, island, world.bodies.velocity.data());
  take_back_rates(island);
}

// Ends are `pressed` whose impulse has grown from that in Batch::impulse, by more than the share `few` of the largest
// growth, and motors that stand `pushed` or `pulled`. Beside what others lack, a motor that turns back lacks round-off.
// None if no impulse has grown.
template <class S>
void note_pressed_ends(Island<S>& island) {
  using T = typename S::Scalar;
  constexpr T few = T(1e-3), round_off = T(1e-6);
  const auto growth = [](const Batch<S>& batch, int i) { return std::abs(batch.lambda[i] - batch.impulse[i]); };
  T largest = 0, lacked = 0;
  each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>& guard, const Resolution<T>& resolution) {
    const T missing = missing_of(batch, i, guard);
    if (guard.one_sided()) largest = std::max(largest, growth(batch, i));
    if (is_stopped(guard, resolution, missing)) lacked = std::max(lacked, std::abs(missing));
  });
  if (largest == T(0)) return;
  each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>& guard, const Resolution<T>& resolution) {
    const T missing = missing_of(batch, i, guard);
    if (guard.one_sided() && growth(batch, i) > few * largest) batch.mode[i] = Mode::pressed;
    if (is_stopped(guard, resolution, missing) && std::abs(missing) > round_off * lacked)
      batch.mode[i] = missing > T(0) ? Mode::pushed : Mode::pulled;
  });
}

// Adds the impulses to those of the step.
template <class S>
void count_impulses(const Island<S>& island) {
  each_row(island, [](Batch<S>& batch, int i) { batch.correction[i] += batch.lambda[i]; });
}

// The error [share of rates] that a run by this local error has at least, in a step and in those before it.
template <class S>
typename S::Scalar error_of_rates(const WorldData<S>& world) {
  using T = typename S::Scalar;
  constexpr double of_steps = 10;
  return std::max(T(of_steps * world.settings.local_error), T(16) * std::numeric_limits<T>::epsilon());
}

// The speed of a row if its bodies moved along it, by the velocities in Bodies::displacement.
template <class S>
typename S::Scalar speed_along(const WorldData<S>& world, const Island<S>& island, const Batch<S>& batch, int slot,
                               const Resolution<typename S::Scalar>& resolution) {
  using T = typename S::Scalar;
  T pace = 0, v[S::freedom];
  for (int k = slot * batch.ops->bodies; k < (slot + 1) * batch.ops->bodies; ++k) {
    S::write(world.bodies.displacement[batch.body[k]], v);
    T straight = 0, turning = 0;
    for (int i = 0; i < S::freedom; ++i) (i < S::lengths ? straight : turning) += v[i] * v[i];
    pace = std::max({pace, std::sqrt(straight) / T(island.size), std::sqrt(turning)});
  }
  return resolution.C / slight<T> * pace;
}

// The blow where ends are met faster by this share of what the speeds may be: from the velocities in
// Bodies::displacement.
template <class S>
void strike_faster(WorldData<S>& world, Island<S>& island, typename S::Scalar share) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  const auto meet_faster = [&](T by) {
    each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>& guard, const Resolution<T>& resolution) {
      if (guard.one_sided() && guard.gap() <= resolution.C)
        batch.bias[i] -= by * speed_along(world, island, batch, i / batch.ops->rows, resolution);
    });
  };
  for (int i : island.bodies) all.velocity[i] = all.displacement[i];
  offer_impulses(island);
  meet_faster(share);
  solve(world, island, all.velocity.data());
  meet_faster(-share);
  take_back_rates(island);
}

// |change of the velocities| / |velocities at the start| in the metric of the masses, between ends that are met by this
// share of their rates faster and slower.
template <class S>
double change_by(WorldData<S>& world, Island<S>& island, typename S::Scalar share) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  strike_faster(world, island, -share);
  for (int i : island.bodies) all.increment[i] = all.velocity[i];
  strike_faster(world, island, share);
  double changed = 0, whole = 0;
  for (int i : island.bodies) {
    const auto d = S::sum(all.velocity[i], all.increment[i], T(-1)), &start = all.displacement[i];
    changed += S::dot(S::force(all.inverse_mass[i], d), d);
    whole += S::dot(S::force(all.inverse_mass[i], start), start);
    all.velocity[i] = start, all.increment[i] = {};
  }
  return std::sqrt(changed / whole);
}

// True if an error as small as that of the steps changes the blow a thousand times as much. Friction that jams, since
// it grows with the load that it causes, begins at any load. The state stays that before the blow.
template <class S>
bool is_undecided(WorldData<S>& world, Island<S>& island) {
  constexpr double most = 1e3, at_most = 0.1;
  const bool jams = island.jams;
  for (int i : island.bodies) world.bodies.displacement[i] = world.bodies.velocity[i];
  each_row(island, [](Batch<S>& batch, int i) {
    batch.impulse[i] = batch.lambda[i];
    if (batch.law && batch.law->cone_rows > 0) batch.error[i] = batch.share_of_cone(i);
  });
  const auto error = error_of_rates(world);
  const bool undecided = change_by(world, island, error) > std::min(most * double(error), at_most);
  each_row(island, [](Batch<S>& batch, int i) {
    batch.lambda[i] = batch.impulse[i];
    if (batch.law && batch.law->cone_rows > 0) batch.share_of_cone(i) = batch.error[i];
  });
  island.jams = jams;
  return undecided;
}

// True if the impulses of a blow, which has acted, end a joint or a row.
template <class S>
bool breaks_by_blow(WorldData<S>& world, Island<S>& island, typename S::Scalar time, typename S::Scalar h) {
  if (!island.flow.locates) return false;
  const auto lasts = world.settings.local_error > 0 ? typename S::Scalar(impact_time) : h;
  find_rates(world, island);
  const bool latched = latch_by_lambda(island, lasts), broken = break_by_lambda(world, island, time, lasts);
  if (latched || broken) fill_lambda(island, typename S::Scalar(0));  // no forces
  return latched || broken;
}

// Counts a blow that is undecided.
template <class S>
void judge_blow(WorldData<S>& world, Island<S>& island, const Blow& blow) {
  if (!is_undecided(world, island)) return;
  if (world.counts->undecided++ == 0) world.counts->undecided_joint = blow.joint;
}

}  // namespace

template <class S>
bool stop_what_hits(WorldData<S>& world, Island<S>& island, typename S::Scalar time, typename S::Scalar h, Blow& blow) {
  find_rates(world, island);
  const Blow now = what_hits(island);
  if (now.source < 0) return false;
  blow.source = now.source, blow.joint = now.joint, blow.left = kinetic_energy(world, island);
  if (world.settings.local_error > 0 && island.flow.locates && !island.loads.empty()) judge_blow(world, island, blow);
  strike(world, island);
  hold_what_struck(island);
  end_blow(world, island, blow);
  count_impulses(island);
  return breaks_by_blow(world, island, time, h);
}

// Motors push ten thousand times as hard as the bodies are heavy, and half of that: with them grow the impulses of the
// ends on which they press, and no others.
template <class S>
void find_pressed_ends(WorldData<S>& world, Island<S>& island) {
  constexpr double nearly_rigid = 1e-4;
  forget_pressed_ends(island);
  if (!may_press(island)) return;
  const bool jams = island.jams;
  Bodies<S>& all = world.bodies;
  for (int i : island.bodies) all.displacement[i] = all.velocity[i];
  for (const double softness : {2 * nearly_rigid, nearly_rigid}) {
    each_row(island, [](Batch<S>& batch, int i) { batch.impulse[i] = batch.lambda[i]; });
    for (int i : island.bodies) all.velocity[i] = all.displacement[i];
    island.system.softness_of_motors = softness;
    strike(world, island);
  }
  island.system.softness_of_motors = System<S>::usual_softness;
  find_rates(world, island);
  if (lacks_motors(island)) note_pressed_ends(island);
  island.jams = jams;
  for (int i : island.bodies) all.velocity[i] = all.displacement[i];
}

template <class S>
bool start_motors(WorldData<S>& world, Island<S>& island, typename S::Scalar time, typename S::Scalar h) {
  find_rates(world, island);
  if (!lacks_motors(island)) return false;
  const double before = kinetic_energy(world, island);
  strike(world, island);
  book_change(world, Source::motor, kinetic_energy(world, island) - before);
  return breaks_by_blow(world, island, time, h);
}

template <class S>
void end_blow(WorldData<S>& world, const Island<S>& island, Blow& blow) {
  const double left = kinetic_energy(world, island), lost = blow.left - left;
  blow.left = left;
  if (lost >= 0) take(world, static_cast<Source>(blow.source), lost);
  else put_in(world, static_cast<Source>(blow.source), -lost);  // by an end that moves
}

template <class S>
bool another_follows(Island<S>& island, Blow& blow) {
  using T = typename S::Scalar;
  if (!island.solver->exact || blow.source < 0) return false;  // sweeps leave rates that are not exactly 0
  double hardest = 0;
  each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>& guard, const Resolution<T>& resolution) {
    const T missing = missing_of(batch, i, guard);
    if (batch.mode[i] == Mode::off && strikes(guard, resolution, missing, false))
      hardest = std::max(hardest, double(std::abs(missing) / resolution.rate));
  });
  const bool follows = hardest > 0 && hardest < weaker * blow.follower;
  blow.follower = hardest;
  return follows;
}

#define CDOT_INSTANTIATE(S)                                                             \
  template bool stop_what_hits(WorldData<S>&, Island<S>&, S::Scalar, S::Scalar, Blow&); \
  template void find_pressed_ends(WorldData<S>&, Island<S>&);                           \
  template bool start_motors(WorldData<S>&, Island<S>&, S::Scalar, S::Scalar);          \
  template bool another_follows(Island<S>&, Blow&);                                     \
  template void end_blow(WorldData<S>&, const Island<S>&, Blow&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
