#include "runtime/tool/run/ways.hpp"

#include <cmath>
#include <fmt/format.h>

#include <cdot/methods.hpp>

namespace cdot {
namespace {

constexpr int most_doublings = 17;     // of the steps from one sample to the next
constexpr int most_exact_digits = 15;  // of a local error

constexpr auto direct = Solver::direct, iterative = Solver::iterative;
constexpr auto none = Drift::none, baumgarte = Drift::baumgarte, projection = Drift::projection;

bool first_order(Integrator integrator) { return row_of(integrator).order == 1; }

// Those of first order, for which the drift correction is a choice of its own.
const std::vector<Way> first_order_ways = {
    {Integrator::euler, direct, none, 0},
    {Integrator::euler, direct, baumgarte, 0},
    {Integrator::euler, direct, projection, 0},
    {Integrator::euler, direct, projection, 0, true},
    {Integrator::euler, iterative, baumgarte, 4},
    {Integrator::euler, iterative, baumgarte, 20},
    {Integrator::euler, iterative, projection, 4},
    {Integrator::euler, iterative, projection, 20},
    {Integrator::implicit, direct, baumgarte, 0},
    {Integrator::implicit, direct, projection, 0},
    {Integrator::implicit, iterative, projection, 20},
};

}  // namespace

const std::vector<Way>& all_ways() {
  static const std::vector<Way> ways = [] {
    std::vector<Way> ways = first_order_ways;
    for (const IntegratorRow& row : integrator_rows) {
      if (row.order == 1) continue;
      ways.push_back({row.integrator, direct, projection, 0});
      ways.push_back({row.integrator, direct, projection, 0, true});
      ways.push_back({row.integrator, iterative, projection, 20});
      if (row.level == Level::acceleration) ways.push_back({row.integrator, direct, projection, 0, false, true});
    }
    return ways;
  }();
  return ways;
}

std::string name_of(const Way& way) {
  std::string name(name_of(integrators, way.integrator));
  if (first_order(way.integrator) && way.drift != none) name += fmt::format(" + {}", name_of(drifts, way.drift));
  name += sweeps(way.solver) ? fmt::format(", {} iterations", way.iterations) : ", direct";
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
  if (sweeps(way.solver)) settings.iterations = way.iterations;
  settings.substeps = 1;
  scene.single = way.single;
  settings.sleep_after = 0;  // sleep is an error of its own, and none of a solver or an integrator
  return scene;
}

}  // namespace cdot
