// What a sweep has found so far, in a file: an interrupted one goes on from it. Written whole or not at all.
#pragma once

#include <string>

#include "runtime/tool/accuracy/sweep.hpp"

namespace cdot {

// What the findings hold for: they are worth nothing for another program, scene or reference.
struct Fingerprint {
  std::string program, scene;
  bool operator==(const Fingerprint&) const = default;
};
// Of the running program's file; of the scene's text, and whatever else decides what is computed.
std::string hash_of_program();
std::string hash_of(const std::string& text);

void write_state(const std::string& path, const Fingerprint& fingerprint, const SweepState& state);

// Throws cdot::Error with a sentence about what does not fit, or if there is no such file.
SweepState read_state(const std::string& path, const Fingerprint& fingerprint);

}  // namespace cdot
