// `cdot compile` and `cdot play` are programs of their own, as the subcommands of git are: they link the runtime, which
// is built from what `cdot` writes, or carry a page.
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <unistd.h>

#include "derive/commands/commands.hpp"
#include "runtime/command_line/installation.hpp"

namespace cdot::derive {
int run_beside(const std::string& command, char** argv) {
  const std::string name = "cdot-" + command, program = (command_line::own_folder() / name).string();
  execv(program.c_str(), argv);
  fmt::print(stderr, "cdot {}: cannot run {}: {}. Fix: build or install the target {} beside cdot\n", command, program,
             std::strerror(errno), name);
  return command_line::wrong_usage;
}

// run_beside() takes all arguments before they are read.
Run command_beside(Line& line) {
  line.is_of_a_program();
  return [] { return command_line::wrong_usage; };
}

}  // namespace cdot::derive
