// The stiffness, spin and size of each island -> the integrator for fixed steps.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <set>

#include <cdot/recommended.hpp>
#include <cdot/spaces.hpp>

#include "runtime/diagnose/concerns.hpp"
#include "runtime/diagnose/equations.hpp"
#include "runtime/motion/motion.hpp"

namespace cdot {
namespace {

// The tension at the lowest point of a pendulum that falls from the height of its pivot, in units of its weight.
constexpr double swing = 3;
// [rad] per substep. Methods that take forces at the ends of a step are inaccurate above.
constexpr double stiff = 0.5, quick_turn = 0.4;
// [rad] per substep of an oscillation by tension that the eighth order follows: measured on pendulums, chains and loops
// of bars over 60 s, its energy is off by 2e-4 at most up to 0.75 rad, and by 5e-2 at 1.1 rad.
constexpr double followed = 0.75;
// The substeps [rad] that replace one that the eighth order does not follow, and the most of them.
constexpr double short_turn = 0.5, most_turns = 1024;
// A body that rotates about a pivot beside its centre oscillates about that rotation no faster than this, in units of
// its rate: its stiffness is that of the spin, not of a load.
constexpr double of_own_spin = 1.5;
// Heaviest over lightest body: a light one between heavy ones turns round within a step whenever its load vanishes. Up
// to quick_turn the eighth order follows that; above, it makes up energy, where the midpoint rule only errs.
constexpr double uneven = 100;
constexpr std::size_t large = 300;  // [bodies]: looking for the stiffest motion would cost more than the method saves

// Mechanisms that are equal in these numbers count as equally stiff: bodies, rows, size [m], lightest and heaviest
// [kg].
using Kind = std::array<double, 5>;

struct Traits {
  int island = -1;
  std::size_t bodies = 0;
  double lightest = 0, heaviest = 0;  // [kg]
  bool bounded = false;               // limits, motors, friction, ropes
  double radians = 0, turn = 0;       // per substep, of the stiffest oscillation and of the fastest rotation
  int oscillating = -1, turning = -1;
  bool by_tension = false;
  double limited = 0;  // stiffness of a force with limits, for the step
  double decay = 0;    // of the fastest decay, per substep
  int decaying = -1;
};

bool is_stiff(const Traits& t) {
  return t.radians > stiff && !(t.by_tension && t.radians < std::max(followed, of_own_spin * t.turn));
}

bool is_uneven(const Traits& t) { return t.heaviest > uneven * t.lightest; }

// Dampers make the steps of the eighth order unstable.
bool is_damped(const Traits& t) { return t.decay > row_of(Integrator::dop853).stable_decay / 2; }

struct Words {
  const Traits& of;
  const std::function<std::string(int)>& name_of_body;
  std::string body(int index) const { return name_of_body ? name_of_body(index) : fmt::format("body {}", index); }
};

std::string uneven_masses(const Words& w) {
  return fmt::format("bodies from {:.3g} to {:.3g} kg hang together, at most {:.2g} rad per substep", w.of.lightest,
                     w.of.heaviest, w.of.radians);
}

// In this order: the first rule that applies to an island of the World decides. The last one applies to every island.
// clang-format off
constexpr struct {
  Integrator integrator;
  bool (*applies)(const Traits&);
  std::string (*why)(const Words&);
} rules[] = {
    {Integrator::euler,
     [](const Traits& t) { return t.limited > 1; },
     [](const Words& w) {
       return fmt::format("the force of an effect with limits is {:.2g} times too stiff for the step", w.of.limited);
     }},
    {Integrator::implicit,
     is_stiff,
     [](const Words& w) {
       return fmt::format("{} can make {} oscillate by {:.2g} rad per substep",
                          w.of.by_tension ? "the tension of the joints" : "a spring", w.body(w.of.oscillating), w.of.radians);
     }},
    {Integrator::implicit,
     [](const Traits& t) { return is_damped(t) && (t.turn > quick_turn || t.radians > quick_turn || is_uneven(t)); },
     [](const Words& w) {
       return fmt::format("dampers slow {} at a rate of {:.2g} per substep", w.body(w.of.decaying), w.of.decay);
     }},
    {Integrator::dop853,
     [](const Traits& t) { return t.turn > quick_turn && t.radians > quick_turn; },
     [](const Words& w) {
       return fmt::format("{} rotates by {:.2g} rad per substep about a pivot beside its centre", w.body(w.of.turning), w.of.turn);
     }},
    {Integrator::implicit,
     [](const Traits& t) { return t.bounded; },
     [](const Words&) { return std::string("limits, motors, friction or ropes act"); }},
    {Integrator::implicit,
     [](const Traits& t) { return is_uneven(t) && t.radians > quick_turn; },
     uneven_masses},
    {Integrator::implicit,
     [](const Traits& t) { return t.bodies > large; },
     [](const Words& w) { return fmt::format("{} bodies hang together", w.of.bodies); }},
    {Integrator::dop853,
     is_uneven,
     uneven_masses},
    {Integrator::dop853,
     [](const Traits& t) { return t.radians > stiff; },
     [](const Words& w) {
       return fmt::format("{} oscillates by {:.2g} rad per substep, which the eighth order follows", w.body(w.of.oscillating), w.of.radians);
     }},
    {Integrator::rattle,
     [](const Traits&) { return true; },
     [](const Words& w) { return fmt::format("nothing is stiff: at most {:.2g} rad per substep", std::max(w.of.radians, w.of.turn)); }},
};
// clang-format on

// Adds the difference between another gravity and the present one to the accelerations of an island.
template <class S>
void turn_gravity(WorldData<S>& world, const Island<S>& island, const Settings& from, const Settings& to) {
  using T = typename S::Scalar;
  for (int i : island.bodies) {
    auto& a = world.bodies.acceleration[i];
    a = S::sum(S::sum(a, S::gravity(from), T(-1)), S::gravity(to), T(1));
  }
}

template <class S>
void look_at_stiffest(WorldData<S>& world, Island<S>& island, double h, Traits& traits) {
  Equations<S> equations(world, island);
  const Diagnosis::Stiffest found = stiffest_motion(world, island, equations, typename S::Scalar(h));
  const double radians = h * std::sqrt(std::max(0.0, found.square));
  if (!(radians > traits.radians)) return;
  traits.radians = radians, traits.oscillating = found.body;
  traits.by_tension = found.tension > 0.5 * found.square;
}

template <class S>
void look_at_decay(WorldData<S>& world, Island<S>& island, double h, Traits& traits) {
  Equations<S> equations(world, island);
  const Diagnosis::Decay found = fastest_decay(world, island, equations);
  traits.decay = h * found.rate, traits.decaying = found.body;
}

// The stiffest motion with `swing` times the weight from every side.
template <class S>
void look_at_every_side(WorldData<S>& world, Island<S>& island, double h, Traits& traits) {
  const Settings& s = world.settings;
  const double weight = swing * std::hypot(s.gravity_x, s.gravity_y, s.gravity_z);
  if (weight == 0 || island.floats) return;
  Settings now = s;
  for (double Settings::*side : {&Settings::gravity_x, &Settings::gravity_y, &Settings::gravity_z}) {
    if (S::dimension == Dimension::planar && side == &Settings::gravity_z) continue;
    for (const double sign : {-1.0, 1.0}) {
      Settings turned = s;
      turned.gravity_x = turned.gravity_y = turned.gravity_z = 0;
      turned.*side = sign * weight;
      turn_gravity(world, island, now, turned);
      now = turned;
      look_at_stiffest(world, island, h, traits);
    }
  }
  turn_gravity(world, island, now, s);
}

template <class S>
Traits traits_of(WorldData<S>& world, int index, double h, std::set<Kind>& known) {
  Island<S>& island = world.islands[index];
  Traits traits{.island = index, .bodies = island.bodies.size()};
  bool lawful = false;
  for (const Segment<S>& segment : island.segments) {
    lawful |= segment.batch->law != nullptr;
    traits.bounded |= segment.batch->law && segment.batch->law->guard && segment.begin < segment.end;
  }
  traits.limited = stiffest_limited_force(world, island, typename S::Scalar(h));
  for (int body : island.bodies) {
    const double turn = h * spin_of<S>(world.bodies.velocity[body]);
    if (turn > traits.turn) traits.turn = turn, traits.turning = body;
    const double mass = 1 / double(world.bodies.inverse_mass[body].m);
    traits.heaviest = std::max(traits.heaviest, mass);
    traits.lightest = traits.lightest > 0 ? std::min(traits.lightest, mass) : mass;
  }
  if (island.segments.empty() || island.bodies.size() > large) return traits;
  const Kind kind{double(island.bodies.size()), double(island.system.rows()), double(island.size), traits.lightest,
                  traits.heaviest};
  if (!lawful && !known.insert(kind).second) return traits;
  look_at_decay(world, island, h, traits);
  look_at_stiffest(world, island, h, traits);
  look_at_every_side(world, island, h, traits);
  return traits;
}

// Of all islands, the one to which the first rule applies; of these the stiffest.
struct Decision {
  std::size_t rule = std::size(rules) - 1;
  Traits traits;
};
void take(Decision& worst, const Traits& traits) {
  const auto rule = static_cast<std::size_t>(
      std::find_if(std::begin(rules), std::end(rules), [&](const auto& one) { return one.applies(traits); }) -
      std::begin(rules));
  const bool worse = rule < worst.rule || (rule == worst.rule && traits.radians >= worst.traits.radians);
  if (worst.traits.island < 0 || worse) worst = {rule, traits};
}

}  // namespace

template <class S>
Recommendation recommended(BasicWorld<S>& world, double step, const std::function<std::string(int)>& name_of_body) {
  WorldData<S>& data = world.data();
  const Settings given = data.settings;
  Settings chosen = given;
  chosen.solver = Solver::direct, chosen.drift = Drift::projection, chosen.local_error = 0;
  chosen.integrator = Integrator::rattle;  // takes springs as forces, so that their stiffness counts
  world.use(chosen);
  world.prepare();
  const Snapshot before = world.snapshot();
  Decision worst;
  std::set<Kind> known;
  for (int k = 0; k < static_cast<int>(data.islands.size()); ++k)
    take(worst, traits_of(data, k, step / given.substeps, known));
  world.restore(before);
  world.use(given);
  const auto& rule = rules[worst.rule];
  chosen.integrator = rule.integrator;
  std::string reason = rule.why({worst.traits, name_of_body});
  if (chosen.integrator == Integrator::dop853 && worst.traits.turn > followed_turn(row_of(Integrator::dop853))) {
    chosen.substeps *= static_cast<int>(std::min(std::ceil(worst.traits.turn / short_turn), most_turns));
    reason += fmt::format("; {} substeps", chosen.substeps);
  }
  return {chosen, worst.traits.island, worst.traits.radians, reason};
}

namespace {

constexpr int most_substeps = 64, steps_measured = 5;

// The mean time [s] of a step, after the first one; infinite if a step fails.
template <class S>
double cost_of_step(BasicWorld<S>& world, const Settings& settings, double step) {
  using Clock = std::chrono::steady_clock;
  world.use(settings);
  world.prepare();
  const Snapshot before = world.snapshot();
  bool well = bool(world.step(step));
  const auto start = Clock::now();
  for (int k = 0; k < steps_measured; ++k) well = world.step(step) && well;
  const double taken = std::chrono::duration<double>(Clock::now() - start).count() / steps_measured;
  world.restore(before);
  return well ? taken : std::numeric_limits<double>::infinity();
}

template <class S>
Recommendation fewest_iterations(BasicWorld<S>& world, double step, double budget, const Settings& given,
                                 double direct) {
  Recommendation found;
  found.settings = given;
  found.settings.solver = Solver::iterative, found.settings.integrator = Integrator::euler;
  found.settings.local_error = 0, found.settings.drift = Drift::projection, found.settings.substeps = 1;
  for (const int iterations : {50, 20, 10, 4, 2, 1}) {
    found.settings.iterations = iterations;
    const double cost = cost_of_step(world, found.settings, step);
    found.reason =
        fmt::format("a step of the direct solver takes {:.2g} s, of {} iteration{} {:.2g} s, the budget is {:.2g} s",
                    direct, iterations, iterations == 1 ? "" : "s", cost, budget);
    if (cost <= budget) break;
  }
  return found;
}

}  // namespace

template <class S>
Recommendation recommended_within(BasicWorld<S>& world, double step, double budget,
                                  const std::function<std::string(int)>& name_of_body) {
  const Settings given = world.settings();
  Recommendation best;
  double cost = 0;
  for (int substeps = 1; substeps <= most_substeps; substeps *= 2) {
    Settings finer = given;
    finer.substeps = substeps;
    world.use(finer);
    const Recommendation found = recommended(world, step, name_of_body);
    cost = cost_of_step(world, found.settings, step);
    if (!(cost <= budget)) break;
    best = found;
    best.reason += fmt::format("; {} substeps take {:.2g} s of {:.2g} s", substeps, cost, budget);
  }
  if (best.reason.empty()) best = fewest_iterations(world, step, budget, given, cost);
  world.use(given);
  return best;
}

#define CDOT_INSTANTIATE(S)                                                                            \
  template Recommendation recommended(BasicWorld<S>&, double, const std::function<std::string(int)>&); \
  template Recommendation recommended_within(BasicWorld<S>&, double, double, const std::function<std::string(int)>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
