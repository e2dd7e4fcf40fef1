// The names in scenes, commands and reports: one table each for drift corrections, integrators, forms of kernels,
// precisions and reactions to a failed step. Solvers have theirs in settings.hpp.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <cdot/settings.hpp>
#include <cdot/step_result.hpp>

namespace cdot {

template <class Method>
struct Named {
  std::string_view name;
  Method method;
};

inline constexpr std::array<Named<Drift>, 4> drifts{{
    {"projection", Drift::projection},
    {"soft", Drift::soft},
    {"baumgarte", Drift::baumgarte},
    {"none", Drift::none},
}};
// The drift correction of a scene that names none.
constexpr Drift usual_drift(const Settings& s) {
  return sweeps(s.solver) && s.integrator == Integrator::euler ? Drift::soft : Drift::projection;
}
inline constexpr auto integrators = [] {
  std::array<Named<Integrator>, integrator_rows.size()> names{};
  for (std::size_t k = 0; k < names.size(); ++k) names[k] = {integrator_rows[k].name, integrator_rows[k].integrator};
  return names;
}();
inline constexpr std::array<Named<Kernels>, 3> kernel_forms{{
    {"fast", Kernels::fast},
    {"balanced", Kernels::balanced},
    {"robust", Kernels::robust},
}};

// True if float.
inline constexpr std::array<Named<bool>, 2> precisions{{
    {"double", false},
    {"float", true},
}};

inline constexpr std::array<Named<OnFailure>, 2> failure_answers{{
    {"stop", OnFailure::stop},
    {"retry", OnFailure::retry},
}};

template <class Table>
std::vector<std::string> names_of(const Table& table) {
  std::vector<std::string> names;
  for (const auto& row : table) names.emplace_back(row.name);
  return names;
}

// The value of `name`, which must be in the table.
template <class Table>
auto method_called(const Table& table, std::string_view name) {
  auto found = table.front().method;
  for (const auto& row : table)
    if (row.name == name) found = row.method;
  return found;
}

template <class Table, class Method>
std::string_view name_of(const Table& table, Method method) {
  std::string_view found;
  for (const auto& row : table)
    if (row.method == method) found = row.name;
  return found;
}

}  // namespace cdot
