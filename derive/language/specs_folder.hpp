// The folder of specs: from the words of a command line to files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "derive/language/read.hpp"

namespace cdot::derive {

// Thrown for a missing spec; its text lists the tried paths and the likely fix.
struct NoSuchSpec : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class SpecsFolder {
 public:
  // `folder` holds planar/*.joint; relative to the current directory unless absolute. Where the current directory has
  // no "specs", that is the folder of the installation.
  explicit SpecsFolder(std::filesystem::path folder = "specs");

  // A path, "-" for standard input, or the name of a joint of the folder: "line" is specs/planar/line.joint.
  std::filesystem::path find(const std::string& spec) const;
  // Every spec of the folder, by name.
  std::vector<std::filesystem::path> all() const;

  // Reads one spec; the specs beside it are what `include` finds. Diagnostics are in the result.
  ReadResult read(const std::filesystem::path& spec) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace cdot::derive
