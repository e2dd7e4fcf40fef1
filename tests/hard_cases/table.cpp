// README.md: of all cases the ways that hold them, the criterion, and the worst that was measured.
#include <algorithm>
#include <fmt/format.h>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard {
namespace {

constexpr const char* head = R"(# Hard cases

What is known to break engines of this kind, each as a scene, run in every way that claims to hold it: solver and
integrator, in double and in float. A test fails where a number is above its bound. Steps are 1/60 s in one substep, with
ten iterations, unless the case says otherwise; each folder's .cpp has its criterion.

    build/dev/tests/hard_cases/hard_cases_tests                  # the tests
    build/dev/tests/hard_cases/hard_cases_tests --try [FAULT]    # what is said of the ways that claim nothing
    build/dev/tests/hard_cases/hard_cases_tests --table > tests/hard_cases/README.md

A way that is not among those that hold a case says why before or while it runs, as `cdot-run diagnose` and
`cdot-run simulate` do, or is merely inexact: `NoSilence.*` tests that none is lost without a word.

The last command wrote this page. Of each number the worst over the ways is shown, and its bound.

| case | held by | in double | in float |
|---|---|---|---|
)";

// The worst of one finding over the ways of one precision.
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
    text += fmt::format("{}{} | {} |\n", table_row_start(hard_case), text_of(exact), text_of(single));
  }
  return text;
}

}  // namespace cdot::hard
