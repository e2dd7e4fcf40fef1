// The commands of `cdot`, one file each. A command adds its options and its help to the command line and returns the
// function that runs it. The exit status is 0 all well, 1 the answer is no, 2 bad usage or input.
#pragma once

#include <filesystem>
#include <string>

#include "runtime/command_line/command_line.hpp"

namespace cdot::derive {

using command_line::Line;
using command_line::Run;
using command_line::with_options;

Run derive_command(Line& line);
Run explain_command(Line& line);
Run diff_command(Line& line);
Run check_command(Line& line);
Run emit_command(Line& line);
Run command_beside(Line& line);  // of `cdot compile` and `cdot play`: their lines in the help

// Becomes the program `cdot-compile` or `cdot-play`, which lies beside `cdot`. Returns the exit status if it cannot.
int run_beside(const std::string& command, char** argv);

// Writes through a temporary file, so that nobody reads half of one; a device, a pipe or a link is written in place.
// "-" is standard output.
void write_file(const std::filesystem::path& path, const std::string& content);

void add_specs(Line& line, std::string& folder);  // --specs
void add_jobs(Line& line, int& processes);        // -j, for commands on several specs

}  // namespace cdot::derive
