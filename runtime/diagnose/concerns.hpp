// What a diagnosis means for the method that is to take the steps: where it will be wrong or fly apart, and what to use
// instead.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <cdot/diagnose.hpp>

namespace cdot {

struct Concern {
  bool warning = false;  // else a note: nothing goes wrong
  std::string what, fix;
  bool operator==(const Concern&) const = default;
};

struct Names {
  std::function<std::string(int)> body, joint;
};

// `h`: of a substep [s].
std::vector<Concern> concerns_about(const Diagnosis::Island& island, const Settings& settings, bool single, double h,
                                    const Names& names);

}  // namespace cdot
