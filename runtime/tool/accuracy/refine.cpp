#include "runtime/tool/accuracy/refine.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/methods.hpp>

#include "runtime/tool/accuracy/compose.hpp"
#include "runtime/tool/run/process.hpp"

namespace cdot {
namespace {

constexpr double settled = 3e-13;  // [m, rad]: a change that is round-off of doubles
constexpr double small = 1e-6;     // a change from which on
constexpr int patience = 3;        // so many finer knobs without a smaller one mean that round-off is reached

// The trajectory of one knob.
Trajectory made(const Scene& scene, const Way& way, const Knob& knob, const std::vector<double>& times,
                const Stop& stop) {
  if (row_of(way.integrator).symmetric) return composed(way.integrator, scene, knob.steps, times, stop, way.extended);
  return trajectory_of(scene, way, knob, times, stop);
}

std::string name_of_method(Integrator integrator) {
  const std::string name(name_of(integrators, integrator));
  return row_of(integrator).symmetric ? "composed " + name : name;
}

}  // namespace

// Where two knobs, one after the other, differ least, the finer one is the best: before, the method's error, and behind
// it round-off is larger.
Refined refined(Integrator integrator, bool extended, const Scene& scene, const std::vector<double>& times,
                const Effort& effort, const Stop& stop) {
  const Way way{.integrator = integrator, .extended = extended};
  Refined refined{name_of_method(integrator), way, {}, {}, {}, false, 0};
  Trajectory before;
  const double start = cpu_now();
  const Stop enough = [&] { return (stop && stop()) || cpu_now() - start > effort.cpu; };
  long long last = 0;
  int idle = 0;
  for (int level = 0; has_level(way, level) && !refined.at_its_floor && !enough(); ++level) {
    if (refined.evaluations + 2 * last > effort.evaluations) break;  // no knob costs more than twice the one before
    Trajectory now = made(scene, way, knob_at(way, level), times, enough);
    last = now.counts.evaluations;
    refined.evaluations += last;
    if (now.stopped) break;
    const bool whole = now.finite && now.frames.size() == times.size();
    if (whole && before.frames.size() == times.size()) {
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

double Refined::change() const { return found() ? largest(changes) : std::numeric_limits<double>::infinity(); }

std::vector<double> distances(const std::vector<Frame>& a, const std::vector<Frame>& b, Dimension dimension) {
  std::vector<double> result;
  for (std::size_t k = 0; k < a.size(); ++k) result.push_back(apart(a[k], b[k], dimension).larger());
  return result;
}

double largest(const std::vector<double>& values) {
  return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
}

}  // namespace cdot
