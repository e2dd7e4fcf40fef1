// bench_soft [DRIFT [INTEGRATOR]]: whether energy rises without a source in steps by sweeps (soft euler), over all
// scenes, numbers of sweeps and substeps, and steps that vary. Exit 1: it did.
#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <string>

#include <cdot/methods.hpp>

#include "tests/runtime/tool/support.hpp"
#include "tests/runtime/tool/swept_rise.hpp"

namespace cdot::test {
namespace {

struct Case {
  std::string scene;
  SweptWay way;
  SweptRise seen;
};

std::string steps_in_words(const Jitter& jitter) {
  if (jitter.shortest == jitter.longest) return "even";
  return fmt::format("{:g} to {:g}", jitter.shortest, jitter.longest);
}

// One line for each way: the worst of its scenes.
void print_way(const SweptWay& way, const std::vector<Case>& cases) {
  int runs = 0, fail = 0, rise = 0;
  const Case* worst = nullptr;
  for (const Case& run : cases) {
    runs += run.seen.starts, fail += run.seen.fails, rise += !run.seen.holds();
    if (!worst || run.seen.risen > worst->seen.risen) worst = &run;
  }
  fmt::print("| {} | {} | {} | {} | {} | {} | {:.4f} | {:.4f} | {} |\n", steps_in_words(way.jitter), way.substeps,
             way.sweeps, runs, fail, rise, worst->seen.risen, worst->seen.bound, worst->scene);
  std::fflush(stdout);
}

int study(Drift drift, Integrator integrator) {
  std::vector<std::pair<std::string, Scene>> scenes;
  for (const auto& file : all_scene_files())
    scenes.emplace_back((file.parent_path().filename() / file.stem()).string(), read_scene(file.string()));
  int rising = 0;
  fmt::print("{}, drift {}\n\n", name_of(integrators, integrator), name_of(drifts, drift));
  fmt::print(
      "| steps [1/60 s] | substeps | sweeps | runs | fail aloud | rise | risen | at most | in |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  for (const Jitter& jitter : {Jitter{1, 1}, {0.9, 1.1}, {0.5, 1.5}, {0.1, 2}})
    for (const int substeps : {1, 2, 4, 8})
      for (const int sweeps : {1, 2, 4, 10, 30}) {
        const SweptWay way{sweeps, substeps, jitter, drift, integrator};
        std::vector<Case> cases;
        for (const auto& [name, scene] : scenes) cases.push_back({name, way, swept_rise(scene, way)});
        print_way(way, cases);
        for (const Case& run : cases) {
          if (run.seen.holds()) continue;
          ++rising;
          fmt::print(stderr, "rises: {}, {} sweeps, {} substeps, steps {}: {:.4f}, at most {:.4f}, at {:.3g} s\n",
                     run.scene, sweeps, substeps, steps_in_words(jitter), run.seen.risen, run.seen.bound,
                     run.seen.time);
        }
      }
  return rising > 0;
}

}  // namespace
}  // namespace cdot::test

int main(int count, char** arguments) {
  using namespace cdot;
  const std::string drift = count > 1 ? arguments[1] : "soft", integrator = count > 2 ? arguments[2] : "euler";
  return test::study(method_called(drifts, drift), method_called(integrators, integrator));
}
