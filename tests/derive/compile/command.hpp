// Runs `cdot compile` as a command.
#pragma once

#include <cstdio>
#include <fmt/format.h>
#include <string>
#include <sys/wait.h>

namespace cdot {

struct Outcome {
  int status = 0;
  std::string text;  // of both streams
};

inline Outcome run(const std::string& command) {
  Outcome outcome;
  FILE* const pipe = popen((command + " 2>&1").c_str(), "r");
  char part[4096];
  for (std::size_t n; (n = fread(part, 1, sizeof part, pipe)) > 0;) outcome.text.append(part, n);
  outcome.status = WEXITSTATUS(pclose(pipe));
  return outcome;
}

// In the folder of the sources; `setting`: variables of the environment, "CXX=clang++".
inline Outcome compile(const std::string& arguments, const std::string& setting = {}) {
  return run(fmt::format("cd {} && {} {} compile {}", CDOT_SOURCE_DIR, setting, CDOT, arguments));
}

}  // namespace cdot
