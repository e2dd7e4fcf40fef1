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

// Equal ones, and some in no order that fall between the steps. No step depends on them.
std::vector<double> output_times(double duration) {
  std::vector<double> times = equal_times(duration, 100);
  for (int k = 1; k <= 37; ++k) times.push_back(duration * std::fmod(0.6180339887498949 * k, 1.0));
  std::sort(times.begin(), times.end());
  return times;
}

struct Level {
  std::vector<double> prices, errors;  // in units of the price at 1e-4; [m, rad]
};

struct Totals {
  int runs = 0, failed = 0, above = 0;
  double worst = 0;  // error, in claims
  std::map<int, Level> levels;
};

// The price of the run and of its search; 0 if it fails.
double study(const Scene& scene, int digits, const std::vector<double>& times, const Run& truth, const Run& check,
             Totals& totals) {
  Scene asked = scene;
  asked.accuracy = std::pow(10.0, -digits);
  const Yardstick yardstick(asked);
  const Run run = run_of(asked, times, most_cpu);
  ++totals.runs;
  if (!run.whole) {
    ++totals.failed;
    fmt::print("{} at 1e-{}: {}\n", short_name(scene), digits, failure(asked, run.result));
    return 0;
  }
  const Choice& choice = *run.result.choice;
  const double off = largest_apart(yardstick, run.rows, truth.rows);
  const double unsure = largest_apart(yardstick, check.rows, truth.rows) + strict;
  const double share = std::max(0.0, off - unsure) / choice.achieved;
  if (share > 1)
    fmt::print("{} at 1e-{}: claims {:.1e}, is off by {:.1e}\n", short_name(scene), digits, choice.achieved, off);
  totals.above += share > 1, totals.worst = std::max(totals.worst, share);
  totals.levels[digits].errors.push_back(off);
  return static_cast<double>(choice.evaluations + choice.evaluations_before);
}

void study(const Scene& scene, const std::vector<int>& accuracies, Totals& totals) {
  const std::vector<double> times = output_times(scene.duration);
  const Run truth = reference_of(scene, strict, times, most_cpu),
            check = reference_of(scene, nearly_strict, times, most_cpu);
  if (!truth.whole || !check.whole) {
    fmt::print("{}: no reference\n", short_name(scene));
    return;
  }
  std::map<int, double> prices;
  for (const int digits : accuracies) {
    const double price = study(scene, digits, times, truth, check, totals);
    if (price > 0) prices[digits] = price;
    std::fflush(stdout);
  }
  for (const auto& [digits, price] : prices)
    if (prices.contains(4)) totals.levels[digits].prices.push_back(price / prices[4]);
}

}  // namespace

void study_claims(const std::vector<Scene>& scenes, const std::vector<int>& accuracies) {
  Totals totals;
  for (const Scene& scene : scenes) study(without_method(scene), accuracies, totals);
  fmt::print("{} runs, {} failed, {} above their claim, the largest at {:.2f} of it\n\n", totals.runs, totals.failed,
             totals.above, totals.worst);
  fmt::print("| accuracy [m, rad] | price, median | price, largest | off by, median | off by, largest |\n");
  fmt::print("|---|---|---|---|---|\n");
  for (const auto& [digits, level] : totals.levels) {
    if (level.prices.empty()) continue;  // without a run at 1e-4
    fmt::print("| 1e-{} | {:.2f} | {:.2f} | {:.1e} | {:.1e} |\n", digits, median(level.prices),
               *std::max_element(level.prices.begin(), level.prices.end()), median(level.errors),
               *std::max_element(level.errors.begin(), level.errors.end()));
  }
}

}  // namespace cdot::search_bench
