// The files that are installed with a program: <prefix>/bin/cdot finds <prefix>/share/cdot/specs.
#pragma once

#include <filesystem>

namespace cdot::command_line {

// The folder of the running program.
std::filesystem::path own_folder();

// share/cdot/PART of the prefix in which the program is installed, or a PART that a library has beside it; empty if
// there is none.
std::filesystem::path installed(const std::filesystem::path& part);

// For a library in a program of others: `folder` holds what a program finds in share/cdot.
void install_in(const std::filesystem::path& folder);

}  // namespace cdot::command_line
