#include "runtime/state/pace.hpp"

#include <algorithm>

namespace cdot {
namespace {

// Measured over all scenes and hard cases (tests/bench/search): c follows the last error by this share, since estimates
// of errors pass through zeros; and the error of a loose, long step tells most about the end of its first third.
constexpr double follows = 0.3, told = 1.0 / 3;
constexpr int rounds = 3;  // for the length of a step, which its own middle needs

}  // namespace

// A step that was cut, or taken again, is not kept.
void Pace::note(double time, double length, double best) {
  const double told_of = time + told * length;
  while (!points_.empty() && points_.back().time >= told_of) points_.pop_back();
  points_.push_back({told_of, best});
}

double Pace::at(double middle) const {
  const auto next = std::lower_bound(points_.begin(), points_.end(), middle,
                                     [](const Point& point, double time) { return point.time < time; });
  if (next == points_.begin()) return next->best;
  const auto last = next - 1;
  if (next == points_.end()) return last->best;
  return last->best + (next->best - last->best) * (middle - last->time) / (next->time - last->time);
}

double Paces::allowed(double time) const {
  double allowed = local_error_;
  for (const Looser& looser : looser_)
    if (looser.from <= time) allowed = looser.local_error;
  return allowed;
}

const Pace* Paces::find(int body) const {
  const auto found = of_.find(body);
  return found == of_.end() ? nullptr : &found->second;
}

PacedStep::PacedStep(const Pace& pace, double safety, double time, double proposed) : PacedStep(pace, safety, time) {
  const double best = proposed / safety;
  proposed_ = proposed, c_ = best / pace.at(time + best / 2);
}

PacedStep PacedStep::first(const Pace& pace, double safety, double time, double c) {
  PacedStep step(pace, safety, time);
  step.c_ = c;
  step.proposed_ = step.next(time, c * pace.at(time));
  return step;
}

void PacedStep::learn(double length, double best) { c_ += follows * (best / pace_.at(time_ + length / 2) - c_); }

double PacedStep::next(double time, double best) const {
  for (int k = 0; k < rounds; ++k) best = c_ * pace_.at(time + best / 2);
  return safety_ * best;
}

}  // namespace cdot
