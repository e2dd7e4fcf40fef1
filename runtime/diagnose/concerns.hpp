// A diagnosis and a method -> warnings, where the method will be inaccurate or unstable, with a better one.
#pragma once

#include <algorithm>
#include <compare>
#include <functional>
#include <string>
#include <vector>

#include <cdot/diagnose.hpp>

namespace cdot {

struct Concern {
  bool warning = false;  // else a note
  std::string what, fix;
  auto operator<=>(const Concern&) const = default;
};

struct Names {
  std::function<std::string(int)> body, joint;
};

// Among the integrators of which `fits` is true, the one of highest order; of equal ones the first.
template <class F>
constexpr Integrator most_exact(F fits) {
  const auto less = [&](const IntegratorRow& a, const IntegratorRow& b) {
    return (fits(a) ? a.order : 0) < (fits(b) ? b.order : 0);
  };
  return std::max_element(integrator_rows.begin(), integrator_rows.end(), less)->integrator;
}

// `h`: of a substep [s].
std::vector<Concern> concerns_about(const Diagnosis::Island& island, const Settings& settings, bool single, double h,
                                    const Names& names);

}  // namespace cdot
