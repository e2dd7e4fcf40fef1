// The reader: the text of a spec in, a Joint and all messages about it out.
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
bool is_spec(const std::filesystem::path& file);            // *.joint or *.effect
Library load_library(const std::filesystem::path& folder);  // every *.joint in it

inline constexpr const char* standard_input = "-";

// The whole file, or all of standard input; throws std::runtime_error with the cause if it cannot be read.
std::shared_ptr<const SourceFile> load_source(const std::filesystem::path& path);

// 2 for a planar header, 3 for a spatial one; 2 if the header is missing.
int dimension_of(const SourceFile& file);

// Parameters that a hand derivation fixes in another body than the spec: {"t", "a"}.
using Anchors = std::map<std::string, std::string>;

struct ReadResult {
  std::optional<Joint> joint;  // empty if there are errors
  std::shared_ptr<const SourceFile> file;
  std::vector<std::shared_ptr<const SourceFile>> included;  // files that it includes, directly or not
  Diagnostics diagnostics;
  std::map<std::string, Value> names;  // every parameter, arm and let, typed
  Library library;                     // that it was read with
};

ReadResult read_joint(std::shared_ptr<const SourceFile> file, const Library& library);
// The same texts into a pool of their own, with these anchors, as far as the joint has the bodies. No file is opened.
ReadResult read_anchored(const ReadResult& plain, const Anchors& anchors);

}  // namespace cdot::derive
