#include "runtime/accuracy_refine.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/accuracy_compose.hpp"
#include "runtime/methods.hpp"
#include "runtime/run_process.hpp"

namespace cdot {
namespace {

constexpr double settled = 3e-13;  // [m, rad]: a change that is round-off
constexpr double small = 1e-6;     // a change from which on
constexpr int patience = 3;        // so many finer knobs without a smaller one mean that round-off is reached

// Where two knobs, one after the other, differ least, the finer one is the best: before, the method's error, and behind
// it round-off is larger. `run` makes the trajectory of one knob.
template <class F>
Refined refine(std::string name, const Scene& scene, const Way& way, std::size_t samples, const Effort& effort,
               const Stop& stop, F run) {
  Refined refined{std::move(name), {}, {}, {}, false, 0};
  Trajectory before;
  const double start = cpu_now();
  const Stop enough = [&] { return (stop && stop()) || cpu_now() - start > effort.cpu; };
  long long last = 0;
  int idle = 0;
  for (int level = 0; has_level(way, level) && !refined.at_its_floor && !enough(); ++level) {
    if (refined.evaluations + 2 * last > effort.evaluations) break;  // no knob costs more than twice the one before
    Trajectory now = run(knob_at(way, level), enough);
    last = now.counts.evaluations;
    refined.evaluations += last;
    if (now.stopped) break;
    const bool whole = now.finite && now.frames.size() == samples;
    if (whole && before.frames.size() == samples) {
      std::vector<double> changes = distances(now.frames, before.frames, scene.dimension);
      const double change = largest(changes), best = refined.change();
      idle = change < best || best > small ? 0 : idle + 1;
      if (change < best) refined.best = now, refined.knob = knob_at(way, level), refined.changes = std::move(changes);
      refined.at_its_floor = idle == patience || change <= settled;
    }
    before = whole ? std::move(now) : Trajectory{};
  }
  return refined;
}

Refined refined_runge_kutta(const Scene& scene, const Way& way, const std::vector<double>& times, const Effort& effort,
                            const Stop& stop) {
  return refine(std::string(name_of(integrators, way.integrator)), scene, way, times.size(), effort, stop,
                [&](const Knob& knob, const Stop& enough) { return trajectory_of(scene, way, knob, times, enough); });
}

}  // namespace

double Refined::change() const {
  return found() ? largest(changes) : std::numeric_limits<double>::infinity();
}

Way way_of_dop853() { return {Integrator::dop853}; }

Refined refined_dop853(const Scene& scene, const std::vector<double>& times, const Effort& effort, const Stop& stop) {
  return refined_runge_kutta(scene, way_of_dop853(), times, effort, stop);
}
Refined refined_rk4(const Scene& scene, const std::vector<double>& times, const Effort& effort, const Stop& stop) {
  return refined_runge_kutta(scene, {Integrator::rk4}, times, effort, stop);
}
Refined refined_rattle(const Scene& scene, const std::vector<double>& times, const Effort& effort, const Stop& stop) {
  return refine("composed rattle", scene, {Integrator::rattle}, times.size(), effort, stop,
                [&](const Knob& knob, const Stop& enough) { return composed_rattle(scene, knob.steps, times, enough); });
}

std::vector<double> distances(const std::vector<Frame>& a, const std::vector<Frame>& b, Dimension dimension) {
  std::vector<double> result;
  for (std::size_t k = 0; k < a.size(); ++k) result.push_back(apart(a[k], b[k], dimension).larger());
  return result;
}

double largest(const std::vector<double>& values) {
  return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
}

}  // namespace cdot
