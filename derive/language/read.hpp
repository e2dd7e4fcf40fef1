// The reader's front door: the text of a spec in, a Joint and everything there is to say about it
// out.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "derive/language/joint.hpp"
#include "derive/language/value.hpp"
#include "derive/syntax/source.hpp"

namespace cdot::derive {

// The specs that an `include` may name.
using Library = std::map<std::string, std::shared_ptr<const SourceFile>>;
Library load_library(const std::filesystem::path& folder);  // every *.joint in it

// The whole file; throws std::runtime_error that says why, if it cannot be read.
std::shared_ptr<const SourceFile> load_source(const std::filesystem::path& path);

// What the header says: 2 for planar, 3 for spatial; 2 if it says neither.
int dimension_of(const SourceFile& file);

struct ReadOptions {
  // Parameters that are fixed elsewhere than the spec says: {"t", "a"}. For hand derivations that
  // do so.
  std::map<std::string, std::string> anchors;
};

struct ReadResult {
  std::optional<Joint> joint;  // empty if there are errors
  std::shared_ptr<const SourceFile> file;
  std::vector<std::shared_ptr<const SourceFile>> included;  // what it brings in, directly or not
  Diagnostics diagnostics;
  std::map<std::string, Value> names;  // every parameter, arm and let, typed
};

ReadResult read_joint(std::shared_ptr<const SourceFile> file, const Library& library, const ReadOptions& options = {});

}  // namespace cdot::derive
