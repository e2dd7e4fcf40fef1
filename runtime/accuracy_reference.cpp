#include "runtime/accuracy_reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/accuracy_compose.hpp"

namespace cdot {
namespace {

std::string settled_text(const Refined& method) {
  if (!method.found()) return method.name + " finds no end";
  return fmt::format("{} {} {:.1e}", method.name, method.at_its_floor ? "settles to" : "still changes by",
                     method.change());
}

// What `second` says about `first`: the reference that they make together.
ReferenceRun pair_of(const Refined& first, const Refined& second, const std::vector<double>& times,
                     Dimension dimension) {
  ReferenceRun reference;
  reference.times = times;
  reference.made_by = first.name + " and " + second.name;
  reference.settled = settled_text(first) + ", " + settled_text(second);
  reference.frames = first.change() <= second.change() ? first.best.frames : second.best.frames;
  reference.disagree.assign(times.size(), std::numeric_limits<double>::infinity());
  if (!first.found() || !second.found()) return reference;
  reference.disagree = distances(first.best.frames, second.best.frames, dimension);
  for (const Refined* method : {&first, &second})
    for (std::size_t k = 0; method->at_its_floor && k < times.size(); ++k)
      reference.disagree[k] = std::max(reference.disagree[k], method->changes[k]);
  return reference;
}

// Of places, angles, speeds and spins, each relative to the largest in the motion.
Nudge nudge_by(double share, const ReferenceRun& reference, unsigned seed) {
  Nudge nudge{0, 1, 0, 0, seed};
  for (const Frame& frame : reference.frames)
    for (const BodyState& b : frame.bodies) {
      nudge.position = std::max(nudge.position, std::hypot(b.x, b.y, b.z));
      nudge.angle = std::max(nudge.angle, std::abs(b.angle));
      nudge.speed = std::max(nudge.speed, std::hypot(b.vx, b.vy, b.vz));
      nudge.spin = std::max(nudge.spin, std::hypot(b.w, b.wx, std::hypot(b.wy, b.wz)));
    }
  nudge.position *= share, nudge.angle *= share, nudge.speed *= share, nudge.spin *= share;
  return nudge;
}

Sensitivity sensitivity_of(const Scene& scene, const ReferenceRun& reference, const Refined& method,
                           const Stop& stop) {
  constexpr int starts = 3;  // of each kind
  const auto growth = [&](double share) {
    double worst = 0;
    for (unsigned seed = 0; seed < starts; ++seed) {
      const Trajectory beside = trajectory_of(scene, way_of_dop853(), method.knob, reference.times, stop,
                                              nudge_by(share, reference, seed));
      worst = std::max(worst, largest(distances(beside.frames, method.best.frames, scene.dimension)));
    }
    return worst;
  };
  return {growth(1e-9) / 1e-9, growth(1e-15)};
}

// Methods that differ by so much more than round-off in the start makes, at most, are excused by it: they take thousands
// of steps, and round in each.
constexpr double excused = 30;

std::string verdict_on(const ReferenceRun& reference, bool finer_would_help) {
  if (reference.disagreement() <= excused * reference.sensitivity.round_off) return "round-off forbids more";
  if (finer_would_help) return "the methods are not fine enough yet: --budget";
  return "no step mends it: round-off is magnified on the way, as where a mechanism may go on in two ways";
}

}  // namespace

double ReferenceRun::disagreement() const { return largest(disagree); }
double ReferenceRun::resolution() const { return 10 * disagreement(); }

double ReferenceRun::agreed_until(double bound) const {
  double until = 0;
  for (std::size_t k = 0; k < disagree.size() && disagree[k] <= bound; ++k) until = times[k];
  return until;
}

// Runge-Kutta on accelerations against RATTLE on impulses, which share no formula but the kernels'. Where the motion is
// not reversible, or RATTLE gets lost, a Runge-Kutta method of another order is the judge.
ReferenceRun make_reference_run(const Scene& scene, const Effort& effort, const Stop& stop) {
  const std::vector<double> times = equal_times(scene.duration, sample_count);
  const Refined first = refined_dop853(scene, times, effort, stop);
  ReferenceRun best;
  bool finer_would_help = false;
  for (const auto refined : {refined_rattle, refined_rk4}) {
    const bool rattle = refined == refined_rattle;
    if (rattle && !reversible(scene)) continue;
    // RATTLE takes about as many steps as the first has evaluations, or it does not get there.
    const Effort own{rattle ? std::min(effort.evaluations, 5 * first.evaluations) : effort.evaluations, effort.cpu};
    const Refined second = refined(scene, times, own, stop);
    const ReferenceRun reference = pair_of(first, second, times, scene.dimension);
    if (best.frames.empty() || reference.disagreement() < best.disagreement()) {
      best = reference;
      finer_would_help = !first.at_its_floor || !second.at_its_floor;
    }
    if (best.disagreement() <= wanted_agreement) return best;
  }
  if (!first.found()) return best;
  best.sensitivity = sensitivity_of(scene, best, first, stop);
  best.verdict = verdict_on(best, finer_would_help);
  return best;
}

Errors errors_of(const Trajectory& trajectory, const ReferenceRun& reference, Dimension dimension) {
  Errors errors;
  for (std::size_t k = 0; k < trajectory.frames.size(); ++k) {
    const Apart here = apart(trajectory.frames[k], reference.frames[k], dimension);
    errors.position = std::max(errors.position, here.position);
    errors.angle = std::max(errors.angle, here.angle);
    errors.energy = std::max(errors.energy, std::abs(trajectory.frames[k].energy - reference.frames[k].energy));
  }
  errors.C = trajectory.C;
  errors.Cdot = trajectory.Cdot;
  return errors;
}

double size_of(const ReferenceRun& reference) {
  double size = 1;
  for (const Frame& frame : reference.frames)
    for (const BodyState& a : frame.bodies)
      for (const BodyState& b : reference.frames.front().bodies)
        size = std::max(size, std::hypot(a.x - b.x, a.y - b.y, a.z - b.z));
  return size;
}

}  // namespace cdot
