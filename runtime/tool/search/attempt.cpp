#include "runtime/tool/search/attempt.hpp"

#include <algorithm>
#include <cmath>

namespace cdot {
namespace {

constexpr double round_off = 1e-15;  // of what is compared
constexpr double far = 1;            // a size or a radian: larger distances say nothing about errors

// Of the distance: an energy that is off by less says nothing about the motion. A motor keeps a wheel's energy whatever
// its angle is.
constexpr double witness = 1e-5;

// Errors grow at least with time. From this share of the run on, the distance of two runs is taken to grow by the power
// of time with which it grew over the second half up to then. The run that comes next expects a little more.
constexpr double tells = 0.25, most_growth = 2, further_growth = 0.5;

std::size_t stride_of(const Attempt& coarse, const Attempt& fine) {
  return static_cast<std::size_t>(fine.knob.intervals / coarse.knob.intervals);
}

}  // namespace

Distance distance(const Yardstick& yardstick, const Attempt& coarse, const Attempt& fine, std::size_t ends) {
  const std::size_t stride = stride_of(coarse, fine);
  Distance distance{round_off, 0};
  for (std::size_t k = 0; k <= ends && k < coarse.frames.size() && k * stride < fine.frames.size(); ++k) {
    const Frame& frame = fine.frames[k * stride];
    distance.largest = std::max(distance.largest, yardstick.apart(coarse.frames[k], frame));
    if (distance.largest <= yardstick.asked()) distance.agree_until = frame.time;
  }
  return distance;
}

double sure_gain(const Attempt& coarse, const Attempt& fine, double apart) {
  if (fine.knob.adaptive() && apart > far) return 1;
  const bool rescued = coarse.result.counts.rescued > 0 || fine.result.counts.rescued > 0;
  const bool tells_of_energy = coarse.energy_share >= witness * apart;
  const double of_energy = tells_of_energy ? coarse.energy_share / std::max(round_off, fine.energy_share) : 1;
  return sure_gain(fine.knob.row(), gain(coarse.knob, fine.knob, rescued), of_energy);
}

double foreseen_distance(const Yardstick& yardstick, double duration, const Attempt& coarse, const Attempt& fine) {
  const std::size_t stride = stride_of(coarse, fine), ends = (fine.frames.size() - 1) / stride;
  const double share = fine.frames.back().time / duration;
  if (share < tells || ends * stride != fine.frames.size() - 1) return 0;
  const double now = distance(yardstick, coarse, fine, ends).largest;
  const double growth = std::log2(now / distance(yardstick, coarse, fine, ends / 2).largest);
  const auto at_end = [&](double power) { return now / std::pow(share, std::clamp(power, 1.0, most_growth)); };
  const double foreseen = at_end(growth), allowed = yardstick.asked() * sure_gain(coarse, fine, foreseen);
  return foreseen > allowed ? at_end(growth + further_growth) : 0;
}

}  // namespace cdot
