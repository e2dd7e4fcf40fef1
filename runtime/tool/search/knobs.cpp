#include "runtime/tool/search/knobs.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace cdot {
namespace {

// The first run is loose: its price is small, and its distance from the second tells how strict the third has to be, if
// one is needed. Local errors of the first two in units of the accuracy, measured over all scenes:
constexpr double first_local_error = 20, looser_of_eighth_order = 10, second_of_eighth_order = 0.02;
constexpr double strict_accuracy = 1e-6;                 // below it, there is no room for a looser one
constexpr double loosest = 0.1, loosest_strict = 1e-11;  // of the first; two more have to be possible
constexpr double stricter = 1e-3;  // the next local error, as a share; at most a tenth. Of order 8
constexpr int sparse = 4;          // intervals of a look

// The energy's error is a second witness of gains from `large_gain` on. It may show less than the local errors promise:
// a run that needs a sure gain aims at `lacking` times as much.
constexpr double large_gain = 300, power_of_large = 0.75, lacking = 2;

// Intervals bound the steps: those of a method that took over, and those that no estimate bounds.
constexpr int most_parts = 256;
constexpr int most_fixed_parts = 1 << 14;

}  // namespace

Try first_try(Integrator integrator, double accuracy, bool sparsely) {
  const IntegratorRow& row = row_of(integrator);
  double local_error = 0;
  if (row.level == Level::acceleration) {
    local_error = first_local_error * accuracy;
    if (is_eighth_order(row) && accuracy >= strict_accuracy)
      local_error = std::max(local_error, std::min(loosest, looser_of_eighth_order * local_error));
    local_error = std::max(local_error, loosest_strict);
  }
  return {integrator, local_error, 1, intervals_of_own_steps / (sparsely ? sparse : 1)};
}

bool is_eighth_order(const IntegratorRow& row) { return row.level == Level::acceleration && row.order == 8; }

double stricter_for(const IntegratorRow& row) { return std::pow(stricter, row.order / 8.0); }

std::string name_of(const Try& knob) {
  const auto name = name_of(integrators, knob.integrator);
  return knob.adaptive() ? fmt::format("{}, local error {:.0e}", name, knob.local_error)
                         : fmt::format("{}, {} steps", name, knob.steps());
}

double second_share(const Try& first, double accuracy) {
  return is_eighth_order(first.row()) ? second_of_eighth_order * accuracy / first.local_error
                                      : stricter_for(first.row());
}

// sqrt(g) of the gain g that it should be; a tenth of a local error now and then gains less than that. By order 8
// min(g, e)^(3/4), if that is more, where the error of the energy falls by e.
double sure_gain(const IntegratorRow& row, double gain, double of_energy) {
  const double sure = std::pow(gain, row.level == Level::acceleration && gain < 11 ? 0.25 : 0.5);
  if (!is_eighth_order(row) || gain < large_gain) return sure;
  return std::max(sure, std::pow(std::min(gain, of_energy), power_of_large));
}

double gain_for(const IntegratorRow& row, double sure) {
  const double large = std::pow(lacking * sure, 1 / power_of_large);
  return is_eighth_order(row) && sure * sure > large_gain ? std::max(large_gain, large) : sure * sure;
}

double gain(const Try& coarse, const Try& fine, bool rescued, double noise) {
  const double shorter = static_cast<double>(fine.steps()) / coarse.steps();
  if (!fine.adaptive()) return std::pow(shorter, fine.row().order);
  const double smaller = (coarse.local_error + noise) / (fine.local_error + noise);
  return rescued ? std::min(smaller, shorter) : smaller;  // a method that took over may have order 1
}

std::optional<Try> finer(Try knob, double share, const Shorter& shorter) {
  if (knob.adaptive()) {
    if (knob.strictest() && shorter.none()) return {};
    // The strictest run is compared with one of at least ten times its local error: there the gain is small, but sure.
    const bool last = knob.local_error < 99 * strictest_local_error;
    knob.local_error = std::max((last ? 1 : 10) * strictest_local_error, std::min(share, 0.1) * knob.local_error);
    knob.parts *= shorter.intervals, knob.least_steps *= shorter.steps;
    knob.intervals = intervals_of_own_steps;
    if (knob.parts > most_parts) return {};
    return knob;
  }
  const double factor = std::pow(1 / share, 1.0 / knob.row().order);
  int times = 2;
  while (times < factor && times < 8) times *= 2;
  knob.parts = std::max(1, knob.steps() * times / intervals_of_own_steps);
  knob.intervals = intervals_of_own_steps;
  if (knob.parts > most_fixed_parts) return {};
  return knob;
}

}  // namespace cdot
