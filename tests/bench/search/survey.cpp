// The error that a run claims against its distance from two far more accurate runs by methods of different kinds: for
// scenes that nobody has tried by hand.
#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <cdot/methods.hpp>

#include "runtime/tool/run/error_report.hpp"
#include "runtime/tool/search/yardstick.hpp"
#include "tests/bench/search/runs.hpp"

namespace cdot::search_bench {
namespace {

constexpr int samples = 37;
constexpr double most_cpu = 4;  // [s] of a reference
constexpr double most_evaluations = 3e5;
constexpr double asked_too = 1e-6;  // beside the default, of sizes [m], [rad]
constexpr double most_of_claim = 3;
constexpr double round_off = 1e-11, surely = 0.5;  // distances of two references, the second in claims

struct Reference {
  std::string name;
  std::vector<Frame> rows;
};

// Those that end without a step by another method.
std::vector<Reference> references_of(const Scene& scene, const std::vector<double>& times) {
  std::vector<Reference> references;
  const double interval = scene.duration / intervals_of_own_steps;
  for (const auto& [integrator, local_error] :
       {std::pair{Integrator::dop853, 1e-12}, {Integrator::rk4, 1e-11}, {Integrator::radau5, 1e-11}}) {
    Run run = run_of(scene, integrator, local_error, interval, times, most_cpu);
    if (run.whole && run.result.counts.rescued == 0)
      references.push_back({std::string(name_of(integrators, integrator)), std::move(run.rows)});
  }
  return references;
}

struct Counts {
  int unbuilt = 0, runs = 0, told = 0, failed = 0, unknown = 0, compared = 0, above = 0, far_above = 0;
  double worst = 0;
};

// The truth: the two references next to each other. Some are left behind where a motion magnifies all differences.
struct Truth {
  double unsure = std::numeric_limits<double>::infinity();  // their distance
  const Reference *one = nullptr, *other = nullptr;
};

Truth truth_among(const Yardstick& yardstick, const std::vector<Reference>& references) {
  Truth truth;
  for (const Reference& one : references) {
    for (const Reference& other : references) {
      if (&other == &one) break;
      const double apart = largest_apart(yardstick, one.rows, other.rows);
      if (apart < truth.unsure) truth = {apart, &one, &other};
    }
  }
  return truth;
}

void survey(const Scene& scene, const std::vector<double>& times, std::optional<std::vector<Reference>>& references,
            Counts& counts) {
  std::string warnings;
  const Run run = search_of(scene, times, most_evaluations, warnings);
  ++counts.runs;
  if (warnings.empty()) warnings = decision_warning(scene, run.result);
  Yardstick yardstick(scene);
  const std::string name = fmt::format("{} at {:.0e}", short_name(scene), yardstick.asked());
  const bool reached = run.whole && run.result.choice->reached;
  if (!reached || !warnings.empty()) {
    ++(reached ? counts.told : counts.failed);
    const std::string why = reached              ? warnings
                            : run.result.stopped ? "takes too long"
                            : !run.whole         ? failure(scene, run.result)
                                                 : accuracy_warning(*run.result.choice);
    fmt::print("{}: {} {}\n", name, reached ? "told" : "fails", why.substr(0, 120));
    return;
  }
  if (!references) references = references_of(without_method(scene), times);
  yardstick.see(run.rows);
  const Choice& choice = *run.result.choice;
  const Truth truth = truth_among(yardstick, *references);
  const auto share_of = [&](double off) { return std::max(0.0, off - round_off) / choice.achieved; };
  const bool known = truth.unsure < round_off || share_of(truth.unsure) < surely;
  ++(known ? counts.compared : counts.unknown);
  std::string offs;
  for (const Reference& reference : *references)
    offs += fmt::format(" {} {:.1e}", reference.name, largest_apart(yardstick, run.rows, reference.rows));
  const std::string line =
      fmt::format("{} by {} {:.0e}: claims {:.1e}; off{}", name, name_of(integrators, choice.integrator),
                  choice.local_error, choice.achieved, offs);
  if (!known) {
    fmt::print("{}; not known\n", line);
    return;
  }
  const double share = share_of(std::min(largest_apart(yardstick, run.rows, truth.one->rows),
                                         largest_apart(yardstick, run.rows, truth.other->rows)));
  counts.above += share > 1, counts.far_above += share > most_of_claim, counts.worst = std::max(counts.worst, share);
  if (share > 1) fmt::print("{}; above {:.1f} times\n", line, share);
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

}  // namespace

void study_survey(const std::vector<Scene>& scenes) {
  Counts counts;
  for (const Scene& named : scenes) {
    Scene scene = without_method(named);
    const std::vector<double> times = equal_times(scene.duration, samples);
    std::optional<std::vector<Reference>> references;
    for (const double accuracy : {0.0, asked_too}) {
      scene.accuracy = accuracy;
      try {
        survey(scene, times, references, counts);
      } catch (const SceneError& error) {
        ++counts.unbuilt;
        fmt::print("{}: is not built: {}\n", short_name(scene), first_line(error.what()));
        break;
      }
      std::fflush(stdout);
    }
  }
  fmt::print(
      "{} scenes are not built; {} runs: {} fail, {} are told, {} have no sure reference; of {} others {} above their "
      "claim, {} above {} times, the largest at {:.2f}\n",
      counts.unbuilt, counts.runs, counts.failed, counts.told, counts.unknown, counts.compared, counts.above,
      counts.far_above, most_of_claim, counts.worst);
}

}  // namespace cdot::search_bench
