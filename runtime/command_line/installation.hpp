// The files that belong to a program: <prefix>/bin/cdot finds <prefix>/share/cdot/specs, and a program in a build
// folder those of its checkout.
#pragma once

#include <filesystem>

namespace cdot::command_line {

// The folder of the running program.
std::filesystem::path own_folder();

// share/cdot/PART of the prefix in which the program is installed, a PART that a library has beside it, or PART of the
// checkout in which the program was built; empty if there is none.
std::filesystem::path installed(const std::filesystem::path& part);

// For a library in a program of others: `folder` holds what a program finds in share/cdot.
void install_in(const std::filesystem::path& folder);

}  // namespace cdot::command_line
