// bench_search: how honest the search for a method is, and what it costs.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <functional>
#include <map>

#include "tests/bench/search/runs.hpp"

namespace cdot::search_bench {
// At the accuracies 10^-digits.
void study_claims(const std::vector<Scene>& scenes, const std::vector<int>& digits);  // claims.cpp
void study_price(const std::vector<Scene>& scenes);                                   // price.cpp
void study_estimate(const std::vector<Scene>& scenes);                                // estimate.cpp
void study_survey(const std::vector<Scene>& scenes);                                  // survey.cpp
void study_work(const std::vector<Scene>& scenes);                                    // work.cpp
}  // namespace cdot::search_bench

int main(int count, char** arguments) {
  using namespace cdot;
  using namespace cdot::search_bench;
  CLI::App app("Studies of the search for a method, over the scenes below folders.");
  std::string study, only;
  std::vector<std::string> folders;
  std::vector<int> digits = {2, 3, 4, 5, 6, 7, 8, 9};
  const auto claims = [&](const std::vector<Scene>& scenes) { study_claims(scenes, digits); };
  const std::map<std::string, std::function<void(const std::vector<Scene>&)>> studies = {{"claims", claims},
                                                                                         {"price", study_price},
                                                                                         {"estimate", study_estimate},
                                                                                         {"survey", study_survey},
                                                                                         {"work", study_work}};
  app.add_option(
         "study", study,
         "claims: claimed against true errors; price: against the cheapest named method; estimate: of runs with "
         "fixed steps, against true errors; survey: claimed against the distance from unlike methods; work: "
         "evaluations of searches")
      ->required()
      ->check(CLI::IsMember(studies));
  app.add_option("folders", folders, "with scenes")->required()->check(CLI::ExistingDirectory);
  app.add_option("--only", only, "scenes whose name contains this");
  app.add_option("--digits", digits, "of the accuracies of claims: 2 to 9 by default")->check(CLI::Range(1, 12));
  CLI11_PARSE(app, count, arguments);
  try {
    std::vector<Scene> scenes;
    for (const std::string& folder : folders)
      for (Scene& scene : scenes_below(folder))
        if (short_name(scene).find(only) != std::string::npos) scenes.push_back(std::move(scene));
    studies.at(study)(scenes);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
