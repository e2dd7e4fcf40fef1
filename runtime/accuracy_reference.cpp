#include "runtime/accuracy_reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/accuracy_extrapolate.hpp"
#include "runtime/methods.hpp"
#include "runtime/run_process.hpp"

namespace cdot {
namespace {

// One method, at the finest knob that still changed anything for the better.
struct Refined {
  std::string name;
  Trajectory best;
  double change = std::numeric_limits<double>::infinity();  // from the knob before [m, rad]
};

std::vector<double> distances(const std::vector<Frame>& a, const std::vector<Frame>& b, Dimension dimension) {
  std::vector<double> result;
  for (std::size_t k = 0; k < a.size(); ++k) result.push_back(apart(a[k], b[k], dimension).larger());
  return result;
}

double largest(const std::vector<double>& values) {
  return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
}

constexpr double coarsest_tolerance = 1e-7;
constexpr int most_decades = 9;  // from there

// Ever smaller tolerances, until two trajectories differ by round-off, or refining has stopped to help: then round-off
// grows. `run` makes the trajectory of one tolerance.
template <class F>
Refined refine(std::string name, Dimension dimension, std::size_t samples, double cpu_limit, const Stop& stop, F run) {
  Refined refined{std::move(name), {}};
  Trajectory before;
  const double start = cpu_now();
  const Stop enough = [&] { return (stop && stop()) || cpu_now() - start > cpu_limit; };
  for (int decade = 0; decade < most_decades && !enough(); ++decade) {
    Trajectory now = run(coarsest_tolerance * std::pow(0.1, decade), enough);
    const bool whole = now.finite && now.frames.size() == samples;
    if (whole && before.frames.size() == samples) {
      const double change = largest(distances(now.frames, before.frames, dimension));
      const bool worse = change > refined.change && refined.change < 1e-9;
      if (change < refined.change) refined.best = now, refined.change = change;
      if (worse || change < 0.01 * wanted_agreement) break;
    }
    before = whole ? std::move(now) : Trajectory{};
  }
  return refined;
}

Refined by_local_error(const Scene& scene, Integrator integrator, const std::vector<double>& times, double cpu_limit,
                       const Stop& stop) {
  const Way way{integrator, Solver::direct, Drift::projection, 0, false, true};
  return refine(std::string(name_of(integrators, integrator)), scene.dimension, times.size(), cpu_limit, stop,
                [&](double tolerance, const Stop& enough) {
                  return trajectory_of(scene, way, {1, tolerance}, times, enough);
                });
}

Refined by_extrapolation(const Scene& scene, const Extrapolation& method, const std::vector<double>& times,
                         double cpu_limit, const Stop& stop) {
  return refine(fmt::format("extrapolated {}", name_of(integrators, method.way.integrator)), scene.dimension,
                times.size(), cpu_limit, stop, [&](double tolerance, const Stop& enough) {
                  return extrapolated(scene, method, tolerance, times, enough);
                });
}

// What `second` says about `first`: the reference that they make together.
ReferenceRun pair_of(const Refined& first, const Refined& second, const std::vector<double>& times,
                     Dimension dimension) {
  ReferenceRun reference;
  reference.times = times;
  reference.made_by = first.name + " and " + second.name;
  reference.settled = fmt::format("refined by ten, {} changes by {:.1e}, {} by {:.1e}", first.name, first.change,
                                  second.name, second.change);
  reference.frames = first.change <= second.change ? first.best.frames : second.best.frames;
  if (first.best.frames.empty() || second.best.frames.empty())
    reference.disagree.assign(times.size(), std::numeric_limits<double>::infinity());
  else
    reference.disagree = distances(first.best.frames, second.best.frames, dimension);
  return reference;
}

}  // namespace

double ReferenceRun::disagreement() const { return largest(disagree); }
double ReferenceRun::resolution() const { return 10 * disagreement(); }

double ReferenceRun::agreed_until(double bound) const {
  double until = 0;
  for (std::size_t k = 0; k < disagree.size() && disagree[k] <= bound; ++k) until = times[k];
  return until;
}

// Runge-Kutta on accelerations against extrapolated steps on impulses, which share no formula but the kernels': first
// those that are symmetric, then others that get through where these do not.
ReferenceRun make_reference_run(const Scene& scene, double cpu_limit, const Stop& stop) {
  static const Extrapolation routes[] = {
      {{Integrator::rattle}, 2, 6},
      {{Integrator::euler, Solver::direct, Drift::none}, 1, 8},
      {{Integrator::implicit, Solver::direct, Drift::none}, 1, 6},
  };
  const std::vector<double> times = equal_times(scene.duration, sample_count);
  const double share = cpu_limit / (1 + std::size(routes));
  const Refined first = by_local_error(scene, Integrator::dop853, times, share, stop);
  ReferenceRun best;
  for (const Extrapolation& route : routes) {
    const ReferenceRun reference =
        pair_of(first, by_extrapolation(scene, route, times, share, stop), times, scene.dimension);
    if (best.frames.empty() || reference.disagreement() < best.disagreement()) best = reference;
    if (best.disagreement() <= wanted_agreement) break;
  }
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
