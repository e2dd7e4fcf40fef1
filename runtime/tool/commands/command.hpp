// The commands of cdot-run, one file each. A new one is one row in the table of main.cpp.
#pragma once

#include "runtime/command_line/command_line.hpp"

namespace cdot {

enum Status { well = 0, answer_is_no = 1, bad_input = command_line::wrong_usage, stopped = 130 };

using command_line::Line;
using command_line::Run;

Run simulate_command(Line& line);
Run diagnose_command(Line& line);
Run accuracy_command(Line& line);
Run import_command(Line& line);
Run list_command(Line& line);
Run moved_to_diagnose(Line& line);  // the former `jacobian`

}  // namespace cdot
