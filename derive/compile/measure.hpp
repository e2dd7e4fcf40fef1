// Headers of compiled scenes -> bytes of code and instructions of a step, by the machine's compiler and callgrind.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace cdot::compile {

struct Measured {
  std::optional<long> code;          // bytes of a step in double, with its constants
  std::optional<long> instructions;  // of a step, the mean over steps from `measured_steps` states
};

inline constexpr int measured_steps = 100;
inline constexpr const char* measured_options = "-std=c++20 -O2 -ffp-contract=off -fno-tree-slp-vectorize";

struct Source {
  std::string header, struct_name;
};

// Compiles them on all cores. The first one runs; all take a step from each of its first states. They have the same
// bodies. After `seconds` none is begun any more; what was not measured stays empty. Appends to
// `notes` what is missing, each with its fix.
std::vector<Measured> measure(const std::vector<Source>& sources, double seconds, std::vector<std::string>& notes);

}  // namespace cdot::compile
