// `cdot compile` is a program of its own, as the subcommands of git are: it links the runtime, which is built from what
// `cdot` writes.
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <unistd.h>

#include "derive/commands/commands.hpp"
#include "runtime/command_line/installation.hpp"

namespace cdot::derive {
int run_compile(char** argv) {
  const std::string program = (command_line::own_folder() / "cdot-compile").string();
  execv(program.c_str(), argv);
  fmt::print(stderr, "cdot compile: cannot run {}: {}. Fix: build or install the target cdot-compile beside cdot\n",
             program, std::strerror(errno));
  return command_line::wrong_usage;
}

// run_compile() takes all arguments before they are read.
Run compile_command(Line&) {
  return [] { return command_line::wrong_usage; };
}

}  // namespace cdot::derive
