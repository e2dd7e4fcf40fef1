// Runs `cdot compile` as a command.
#pragma once

#include <fmt/format.h>
#include <string>

#include "tests/shell.hpp"

namespace cdot {

using test::ShellResult;

inline ShellResult run(const std::string& command) { return test::shell(command + " 2>&1"); }

// In the folder of the sources; `setting`: variables of the environment, "CXX=clang++".
inline ShellResult compile(const std::string& arguments, const std::string& setting = {}) {
  return run(fmt::format("cd {} && {} {} compile {}", CDOT_SOURCE_DIR, setting, CDOT, arguments));
}

}  // namespace cdot
