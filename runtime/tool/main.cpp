// cdot-run: the commands, each a file in tool/commands/.
#include <exception>

#include "runtime/tool/commands/command.hpp"
#include "runtime/tool/failure.hpp"

namespace {

// clang-format off
constexpr cdot::command_line::Command commands[] = {
    {"simulate", "Run a scene; report errors, energy and CPU time", cdot::simulate_command},
    {"diagnose", "Run a scene; report rank, redundant and conflicting rows, condition and stiffness of its equations, "
                 "and warn where the method does not suit them", cdot::diagnose_command},
    {"accuracy", "Solve a scene in many ways; show the CPU time of every accuracy", cdot::accuracy_command},
    {"import", "Turn a robot description (URDF, MJCF) into a scene", cdot::import_command},
    {"list", "List the joints and effects with their parameters, one of them, or the keys of a scene", cdot::list_command},
    {"jacobian", "", cdot::moved_to_diagnose},
};
// clang-format on

constexpr cdot::command_line::Program program = {
    "cdot-run",
    "Runs mechanisms of bodies and joints. The kernels of joints are derived from their position constraints.", R"(
Examples
  cdot-run simulate specs/scenes/four_bar.toml
  cdot-run simulate specs/scenes/four_bar.toml --html four_bar.html       # a page that plays the run
  cdot-run simulate specs/scenes/four_bar.toml --step 0.0001 --every 0.1 -o four_bar.csv
  cdot-run simulate specs/scenes/four_bar.toml --until 5 --save-state at_5.state
  cdot-run simulate specs/scenes/four_bar.toml --from-state at_5.state    # continues with the same bits
  cdot-run diagnose specs/scenes/four_bar.toml                            # rank, condition, stiffness, warnings
  cdot-run diagnose specs/scenes/four_bar.toml --matrix                   # the system in blocks and numbers
  cdot-run accuracy specs/scenes/double_pendulum.toml                     # CPU time against error
  cdot-run import arm.urdf -o arm.toml                                    # a scene of a robot description
  cdot-run list                                                           # all joints with their parameters
  cdot-run list --keys                                                    # all keys of a scene

Exit status
  0  success
  1  the run failed: the state was not finite, or |C| of a joint exceeded the tolerance
  2  wrong usage, or mistakes in the scene: each is shown with its line and a likely fix

specs/scenes/README.md describes the format of scenes.)"};

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(program, commands, argc, argv);
  } catch (const std::exception&) {
    return cdot::report_failure("cdot-run");
  }
}
