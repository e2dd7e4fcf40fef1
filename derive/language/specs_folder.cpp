#include "derive/language/specs_folder.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "runtime/command_line/installation.hpp"
#include "runtime/text/files.hpp"

namespace cdot::derive {

namespace fs = std::filesystem;

namespace {

constexpr const char* default_folder = "specs";

}  // namespace

SpecsFolder::SpecsFolder(fs::path folder) : folder_(std::move(folder)) {
  if (folder_ != default_folder || fs::exists(folder_)) return;
  if (fs::path installed = command_line::installed(default_folder); !installed.empty()) folder_ = std::move(installed);
}

std::vector<fs::path> SpecsFolder::all() const {
  std::vector<fs::path> specs;
  bool found = false;
  for (const char* space : {"coordinate", "planar", "spatial"}) {
    std::error_code none;
    for (fs::path& spec : text::files_in(folder_ / space, {".joint", ".effect"})) specs.push_back(std::move(spec));
    found = found || fs::is_directory(folder_ / space, none);
  }
  if (!found) {
    throw NoSuchSpec(
        fmt::format("no folder {0}/planar or {0}/spatial: run from the folder that holds specs/, or say --specs DIR",
                    folder_.string()));
  }
  std::sort(specs.begin(), specs.end());
  return specs;
}

fs::path SpecsFolder::find(const std::string& spec) const {
  std::error_code none;
  if (spec == standard_input || fs::exists(fs::symlink_status(spec, none))) return spec;
  std::vector<std::string> names;
  fs::path on_coordinates;
  for (const fs::path& known : all()) {
    const std::string name = known.stem().string(), space = known.parent_path().filename().string();
    // `line`, or `spatial/line` where several folders have one of that name: the planar one comes first, then the
    // spatial one.
    if (space + "/" + name == spec || (name == spec && space != "coordinate")) return known;
    if (name == spec) on_coordinates = known;
    names.push_back(name);
  }
  if (!on_coordinates.empty()) return on_coordinates;
  for (const char* ending : {".joint", ".effect"}) {
    if (spec.ends_with(ending)) throw NoSuchSpec(fmt::format("no such file: {}", spec));
    if (fs::exists(spec + ending))
      throw NoSuchSpec(fmt::format("no spec is called `{0}`; did you mean `{0}{1}`?", spec, ending));
  }
  if (spec.find('/') != std::string::npos) throw NoSuchSpec(fmt::format("no such file: {}", spec));
  const std::string near = nearest(spec, names);
  throw NoSuchSpec(fmt::format("no spec `{}`: neither that file nor {} exists{}", spec,
                               (folder_ / "planar" / (spec + ".joint")).string(),
                               near.empty() ? "" : fmt::format("; did you mean `{}`?", near)));
}

ReadResult SpecsFolder::read(const fs::path& spec) const {
  const std::shared_ptr<const SourceFile> file = load_source(spec);
  const fs::path space = folder_ / name_of_space(dimension_of(*file));
  Library library;
  if (fs::is_directory(space)) library = load_library(space);
  library.merge(load_library(spec.has_parent_path() ? spec.parent_path() : fs::path(".")));
  return read_joint(file, library);
}

}  // namespace cdot::derive
