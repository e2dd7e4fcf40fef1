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
  bool of_method = false;  // a prediction of its error, which a measured error answers
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

// [rad] per step that a method follows. Of order 2, a chord is 1 % shorter than the arc of 0.5 rad. Measured on a rod
// about a pivot at its end, the rate is off by 3e-3 in steps of 1 rad by order 4, by 3e-6 in steps of 2 rad by order 8.
constexpr double followed_turn(const IntegratorRow& row) { return row.order >= 8 ? 2 : row.order >= 4 ? 1 : 0.5; }

// `h`: of a substep [s].
std::vector<Concern> concerns_about(const Diagnosis::Island& island, const Settings& settings, bool single, double h,
                                    const Names& names);

}  // namespace cdot
