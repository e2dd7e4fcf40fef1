// Scenes without their method, and their runs at given times.
#pragma once

#include <string>
#include <vector>

#include "runtime/tool/search/simulate.hpp"
#include "runtime/tool/search/yardstick.hpp"

namespace cdot::search_bench {

// All scenes below a folder, in the order of their names.
std::vector<Scene> scenes_below(const std::string& folder);
// As if it named no method and no step.
Scene without_method(Scene scene);
// "joint/planar" from the path of a scene.
std::string short_name(const Scene& scene);

struct Run {
  RunResult result;
  std::vector<Frame> rows;  // at the times, as far as the run got
  bool whole = false;       // it ended without a failure
};

// Ends early after `most` seconds of CPU time.
Run run_of(const Scene& scene, const std::vector<double>& times, double most);
// By a search that takes at most so many evaluations; `warnings` as those of simulate().
Run search_of(const Scene& scene, const std::vector<double>& times, double most_evaluations, std::string& warnings);
// By a named method.
Run run_of(const Scene& scene, Integrator integrator, double local_error, double step, const std::vector<double>& times,
           double most);

// The same by dop853. Where a joint jams at the start, a single step of order 1 finds the impulse, in an instant.
Run reference_of(const Scene& scene, double local_error, const std::vector<double>& times, double most);

// The largest at one time, in the units of the yardstick.
double largest_apart(const Yardstick& yardstick, const std::vector<Frame>& a, const std::vector<Frame>& b);

// A run of far higher accuracy than the default; empty if none ends.
std::vector<Frame> truth_of(const Scene& scene, const std::vector<double>& times, double most);

double median(std::vector<double> numbers);

}  // namespace cdot::search_bench
