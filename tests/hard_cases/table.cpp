// Prints README.md: for each case the ways that hold it, the criterion and the worst measured number.
#include <algorithm>
#include <fmt/format.h>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard {
namespace {

constexpr const char* head = R"(# Hard cases

Known cases that break engines of this kind, each as a scene, run in every way that claims to hold it: solver and
integrator, in double and in float. A test fails if a number exceeds its bound. Steps are 1/60 s in one substep, with
ten iterations, unless the case states otherwise; each folder's .cpp has its criterion.

    build/dev/tests/hard_cases/hard_cases_tests                  # the tests
    build/dev/tests/hard_cases/hard_cases_tests --try [FAULT]    # reports of the ways that claim nothing
    build/dev/tests/hard_cases/hard_cases_tests --table > tests/hard_cases/README.md

A way that does not hold a case reports the reason before or during the run, like `cdot-run diagnose` and
`cdot-run simulate`, or is merely inaccurate: `NoSilence.*` tests that no way fails without a report.

Nobody needs to know the way: `ByDefault.*` tests that the method which the runtime chooses by itself
([recommended.hpp](../../runtime/include/cdot/recommended.hpp)) holds every case.

The last command wrote this page. It shows the worst of each number over the ways, and its bound.

| case | held by | by default | in double | in float |
|---|---|---|---|---|
)";

// The worst number of one finding over the ways of one precision.
struct Worst {
  std::string what;
  double value, bound;
};

void take(std::vector<Worst>& worst, const Finding& found) {
  for (Worst& row : worst)
    if (row.what == found.what) {
      row.value = std::max(row.value, found.value);
      return;
    }
  worst.push_back({found.what, found.value, found.bound});
}

std::string text_of(const std::vector<Worst>& worst) {
  std::string text;
  for (const Worst& row : worst) {
    text += fmt::format("{}{} {:.1e}", text.empty() ? "" : "; ", row.what, row.value);
    if (row.bound < finite_only) text += fmt::format(" ≤ {:.1e}", row.bound);
  }
  return text;
}

// "rattle holds"; "holds" of a case that only asks whether something is refused.
std::string text_by_default(const Case& hard_case) {
  std::string chosen;
  const std::vector<Finding> found = findings_of(hard_case, by_default, &chosen);
  const bool held = std::all_of(found.begin(), found.end(), [](const Finding& one) { return one.held(); });
  return fmt::format("{}{}{}", chosen, chosen.empty() ? "" : " ", held ? "holds" : "**fails**");
}

}  // namespace

std::string table_row_start(const Case& hard_case) {
  const std::string variant = hard_case.variant.empty() ? "" : ", " + hard_case.variant;
  return fmt::format("| [{0}/{1}]({0}/{1}.toml){2} | {3} | ", hard_case.fault, hard_case.scene, variant,
                     text_of(hard_case.ways));
}

std::string table(const std::vector<Case>& cases) {
  std::string text = head;
  for (const Case& hard_case : cases) {
    std::vector<Worst> exact, single;
    for (const Way& way : hard_case.ways)
      for (const Finding& found : findings_of(hard_case, way)) take(way.single ? single : exact, found);
    text += fmt::format("{}{} | {} | {} |\n", table_row_start(hard_case), text_by_default(hard_case), text_of(exact),
                        text_of(single));
  }
  return text;
}

}  // namespace cdot::hard
