// The commands of `cdot`, one file each: derive (commands/derive.cpp), explain, diff, check. Each
// adds itself to the command line and returns what to run; the exit status is 0 all well, 1 the
// answer is no, 2 bad usage or input.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace cdot::derive {

using Command = std::function<int()>;

// Each adds its subcommand to `app`; `selected` is set to what to run when the user has chosen it.
void add_derive_command(CLI::App& app, Command& selected);
void add_explain_command(CLI::App& app, Command& selected);
void add_diff_command(CLI::App& app, Command& selected);
void add_check_command(CLI::App& app, Command& selected);

// -j, which commands have that work on several specs.
void add_processes_option(CLI::App& command, int& processes);

}  // namespace cdot::derive
