// A command of cdot-run: one file here, and one row in the table of main.cpp.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace cdot {

enum Status { well = 0, answer_is_no = 1, bad_input = 2, stopped = 130 };

using Run = std::function<int()>;

struct Command {
  const char *name, *summary;
  Run (*add_options)(CLI::App&);  // adds to the command line; the result runs the command
};

Run simulate_command(CLI::App& line);
Run diagnose_command(CLI::App& line);
Run accuracy_command(CLI::App& line);
Run list_command(CLI::App& line);
Run moved_to_diagnose(CLI::App& line);  // the former `jacobian`

}  // namespace cdot
