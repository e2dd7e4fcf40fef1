// `cdot-run simulate` of several scenes, each in a process of its own. All processes are copies of one that has run the
// first scene: valgrind translates code only once, which takes longer than to count it.
//
//   simulate_each SCENE... -- OPTION...
#include <algorithm>
#include <cstdio>
#include <string_view>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "runtime/tool/commands/command.hpp"

namespace {

constexpr cdot::command_line::Command commands[] = {{"simulate", "", cdot::simulate_command}};
constexpr cdot::command_line::Program program = {"cdot-run", "", ""};

int simulate(const char* scene, const std::vector<const char*>& options) {
  std::vector<const char*> line = {"cdot-run", "simulate", scene};
  line.insert(line.end(), options.begin(), options.end());
  const int status = run(program, commands, static_cast<int>(line.size()), line.data());
  std::fflush(stdout);
  return status;
}

}  // namespace

int main(int count, char** arguments) {
  char **const end = arguments + count, **const dashes = std::find(arguments + 1, end, std::string_view("--"));
  const std::vector<const char*> options(std::min(dashes + 1, end), end);
  if (simulate(arguments[1], options) != 0) return 1;
  for (char** scene = arguments + 2; scene < dashes; ++scene) {
    if (fork() == 0) return simulate(*scene, options);
    int status = -1;
    wait(&status);
    if (status != 0) return 1;
  }
}
