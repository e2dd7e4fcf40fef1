#include "runtime/tool/compiled/compiler.hpp"

#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <unistd.h>

#include "runtime/tool/scene/scene.hpp"

namespace cdot {

namespace fs = std::filesystem;

Ran shell(const std::string& command) {
  Ran ran;
  FILE* const pipe = popen((command + " 2>&1").c_str(), "r");
  if (!pipe) return ran;
  char part[4096];
  for (std::size_t n; (n = fread(part, 1, sizeof part, pipe)) > 0;) ran.output.append(part, n);
  ran.well = pclose(pipe) == 0;
  return ran;
}

std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? "'\\''" : std::string(1, c);
  return text + "'";
}

bool has_program(const std::string& name) { return shell("command -v " + name).well; }

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

ScratchFolder::ScratchFolder() {
  std::string path = (fs::temp_directory_path() / "cdot_XXXXXX").string();
  if (!mkdtemp(path.data()))
    throw Error(fmt::format("{}: cannot be made. Fix: set TMPDIR to a folder with room", path));
  path_ = path;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string compiler_name() { return std::getenv("CXX") ? std::getenv("CXX") : "c++"; }

std::string no_compiler() {
  return fmt::format("there is no compiler {}. Fix: install g++, or set CXX", compiler_name());
}

}  // namespace cdot
