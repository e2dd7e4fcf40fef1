#include "runtime/tool/search/knobs.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace cdot {
namespace {

// The first run is loose: its price is small, and its distance from the second tells how strict the third has to be, if
// one is needed. Measured over all scenes: no other pair of numbers was cheaper by a tenth.
constexpr double first_local_error = 10;  // in units of the accuracy, and
constexpr double loosest_strict = 1e-11;  // at least, so that two more are possible
constexpr double stricter = 1e-3;         // the next local error, as a share; at most a tenth. Of order 8
constexpr int sparse = 4;                 // intervals of a look
// Intervals bound the steps: those of a method that took over, and those that no estimate bounds.
constexpr int most_parts = 256;
constexpr int most_fixed_parts = 1 << 14;

}  // namespace

Try first_try(Integrator integrator, double accuracy, bool sparsely) {
  const bool adaptive = row_of(integrator).level == Level::acceleration;
  return {integrator, adaptive ? std::max(loosest_strict, first_local_error * accuracy) : 0, 1,
          intervals_of_own_steps / (sparsely ? sparse : 1)};
}

double stricter_for(const IntegratorRow& row) { return std::pow(stricter, row.order / 8.0); }

std::string name_of(const Try& knob) {
  const auto name = name_of(integrators, knob.integrator);
  return knob.adaptive() ? fmt::format("{}, local error {:.0e}", name, knob.local_error)
                         : fmt::format("{}, {} steps", name, knob.steps());
}

// The square root of what it should be. A tenth of a local error now and then gains less than that.
double sure_gain(double gain, bool adaptive) { return std::pow(gain, adaptive && gain < 11 ? 0.25 : 0.5); }
double gain_for(double sure) { return sure * sure; }

double gain(const Try& coarse, const Try& fine, bool rescued) {
  const double shorter = static_cast<double>(fine.steps()) / coarse.steps();
  if (!fine.adaptive()) return std::pow(shorter, fine.row().order);
  const double smaller = (coarse.local_error + strictest_local_error) / (fine.local_error + strictest_local_error);
  return rescued ? std::min(smaller, shorter) : smaller;  // a method that took over may have order 1
}

std::optional<Try> finer(Try knob, double share, int shorter) {
  if (knob.adaptive()) {
    if (knob.strictest() && shorter == 1) return {};
    // The strictest run is compared with one of at least ten times its local error: there the gain is small, but sure.
    const bool last = knob.local_error < 99 * strictest_local_error;
    knob.local_error = std::max((last ? 1 : 10) * strictest_local_error, std::min(share, 0.1) * knob.local_error);
    knob.parts *= shorter;
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
