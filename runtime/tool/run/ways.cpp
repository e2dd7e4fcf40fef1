#include "runtime/tool/run/ways.hpp"

#include <cmath>
#include <fmt/format.h>

#include <cdot/methods.hpp>

namespace cdot {
namespace {

constexpr int most_doublings = 17;     // of the steps from one sample to the next
constexpr int most_exact_digits = 15;  // of a local error

constexpr auto euler = Integrator::euler, implicit = Integrator::implicit;
constexpr auto rattle = Integrator::rattle, rk4 = Integrator::rk4, dop853 = Integrator::dop853;
constexpr auto direct = Solver::direct, iterative = Solver::iterative;
constexpr auto none = Drift::none, baumgarte = Drift::baumgarte, projection = Drift::projection;

bool first_order(Integrator integrator) { return integrator == euler || integrator == implicit; }

}  // namespace

const std::vector<Way>& all_ways() {
  static const std::vector<Way> ways = {
      {euler, direct, none, 0},
      {euler, direct, baumgarte, 0},
      {euler, direct, projection, 0},
      {euler, direct, projection, 0, true},
      {euler, iterative, baumgarte, 4},
      {euler, iterative, baumgarte, 20},
      {euler, iterative, projection, 4},
      {euler, iterative, projection, 20},
      {implicit, direct, baumgarte, 0},
      {implicit, direct, projection, 0},
      {implicit, iterative, projection, 20},
      {rattle, direct, projection, 0},
      {rattle, direct, projection, 0, true},
      {rattle, iterative, projection, 20},
      {rk4, direct, projection, 0},
      {rk4, direct, projection, 0, true},
      {rk4, iterative, projection, 20},
      {rk4, direct, projection, 0, false, true},
      {dop853, direct, projection, 0},
      {dop853, direct, projection, 0, true},
      {dop853, iterative, projection, 20},
      {dop853, direct, projection, 0, false, true},
  };
  return ways;
}

std::string name_of(const Way& way) {
  std::string name(name_of(integrators, way.integrator));
  if (first_order(way.integrator) && way.drift != none) name += fmt::format(" + {}", name_of(drifts, way.drift));
  name += way.solver == direct ? ", direct" : fmt::format(", {} iterations", way.iterations);
  if (way.adaptive) name += ", adaptive";
  if (way.single) name += ", float";
  if (way.extended) name += ", extended precision";
  return name;
}

bool has_level(const Way& way, int level) {
  if (way.adaptive) return level < most_exact_digits;
  return level <= most_doublings * (first_order(way.integrator) ? 1 : 2);
}

Knob knob_at(const Way& way, int level) {
  if (way.adaptive) return {1, std::pow(10.0, -1 - level)};
  if (first_order(way.integrator)) return {1 << level, 0};
  if (level == 0) return {1, 0};
  return {level % 2 == 1 ? 1 << (level + 1) / 2 : 3 << (level / 2 - 1), 0};
}

Scene solved_by(const Way& way, const Knob& knob, Scene scene) {
  Settings& settings = scene.settings;
  settings.integrator = way.integrator;
  settings.local_error = knob.local_error;
  settings.solver = way.solver;
  settings.drift = way.drift;
  if (way.solver == iterative) settings.iterations = way.iterations;
  settings.substeps = 1;
  scene.single = way.single;
  settings.sleep_after = 0;  // sleep is an error of its own, and none of a solver or an integrator
  return scene;
}

}  // namespace cdot
