// Kernels to the texts of generated files. They depend on the joints alone: no date, no path, no version.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "derive/kernel/plan.hpp"

namespace cdot::derive {

// generated/planar/<joint>.hpp or generated/spatial/<joint>.hpp
std::string emit_kernel(const Kernel& kernel);
// The struct of that file for a header that needs <cmath> at most: without names for people and variants, and with
// these functions only; all if there are none.
std::string emit_kernel_alone(const Kernel& kernel, std::span<const std::string_view> only);

// generated/planar/registry.hpp and generated/spatial/registry.hpp: the lists of all joints and effects, by name.
std::string emit_registry(const std::string& space, const std::vector<std::string>& joints,
                          const std::vector<std::string>& effects);

// C, J and K as people write them, a line each, for the comment above a kernel.
std::vector<std::string> describe(const Kernel& kernel);

}  // namespace cdot::derive
