// The files that are installed with a program: <prefix>/bin/cdot finds <prefix>/share/cdot/specs.
#pragma once

#include <filesystem>

namespace cdot::command_line {

// The folder of the running program.
std::filesystem::path own_folder();

// share/cdot/PART of the prefix in which the program is installed; empty if there is none.
std::filesystem::path installed(const std::filesystem::path& part);

}  // namespace cdot::command_line
