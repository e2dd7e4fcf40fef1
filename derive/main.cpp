// `cdot`: from the position constraint of a joint to its Jacobian, effective mass, proof and
// kernel.
#include <CLI/CLI.hpp>
#include <exception>
#include <fmt/format.h>

#include "derive/commands/commands.hpp"

int main(int argc, char** argv) {
  CLI::App app{
      "Write a joint's position constraint C(q) = 0; get its Jacobian J, its effective mass K = J "
      "M^-1 J^T,\n"
      "the proof, and a C++ kernel.\n\n"
      "  cdot check   specs/planar/line.joint    what is wrong or risky about a spec\n"
      "  cdot explain specs/planar/line.joint    the derivation, step by step\n"
      "  cdot diff    line                       published derivations against the generated one\n"
      "  cdot derive                             all specs to generated/, proved\n\n"
      "The language is described in specs/README.md."};
  app.require_subcommand(1);
  app.footer("Exit status: 0 all well; 1 the answer is no (differs, not current); 2 bad usage or input.");
  cdot::derive::Command selected;
  cdot::derive::add_derive_command(app, selected);
  cdot::derive::add_explain_command(app, selected);
  cdot::derive::add_diff_command(app, selected);
  cdot::derive::add_check_command(app, selected);
  try {
    app.parse(argc, argv);
    return selected();
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const std::exception& e) {
    fmt::print(stderr, "cdot: {}\n", e.what());
    return 2;
  }
}
