// The forces at the start of a run by RATTLE, as text.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"

namespace cdot::compile {

// The part of the impulses mu of rows with bounds in `pull` and lambda, by B; `again`: the impulse that the next step
// repeats.
inline constexpr const char* sums_pulls = R"(    for (int e = 0; e < bounded; ++e) {{
      const T again = {3};
      for (int i = 0; i < bodies; ++i) {0}{2}pull[i] = {2}pull[i] + mu[e] * B.p[e][i] + again * B.u[e][i];
{1}    }}
)";
inline constexpr const char* sums_lambda =
    "      for (int i = 0; i < rows; ++i) {0}lambda[i] = {0}lambda[i] + mu[e] * B.l[e][i];\n";

// start(), if `exerts`.
std::string start_of(const Contents& has);

}  // namespace cdot::compile
