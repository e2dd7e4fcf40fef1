// The evaluations of a search and of its last run, by scenes: what `price` measures in CPU time, but the same on every
// machine and beside any load.
#include <cmath>
#include <cstdio>
#include <fmt/format.h>

#include <cdot/methods.hpp>

#include "tests/bench/search/runs.hpp"

namespace cdot::search_bench {
namespace {

constexpr int samples = 64;
constexpr double most_evaluations = 3e5;

}  // namespace

void study_work(const std::vector<Scene>& scenes) {
  double logarithms = 0;
  int count = 0;
  for (const Scene& named : scenes) {
    const Scene scene = without_method(named);
    std::string warnings;
    const Run run = search_of(scene, equal_times(scene.duration, samples), most_evaluations, warnings);
    const Choice& choice = run.result.choice.value();
    const long long all = choice.evaluations + choice.evaluations_before;
    fmt::print("{:44} {:8} {:8} {:8} {:2} {:.1e} {}\n", short_name(scene), name_of(integrators, choice.integrator), all,
               choice.evaluations, choice.runs_before + 1, choice.achieved, choice.reached ? "" : "not reached");
    std::fflush(stdout);
    if (!run.whole) continue;
    logarithms += std::log(static_cast<double>(all)), ++count;
  }
  fmt::print("{} searches end, of {:.1f} evaluations in the geometric mean\n", count, std::exp(logarithms / count));
}

}  // namespace cdot::search_bench
