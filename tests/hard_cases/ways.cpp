#include "tests/hard_cases/ways.hpp"

#include <algorithm>
#include <fmt/format.h>

#include <cdot/methods.hpp>

namespace cdot::hard {
namespace {

Ways of_solver(Solver solver) {
  Ways ways;
  for (const auto& row : integrators)
    for (const bool single : {false, true})
      if (row.method != Integrator::radau5) ways.push_back({solver, row.method, single});  // no case claims it
  return ways;
}

template <class Keep>
Ways filtered(const Ways& ways, Keep keep) {
  Ways kept;
  std::copy_if(ways.begin(), ways.end(), std::back_inserter(kept), keep);
  return kept;
}

bool has(const Ways& ways, const Way& way) { return std::find(ways.begin(), ways.end(), way) != ways.end(); }

bool names(std::initializer_list<Integrator> integrators, const Way& way) {
  return std::find(integrators.begin(), integrators.end(), way.integrator) != integrators.end();
}

// "euler, rattle (double)"; "all"
std::string integrators_text(const Ways& ways, Solver solver) {
  std::string text;
  std::size_t whole = 0, doubles = 0;
  for (const auto& row : integrators) {
    const bool exact = has(ways, {solver, row.method, false}), single = has(ways, {solver, row.method, true});
    if (!exact && !single) continue;
    whole += exact && single;
    doubles += exact && !single;
    const char* precision = exact && single ? "" : exact ? " (double)" : " (float)";
    text += fmt::format("{}{}{}", text.empty() ? "" : ", ", row.name, precision);
  }
  const std::size_t all = of_solver(solver).size() / 2;
  if (doubles == all) return "all (double)";
  return whole == all ? "all" : text;
}

}  // namespace

std::string name_of(const Way& way) {
  if (way.chosen) return "by default";
  return fmt::format("{} {} {}", name_of(solvers, way.solver), name_of(integrators, way.integrator),
                     way.single ? "float" : "double");
}

Ways direct() { return of_solver(Solver::direct); }
Ways iterative() { return of_solver(Solver::iterative); }
Ways all_ways() { return direct() + iterative(); }

Ways without(Ways ways, std::initializer_list<Integrator> integrators) {
  return filtered(ways, [&](const Way& way) { return !names(integrators, way); });
}
Ways only(Ways ways, std::initializer_list<Integrator> integrators) {
  return filtered(ways, [&](const Way& way) { return names(integrators, way); });
}
Ways in_double(Ways ways) {
  return filtered(ways, [](const Way& way) { return !way.single; });
}
Ways operator+(Ways ways, const Ways& more) {
  for (const Way& way : more)
    if (!has(ways, way)) ways.push_back(way);
  return ways;
}

std::string text_of(const Ways& ways) {
  std::string text;
  for (const auto& row : solvers) {
    const std::string list = integrators_text(ways, row.method);
    if (!list.empty()) text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", row.name, list);
  }
  return text;
}

}  // namespace cdot::hard
