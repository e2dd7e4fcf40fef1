#include "runtime/command_line/installation.hpp"

#include <fstream>
#include <string>

namespace cdot::command_line {

namespace fs = std::filesystem;

namespace {

fs::path& share() {
  static fs::path folder = own_folder().parent_path() / CDOT_SHARE;
  return folder;
}

// The checkout of which the program's folder is a build, by the CMake cache above it; empty if it is none.
fs::path checkout() {
  constexpr std::string_view entry = "cdot_SOURCE_DIR:STATIC=";
  for (fs::path folder = own_folder(); folder.has_relative_path(); folder = folder.parent_path()) {
    std::ifstream cache(folder / "CMakeCache.txt");
    for (std::string line; std::getline(cache, line);)
      if (line.starts_with(entry)) return line.substr(entry.size());
  }
  return {};
}

}  // namespace

fs::path own_folder() {
  std::error_code none;
  return fs::read_symlink("/proc/self/exe", none).parent_path();
}

fs::path installed(const fs::path& part) {
  std::error_code none;
  if (const fs::path path = share() / part; fs::exists(path, none)) return path;
  if (part.empty()) return {};
  static const fs::path sources = checkout();
  const fs::path path = sources / part;
  return !sources.empty() && fs::exists(path, none) ? path : fs::path();
}

void install_in(const fs::path& folder) { share() = folder; }

}  // namespace cdot::command_line
