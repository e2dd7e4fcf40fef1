// The commands of `cdot`, one file each. A command adds its options and its help to the command line and returns the
// function that runs it. The exit status is 0 all well, 1 the answer is no, 2 bad usage or input.
#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
}

namespace cdot::derive {

using Run = std::function<int()>;

Run derive_command(CLI::App& command);
Run explain_command(CLI::App& command);
Run diff_command(CLI::App& command);
Run check_command(CLI::App& command);

// Adds --specs and -j, for commands on several specs.
void add_shared_options(CLI::App& command, std::string& specs_folder, int& processes);

}  // namespace cdot::derive
