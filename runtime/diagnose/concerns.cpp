// The diagnosis of an island -> concerns about the method.
#include "runtime/diagnose/concerns.hpp"

#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cdot/methods.hpp>

namespace cdot {
namespace {

constexpr double slow_turn = 0.02, needs_no_help = 0.5;   // [rad] per step
constexpr double sweeps_per_condition = 4;                // after which little error is left
constexpr double float_round_off = 6e-8, inexact = 0.01;  // relative

std::string advised(Integrator integrator) {
  return fmt::format("integrator = \"{}\"", name_of(integrators, integrator));
}
const std::string tension_taken = advised(most_exact([](const IntegratorRow& row) { return row.stiffens; }));
const std::string turns_kept =
    advised(most_exact([](const IntegratorRow& row) { return row.level == Level::velocity && !row.stiffens; }));
const std::string in_own_steps = " with local_error = 1e-6";
const std::string own_steps =
    advised(most_exact([](const IntegratorRow& row) { return row.level == Level::acceleration; })) + in_own_steps;
const std::string own_steps_if_stiff = advised(most_exact([](const IntegratorRow& row) {
                                         return row.level == Level::acceleration && row.stable_decay == always;
                                       })) +
                                       in_own_steps;

std::string listed(const std::vector<int>& joints, const Names& names) {
  constexpr std::size_t most = 6;
  std::vector<std::string> words;
  for (std::size_t k = 0; k < joints.size() && k < most; ++k) words.push_back(names.joint(joints[k]));
  if (joints.size() > most) words.push_back(fmt::format("{} more", joints.size() - most));
  return fmt::format("{}", fmt::join(words, ", "));
}

void on_rows(const Diagnosis::Island& island, const Names& names, std::vector<Concern>& concerns) {
  for (const Diagnosis::Redundant& redundant : island.redundant)
    if (redundant.conflicting)
      concerns.push_back(
          {true,
           fmt::format("{} contradict each other: row {} of {} differs by {:.3g} m or rad; steps solve them "
                       "in the sense of least squares",
                       listed(redundant.joints, names), redundant.row.row + 1, names.joint(redundant.row.joint),
                       std::abs(redundant.missed)),
           "correct the anchors or the lengths of one of them, or remove it"});
  for (const Diagnosis::NearlyRedundant& nearly : island.nearly_redundant)
    if (island.mobility == 0)
      concerns.push_back(
          {true,
           fmt::format("the structure is rigid but for {:.1g} m or rad per m: row {} of {} is nearly redundant, and "
                       "without it {} would move; it cannot follow",
                       nearly.per_way, nearly.row.row + 1, names.joint(nearly.row.joint), names.body(nearly.body)),
           "if it should move, make axes parallel, lengths equal or anchors fit exactly, or remove that joint's row"});
  for (const Diagnosis::Redundant& redundant : island.redundant)
    if (redundant.undecided != 0)
      concerns.push_back(
          {true,
           fmt::format(
               "branches of the motion cross in this pose, and the velocities follow none of them: row {} of {} "
               "is redundant here only, and no acceleration keeps it, by {:.3g} m/s^2 or rad/s^2",
               redundant.row.row + 1, names.joint(redundant.row.joint), std::abs(redundant.undecided)),
           "give the velocities of one branch, or start beside this pose"});
  const int harmless =
      static_cast<int>(std::count_if(island.redundant.begin(), island.redundant.end(),
                                     [](const auto& r) { return !r.conflicting && r.undecided == 0; }));
  if (harmless > 0)
    concerns.push_back(
        {false,
         fmt::format("{} redundant row{}: the motion is unique, the split of forces between the joints is not",
                     harmless, harmless == 1 ? "" : "s"),
         ""});
}

void on_limited_forces(const Diagnosis::Island& island, const Settings& settings, std::vector<Concern>& concerns) {
  if (settings.local_error > 0 || settings.integrator == Integrator::euler || !(island.limited > 1)) return;
  concerns.push_back({true,
                      fmt::format("the force of an effect with limits is {:.2g} times too stiff for the step: {} "
                                  "swings between the limits",
                                  island.limited, name_of(integrators, settings.integrator)),
                      "integrator = \"euler\", which is implicit up to the limits, or " + own_steps_if_stiff});
}

void on_stiffness(const Diagnosis::Island& island, const Settings& settings, double h, const Names& names,
                  std::vector<Concern>& concerns) {
  if (settings.local_error > 0 || takes_midpoint(settings) || !(island.stiffest.square > 0)) return;
  const double omega = std::sqrt(island.stiffest.square), radians = h * omega;
  const double stable = row_of(settings.integrator).stable_radians;  // half of this is already inaccurate
  if (!(radians > stable / 2)) return;
  const bool tension = island.stiffest.tension > 0.5 * island.stiffest.square;
  std::string fix = fmt::format("substeps = {:.0f} or more", std::ceil(radians / 0.5) * settings.substeps);
  const bool stiffens = row_of(settings.integrator).stiffens;
  if (tension && !stiffens) fix += ", " + tension_taken;
  // Stiffening between bodies needs rows of the direct solver.
  if (tension && stiffens && sweeps(settings.solver)) fix += ", solver = \"direct\"";
  fix += ", or " + own_steps;
  concerns.push_back(
      {true,
       fmt::format("{} makes {} oscillate at {:.3g} rad/s, {:.2g} rad per substep: {} {}",
                   tension ? "the tension of the joints" : "a spring", names.body(island.stiffest.body), omega, radians,
                   name_of(integrators, settings.integrator),
                   radians > stable ? fmt::format("is unstable above {:.2g}", stable) : "is inaccurate there"),
       fix});
}

// Runge-Kutta steps that are fixed. Other methods take dampers implicitly.
void on_decay(const Diagnosis::Island& island, const Settings& settings, double h, const Names& names,
              std::vector<Concern>& concerns) {
  const IntegratorRow& row = row_of(settings.integrator);
  const double decay = h * island.fastest_decay.rate;
  if (settings.local_error > 0 || !(decay > row.stable_decay / 2)) return;
  concerns.push_back({true,
                      fmt::format("a damper slows {} at {:.3g} 1/s, {:.2g} per substep: {} {}",
                                  names.body(island.fastest_decay.body), island.fastest_decay.rate, decay, row.name,
                                  decay > row.stable_decay ? fmt::format("is unstable above {:.2g}", row.stable_decay)
                                                           : "is inaccurate there"),
                      turns_kept + ", which takes dampers implicitly"});
}

void on_spin(const Diagnosis::Island& island, const Settings& settings, double h, const Names& names,
             std::vector<Concern>& concerns) {
  const double radians = h * island.fastest_spin, followed = followed_turn(row_of(settings.integrator));
  if (settings.local_error > 0 || !(radians > followed)) return;
  concerns.push_back(
      {true,
       fmt::format("{} rotates by {:.2g} rad per substep: {} is accurate below about {} rad",
                   names.body(island.spinning), radians, name_of(integrators, settings.integrator), followed),
       fmt::format("substeps = {:.0f} or more, or {}", std::ceil(radians / followed) * settings.substeps, own_steps)});
}

// The linearly implicit step adds tension as inertia. Where h omega is small anyway, this only slows down rotations.
void on_damping(const Diagnosis::Island& island, const Settings& settings, double h, const Names& names,
                std::vector<Concern>& concerns) {
  if (!row_of(settings.integrator).stiffens || takes_midpoint(settings)) return;
  const double radians = h * std::sqrt(std::max(0.0, island.stiffest.square)), turn = h * island.fastest_spin;
  if (radians > needs_no_help || turn < slow_turn) return;
  concerns.push_back(
      {true,
       fmt::format("{} damps rotations, and {} rotates by {:.2g} rad per substep; the stiffest motion, "
                   "{:.2g} rad per substep, does not need that",
                   name_of(integrators, settings.integrator), names.body(island.spinning), turn, radians),
       turns_kept});
}

void on_condition(const Diagnosis::Island& island, const Settings& settings, bool single, const Names& names,
                  std::vector<Concern>& concerns) {
  if (sweeps(settings.solver) && island.condition > sweeps_per_condition * settings.iterations)
    concerns.push_back(
        {true,
         fmt::format("the condition of K is {:.2g}, with masses from {:.3g} to {:.3g} kg: {} iterations leave "
                     "a large error",
                     island.condition, island.lightest, island.heaviest, settings.iterations),
         "solver = \"direct\""});
  if (single && island.condition * float_round_off > inexact)
    concerns.push_back(
        {true,
         fmt::format("the condition of K is {:.2g}, near {}: in float its forces have a relative error of about {:.0e}",
                     island.condition, names.joint(island.weakest.joint), island.condition * float_round_off),
         "precision = \"double\""});
}

}  // namespace

std::vector<Concern> concerns_about(const Diagnosis::Island& island, const Settings& settings, bool single, double h,
                                    const Names& names) {
  std::vector<Concern> concerns;
  on_rows(island, names, concerns);
  const size_t of_rows = concerns.size();
  on_limited_forces(island, settings, concerns);
  on_stiffness(island, settings, h, names, concerns);
  on_decay(island, settings, h, names, concerns);
  on_spin(island, settings, h, names, concerns);
  on_damping(island, settings, h, names, concerns);
  on_condition(island, settings, single, names, concerns);
  for (size_t k = of_rows; k < concerns.size(); ++k) concerns[k].of_method = true;
  return concerns;
}

}  // namespace cdot
