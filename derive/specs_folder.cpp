#include "derive/specs_folder.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cdot::derive {

namespace fs = std::filesystem;

SpecsFolder::SpecsFolder(fs::path folder) : folder_(std::move(folder)) {}

std::vector<fs::path> SpecsFolder::all() const {
  const fs::path planar = folder_ / "planar";
  std::error_code failure;
  std::vector<fs::path> specs;
  for (const fs::directory_entry& entry : fs::directory_iterator(planar, failure)) {
    if (entry.path().extension() == ".joint") specs.push_back(entry.path());
  }
  if (failure) {
    throw NoSuchSpec(fmt::format("no folder {}: run from the folder that holds specs/, or say --specs DIR",
                                 planar.string()));
  }
  std::sort(specs.begin(), specs.end());
  return specs;
}

fs::path SpecsFolder::find(const std::string& spec) const {
  if (fs::exists(spec)) return spec;
  const fs::path in_folder = folder_ / "planar" / (spec + ".joint");
  if (fs::exists(in_folder)) return in_folder;
  if (spec.find('/') != std::string::npos) throw NoSuchSpec(fmt::format("no such file: {}", spec));
  std::vector<std::string> names;
  for (const fs::path& known : all()) names.push_back(known.stem().string());
  const std::string near = nearest(spec, names);
  throw NoSuchSpec(fmt::format("no spec `{}`: neither that file nor {} exists{}", spec, in_folder.string(),
                               near.empty() ? "" : fmt::format("; did you mean `{}`?", near)));
}

ReadResult SpecsFolder::read(const fs::path& spec, const ReadOptions& options) const {
  const fs::path beside = spec.has_parent_path() ? spec.parent_path() : fs::path(".");
  Library library = load_library(folder_ / "planar");
  library.merge(load_library(beside));
  return read_joint(load_source(spec), library, std::make_shared<Pool>(), options);
}

}  // namespace cdot::derive
