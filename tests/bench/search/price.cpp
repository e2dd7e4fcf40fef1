// The price of a scene that names no method, against the cheapest method that a person could have named: the one of
// five, at its best local error or step, that has the default accuracy at the least CPU time.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>

#include <cdot/methods.hpp>

#include "runtime/tool/search/yardstick.hpp"
#include "tests/bench/search/runs.hpp"

namespace cdot::search_bench {
namespace {

constexpr int samples = 64, repeats = 3;
constexpr double most_cpu = 20;  // [s] of a run

double cpu_of(const Run& run) { return run.result.cpu + (run.result.choice ? run.result.choice->cpu_before : 0); }

class Comparison {
 public:
  explicit Comparison(const Scene& scene) : scene_(scene), times_(equal_times(scene.duration, samples)) {}

  // The run by default, the least of its prices, and a line about it.
  void run();
  double ratio = 0, ratio_of_run = 0;  // 0: the default or the comparison is not reached
  bool reached = false;

 private:
  struct Named {
    std::string name;
    double cpu;
  };
  std::optional<double> cpu_if_exact(Integrator integrator, double local_error, double step);
  void try_local_errors(Integrator integrator);
  void try_steps(Integrator integrator);
  void keep(const std::string& name, double cpu) {
    if (!cheapest_ || cpu < cheapest_->cpu) cheapest_ = Named{name, cpu};
  }
  bool beaten(double cpu) const { return cheapest_ && cpu > 2 * cheapest_->cpu; }

  const Scene& scene_;
  std::vector<double> times_;
  std::vector<Frame> truth_;
  std::optional<Yardstick> yardstick_;
  std::optional<Named> cheapest_;
  double last_cpu_ = 0;
};

// The CPU time of a run that ends well within the accuracy: the least of some.
std::optional<double> Comparison::cpu_if_exact(Integrator integrator, double local_error, double step) {
  const Run run = run_of(scene_, integrator, local_error, step, times_, most_cpu);
  last_cpu_ = run.result.cpu;
  if (!run.whole) return {};
  if (!(largest_apart(*yardstick_, run.rows, truth_) <= yardstick_->asked())) return {};
  double cpu = run.result.cpu;
  for (int k = 1; k < repeats && cpu < 0.1; ++k)
    cpu = std::min(cpu, run_of(scene_, integrator, local_error, step, times_, most_cpu).result.cpu);
  return cpu;
}

void Comparison::try_local_errors(Integrator integrator) {
  for (int digits = 0; digits < 10; ++digits) {
    const double local_error = std::pow(10.0, -digits);
    if (const auto cpu = cpu_if_exact(integrator, local_error, scene_.duration / intervals_of_own_steps)) {
      keep(fmt::format("{} {:.0e}", name_of(integrators, integrator), local_error), *cpu);
      return;
    }
    if (beaten(last_cpu_)) return;
  }
}

void Comparison::try_steps(Integrator integrator) {
  for (int halvings = 0; halvings < 14; ++halvings) {
    const double step = std::ldexp(scene_.duration / intervals_of_own_steps, -halvings);
    if (const auto cpu = cpu_if_exact(integrator, 0, step)) {
      keep(fmt::format("{} {:.2g} s", name_of(integrators, integrator), step), *cpu);
      return;
    }
    if (beaten(last_cpu_) || last_cpu_ > 3) return;
  }
}

void Comparison::run() {
  Run chosen = run_of(scene_, times_, most_cpu);
  const Choice choice = chosen.result.choice.value();
  reached = chosen.whole && choice.reached;
  if (!reached) {
    const std::string why = failure(scene_, chosen.result);
    fmt::print("{:44} not reached: {}\n", short_name(scene_), why.empty() ? accuracy_warning(choice) : why);
    return;
  }
  yardstick_.emplace(scene_);
  yardstick_->see(chosen.rows);
  double with_search = cpu_of(chosen), alone = chosen.result.cpu;
  for (int k = 1; k < repeats && with_search < 0.1; ++k) {
    const Run again = run_of(scene_, times_, most_cpu);
    with_search = std::min(with_search, cpu_of(again)), alone = std::min(alone, again.result.cpu);
  }
  truth_ = truth_of(scene_, times_, most_cpu);
  if (!truth_.empty()) {
    for (const Integrator integrator : {Integrator::dop853, Integrator::rk4, Integrator::radau5})
      try_local_errors(integrator);
    for (const Integrator integrator : {Integrator::rattle, Integrator::implicit}) try_steps(integrator);
  }
  if (!cheapest_) {
    fmt::print("{:44} no named method compares\n", short_name(scene_));
    return;
  }
  ratio = with_search / cheapest_->cpu, ratio_of_run = alone / cheapest_->cpu;
  fmt::print("{:44} {:8} {:5.2f} times {}, without the search {:.2f}\n", short_name(scene_),
             name_of(integrators, choice.integrator), ratio, cheapest_->name, ratio_of_run);
}

}  // namespace

void study_price(const std::vector<Scene>& scenes) {
  std::vector<double> ratios, of_runs;
  int reached = 0;
  for (const Scene& named : scenes) {
    const Scene scene = without_method(named);
    Comparison comparison(scene);
    comparison.run();
    std::fflush(stdout);
    reached += comparison.reached;
    if (comparison.ratio == 0) continue;
    ratios.push_back(comparison.ratio), of_runs.push_back(comparison.ratio_of_run);
  }
  fmt::print(
      "{} of {} scenes reach the default; {} compared: search and run {:.2f} times the cheapest (median), the run "
      "{:.2f} times\n",
      reached, scenes.size(), ratios.size(), median(ratios), median(of_runs));
}

}  // namespace cdot::search_bench
