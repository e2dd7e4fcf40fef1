// The knobs of a search: a method with its local error or its fixed steps, and the next finer ones.
#pragma once

#include <optional>
#include <string>

#include <cdot/methods.hpp>

#include "runtime/tool/scene/scene.hpp"

namespace cdot {

inline constexpr double strictest_local_error = 1e-14;  // below it there is only round-off, of steps

struct Try {
  Integrator integrator;
  double local_error = 0;  // 0: fixed steps
  int parts = 1;           // of an interval: its steps; or at their ends, a method that took over has to stop
  int intervals = intervals_of_own_steps;
  int least_steps = 1;  // of own length, at the ends of intervals or not: none takes a larger share of the run
  int steps() const { return parts * intervals; }
  const IntegratorRow& row() const { return row_of(integrator); }
  bool adaptive() const { return local_error > 0; }
  bool strictest() const { return adaptive() && local_error < 1.01 * strictest_local_error; }
};

std::string name_of(const Try& knob);

// The first knob of a method. It only measures the second, so it may be looked at `sparsely`: at every fourth end of an
// interval, since a look costs a state between steps.
Try first_try(Integrator integrator, double accuracy, bool sparsely);
// One that chooses its steps, too.
bool is_eighth_order(const IntegratorRow& row);
// The share of the last local error that a further run takes: of order 8 a thousandth, of others at the same ratio of
// prices.
double stricter_for(const IntegratorRow& row);
// The same for a run that only has to measure the one before.
inline constexpr double share_to_measure = 0.04;
// The same for the second run.
double second_share(const Try& first, double accuracy);

// The factor by which the error should be smaller than that of a coarser knob; `rescued`: where another method took
// over. `noise`: local errors that remain.
double gain(const Try& coarse, const Try& fine, bool rescued, double noise);
// The factor by which it is surely smaller, measured over all scenes, if the error of the energy is `of_energy` times
// smaller.
double sure_gain(const IntegratorRow& row, double gain, double of_energy);
// The gain that is surely so large.
double gain_for(const IntegratorRow& row, double sure);

// Factors for the next run.
struct Shorter {
  int intervals = 1, steps = 1;
  bool none() const { return intervals == 1 && steps == 1; }
};
// The next knob, with an error of at most this share and shorter intervals or steps; nothing if it is too fine.
std::optional<Try> finer(Try knob, double share, const Shorter& shorter);

}  // namespace cdot
