// The machine's C++ compiler, for texts that were just written.
#pragma once

#include <filesystem>
#include <string>

namespace cdot {

struct Ran {
  bool well = false;
  std::string output;  // of both streams
};

Ran shell(const std::string& command);
std::string quoted(const std::string& word);  // for a shell
bool has_program(const std::string& name);    // that a shell finds
std::string first_line(const std::string& text);

// A folder that is removed at the end.
class ScratchFolder {
 public:
  ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder();
  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

// $CXX, or c++.
std::string compiler_name();
// "there is no compiler c++. Fix: install g++, or set CXX"
std::string no_compiler();

}  // namespace cdot
