// The table of integrators -> the ways to compare.
#include "runtime/tool/run/ways.hpp"

#include <cmath>
#include <fmt/format.h>

#include <cdot/methods.hpp>

namespace cdot {
namespace {

constexpr int most_doublings = 17;     // of the steps from one sample to the next
constexpr int most_exact_digits = 15;  // of a local error

constexpr auto direct = Solver::direct, iterative = Solver::iterative;
constexpr auto none = Drift::none, baumgarte = Drift::baumgarte, projection = Drift::projection, soft = Drift::soft;

// Methods of first order may choose their drift correction; the plain ones show every choice.
bool first_order(const IntegratorRow& row) { return row.order == 1; }
bool plain(const IntegratorRow& row) { return row.order == 1 && !row.stiffens; }
bool not_stiffening(const IntegratorRow& row) { return !row.stiffens; }
bool chooses_steps(const IntegratorRow& row) { return row.level == Level::acceleration; }
bool any(const IntegratorRow&) { return true; }

// Each row is a way for every integrator that it suits.
// clang-format off
constexpr struct {
  bool (*suits)(const IntegratorRow&);
  Solver solver;
  Drift drift;
  int iterations;
  bool single, adaptive;
} way_rows[] = {
    {plain,          direct,    none,       0,  false, false},
    {first_order,    direct,    baumgarte,  0,  false, false},
    {any,            direct,    projection, 0,  false, false},
    {not_stiffening, direct,    projection, 0,  true,  false},
    {plain,          iterative, baumgarte,  4,  false, false},
    {plain,          iterative, baumgarte,  20, false, false},
    {plain,          iterative, soft,       1,  false, false},
    {plain,          iterative, soft,       10, false, false},
    {plain,          iterative, projection, 4,  false, false},
    {any,            iterative, projection, 20, false, false},
    {chooses_steps,  direct,    projection, 0,  false, true},
};
// clang-format on

}  // namespace

const std::vector<Way>& all_ways() {
  static const std::vector<Way> ways = [] {
    std::vector<Way> ways;
    for (const IntegratorRow& row : integrator_rows)
      for (const auto& [suits, solver, drift, iterations, single, adaptive] : way_rows)
        if (suits(row) && (row.any_solver || !sweeps(solver)))
          ways.push_back({row.integrator, solver, drift, iterations, single, adaptive});
    return ways;
  }();
  return ways;
}

std::string name_of(const Way& way) {
  std::string name(name_of(integrators, way.integrator));
  if (first_order(row_of(way.integrator)) && way.drift != none)
    name += fmt::format(" + {}", name_of(drifts, way.drift));
  name += sweeps(way.solver) ? fmt::format(", {} iterations", way.iterations) : ", direct";
  if (way.adaptive) name += ", adaptive";
  if (way.single) name += ", float";
  if (way.extended) name += ", extended precision";
  if (way.lanes > 0) name += ", compiled";
  if (way.lanes > 1) name += fmt::format(", {} lanes", way.lanes);
  return name;
}

bool has_level(const Way& way, int level) {
  if (way.adaptive) return level < most_exact_digits;
  return level <= most_doublings * (first_order(row_of(way.integrator)) ? 1 : 2);
}

Knob knob_at(const Way& way, int level) {
  if (way.adaptive) return {1, std::pow(10.0, -1 - level)};
  if (first_order(row_of(way.integrator))) return {1 << level, 0};
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
  settings.sleep_after = 0;  // sleep is an error, but not of a solver or an integrator
  return scene;
}

}  // namespace cdot
