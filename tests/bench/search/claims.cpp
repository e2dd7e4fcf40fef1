// The error that a run claims against its distance from a far more accurate one, at every accuracy; and the price of
// the accuracies.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <map>

#include "runtime/tool/search/yardstick.hpp"
#include "tests/bench/search/runs.hpp"

namespace cdot::search_bench {
namespace {

constexpr double strict = 1e-13, nearly_strict = 1e-12;  // local errors of the reference and of its check
constexpr double most_cpu = 60;                          // [s] of a reference

// Equal ones, and some in no order that fall between the steps.
std::vector<std::vector<double>> output_times(double duration) {
  std::vector<double> odd;
  for (int k = 1; k <= 37; ++k) odd.push_back(duration * std::fmod(0.6180339887498949 * k, 1.0));
  std::sort(odd.begin(), odd.end());
  return {equal_times(duration, 100), odd};
}

struct Level {
  std::vector<double> prices, errors;  // in units of the price at 1e-4; [m, rad]
};

}  // namespace

void study_claims(const std::vector<Scene>& scenes) {
  int runs = 0, failed = 0, above = 0;
  double worst = 0;
  std::map<int, Level> levels;
  for (const Scene& named : scenes) {
    const Scene scene = without_method(named);
    for (const std::vector<double>& times : output_times(scene.duration)) {
      const Run truth = reference_of(scene, strict, times, most_cpu),
                check = reference_of(scene, nearly_strict, times, most_cpu);
      if (!truth.whole || !check.whole) {
        fmt::print("{}: no reference\n", short_name(scene));
        continue;
      }
      std::map<int, double> prices;
      for (int digits = 2; digits <= 9; ++digits) {
        Scene asked = scene;
        asked.accuracy = std::pow(10.0, -digits);
        const Yardstick yardstick(asked);
        const Run run = run_of(asked, times, most_cpu);
        ++runs;
        if (!run.whole) {
          ++failed;
          fmt::print("{} at 1e-{}: {}\n", short_name(scene), digits, failure(asked, run.result));
          continue;
        }
        const Choice& choice = *run.result.choice;
        const double off = largest_apart(yardstick, run.rows, truth.rows);
        const double unsure = largest_apart(yardstick, check.rows, truth.rows) + strict;
        const double share = std::max(0.0, off - unsure) / choice.achieved;
        if (share > 1)
          fmt::print("{} at 1e-{}: claims {:.1e}, is off by {:.1e}\n", short_name(scene), digits, choice.achieved, off);
        above += share > 1, worst = std::max(worst, share);
        prices[digits] = static_cast<double>(choice.evaluations + choice.evaluations_before);
        levels[digits].errors.push_back(off);
      }
      for (const auto& [digits, price] : prices)
        if (prices.contains(4)) levels[digits].prices.push_back(price / prices[4]);
      std::fflush(stdout);
    }
  }
  fmt::print("{} runs, {} failed, {} above their claim, the largest at {:.2f} of it\n\n", runs, failed, above, worst);
  fmt::print("| accuracy [m, rad] | price, median | price, largest | off by, median | off by, largest |\n");
  fmt::print("|---|---|---|---|---|\n");
  for (const auto& [digits, level] : levels)
    fmt::print("| 1e-{} | {:.2f} | {:.2f} | {:.1e} | {:.1e} |\n", digits, median(level.prices),
               *std::max_element(level.prices.begin(), level.prices.end()), median(level.errors),
               *std::max_element(level.errors.begin(), level.errors.end()));
}

}  // namespace cdot::search_bench
