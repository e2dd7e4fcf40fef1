// Runs a command as a person would.
#pragma once

#include <cstdio>
#include <string>
#include <sys/wait.h>

namespace cdot::test {

struct ShellResult {
  int status = -1;   // -1: the command did not end by itself
  std::string text;  // what the shell sent on: of both streams, if the command has 2>&1
};

inline ShellResult shell(const std::string& command) {
  ShellResult outcome;
  FILE* const pipe = popen(command.c_str(), "r");
  if (!pipe) return outcome;
  char part[4096];
  for (std::size_t n; (n = fread(part, 1, sizeof part, pipe)) > 0;) outcome.text.append(part, n);
  const int status = pclose(pipe);
  if (WIFEXITED(status)) outcome.status = WEXITSTATUS(status);
  return outcome;
}

}  // namespace cdot::test
