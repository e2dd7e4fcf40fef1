// Reads the catalogue's specs.
#pragma once

#include <algorithm>
#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "derive/derivation/derivation.hpp"
#include "derive/explain/explain.hpp"
#include "derive/language/specs_folder.hpp"

// "planar/line", ...
inline std::vector<std::string> spec_names() {
  std::vector<std::string> names;
  for (const std::filesystem::path& path : cdot::derive::SpecsFolder(CDOT_SOURCE_DIR "/specs").all()) {
    names.push_back(path.parent_path().stem().string() + "/" + path.stem().string());
  }
  return names;
}

// A file name without folders: "planar_line".
inline std::string flat(std::string name) {
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

inline cdot::derive::Derivation read_spec(const std::string& name) {
  const cdot::derive::SpecsFolder folder(CDOT_SOURCE_DIR "/specs");
  const cdot::derive::ReadResult read = folder.read(folder.find(name));
  if (!read.joint) throw std::runtime_error(render(*read.file, read.diagnostics));
  return cdot::derive::derive(*read.joint);
}

// Joints with operators that the catalogue does not use: angles between directions, functions, velocity rows, roots.
std::vector<std::pair<std::string, std::string>> unusual_specs();
cdot::derive::Derivation read_text(const std::string& name, const std::string& text);
