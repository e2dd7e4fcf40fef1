// `cdot`: from the position constraint of a joint to its Jacobian, effective mass, proof and kernel.
#include <exception>
#include <fmt/format.h>

#include "derive/commands/commands.hpp"

using namespace cdot::derive;

// clang-format off
constexpr cdot::command_line::Command commands[] = {
    {"derive",  "Prove every spec and write its kernel, the registry, the ledger of operation counts and the record of "
                "proofs", derive_command},
    {"explain", "Explain the derivation of a spec, step by step: C, Cdot, J, K, gamma, and its assumptions", explain_command},
    {"diff",    "Compare hand derivations with the generated one, entry by entry, and name each mistake: a missing\n"
                "or extra term, a sign, a factor, a wrong body", diff_command},
    {"check",   "Report errors and risks of a spec, before any code exists", check_command},
    {"emit",    "Write a joint as a header that makes it one of another engine: its kernel and an adapter", emit_command},
    {"compile", "Write a scene as its own step: a C++ header of straight lines", command_beside},
    {"play",    "Open a page where equation, derivation and moving mechanism are live", command_beside},
};
// clang-format on

constexpr cdot::command_line::Program program = {
    "cdot",
    "Write a joint's position constraint C(q) = 0; get its Jacobian J, its effective mass K = J M^-1 J^T,\n"
    "the proof, and a C++ kernel.\n\n"
    "  cdot check   specs/planar/line.joint    errors and risks of a spec\n"
    "  cdot explain specs/planar/line.joint    the derivation, step by step\n"
    "  cdot diff    line                       published derivations against the generated one\n"
    "  cdot derive                             all specs to generated/, proved\n"
    "  cdot emit    hinge --for bullet         a header that makes it a joint of that engine\n"
    "  cdot compile specs/scenes/four_bar.toml a scene as its own step, in C++\n"
    "  cdot play    specs/scenes/machine.toml  the same as a page that moves\n\n"
    "The language is described in specs/README.md.",
    "Exit status: 0 all well; 1 the answer is no (differs, not current); 2 bad usage or input."};

int main(int argc, char** argv) {
  try {
    for (const char* beside : {"compile", "play"})
      if (argc > 1 && std::string_view(argv[1]) == beside) return run_beside(beside, argv);
    return run(program, commands, argc, argv);
  } catch (const std::exception& e) {
    fmt::print(stderr, "cdot: {}\n", e.what());
    return cdot::command_line::wrong_usage;
  }
}
