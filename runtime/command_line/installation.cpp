#include "runtime/command_line/installation.hpp"

namespace cdot::command_line {

namespace fs = std::filesystem;

namespace {

fs::path& share() {
  static fs::path folder = own_folder().parent_path() / CDOT_SHARE;
  return folder;
}

}  // namespace

fs::path own_folder() {
  std::error_code none;
  return fs::read_symlink("/proc/self/exe", none).parent_path();
}

fs::path installed(const fs::path& part) {
  std::error_code none;
  const fs::path path = share() / part;
  return fs::exists(path, none) ? path : fs::path();
}

void install_in(const fs::path& folder) { share() = folder; }

}  // namespace cdot::command_line
