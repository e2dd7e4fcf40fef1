// `cdot explain`: the derivation of one spec, for a person as text, HTML or LaTeX, for a program as JSON.
#include "derive/explain/explain.hpp"

#include <fmt/format.h>
#include <iostream>

#include "derive/check/check.hpp"
#include "derive/commands/commands.hpp"
#include "derive/derivation/derivation.hpp"
#include "derive/explain/formats/mathml.hpp"
#include "derive/language/specs_folder.hpp"
#include "runtime/command_line/waiting.hpp"
#include "runtime/text/colour.hpp"
#include "runtime/text/stage.hpp"

namespace cdot::derive {
namespace {

struct Options {
  std::string spec, format = "text", form = "global", output, specs_folder = "specs";
  bool json = false;
};

constexpr const char* json_schema =
    "With --json, one object (names are those of the spec; `null` where nothing applies):\n"
    "  format         1, the version of this schema\n"
    "  joint, title, source, dimension, bodies\n"
    "  columns        of every J: v_a_x, v_a_y, w_a, v_b_x, ...; in space v_a_z, w_a_x, ... too\n"
    "  symbols        name -> {kind, meaning, unit, frame, body, from, unit_length}; kind is position, orientation,\n"
    "                 velocity, mass, parameter, derived, time, constant, or, of a law, value, rate or force;\n"
    "                 `from` gives a derived one from the pose and the parameters:\n"
    "                 r_pa_x = cos(theta_a)*pa_local_x - sin(theta_a)*pa_local_y;\n"
    "                 unit_length: true for components of a vector of length 1\n"
    "  frames         [{name, axes}]: right-handed triads among the parameters, in space\n"
    "  intermediates  [{name, definition}], in order: each uses only those before it\n"
    "  guards         [{where, kernel}]: where an entry is undefined and what a kernel does there\n"
    "  rows           [{name, kind, text, unit}], kind is equality, inequality or velocity\n"
    "  C, Cdot, C_t, gamma   one expression a row; C_t is dC/dt with the bodies at rest\n"
    "  J, K           one array a row; K is square; \"0\" for an empty entry\n"
    "  coordinates    [{name, text, unit, C, Cdot, C_t, J, K, gamma}], with one row each\n"
    "  law            of an effect, else null: {value, rate, energy, force, unstored, stiffness, damping}; value and "
    "rate\n"
    "                 are symbols, one a row; stiffness is -dF/d(value) and damping -dF/d(rate), one array a row\n"
    "  bounds         its rows with bounds: [{name, text, coordinate, rate, lower, upper, by_lower, by_upper, after, "
    "until}];\n"
    "                 by_lower and by_upper are what each unit of the load adds\n"
    "Expressions are infix text with + - * / ** and the functions of the specs, as sympy and\n"
    "Python read them. A spec's name that Python reserves gets an underscore at its end.";

std::string explanation(const Joint& joint, const Options& options) {
  const command_line::Waiting waiting("cdot explain " + joint.name);
  const text::Stage deriving("deriving");
  const Derivation derivation = derive(joint);
  const text::Stage explaining("explaining");
  if (options.json) return explanation_json(derivation);
  const Explanation steps = explain(derivation, form_named(options.form));
  if (options.format == "html") {
    std::string page = explanation_html(steps);
    return page.insert(page.rfind(html_foot), singular_poses_html(derivation));
  }
  if (options.format == "latex") return explanation_latex(steps);
  return explanation_text(steps);
}

int print(const std::string& text, const Options& options) {
  if (options.output.empty() || options.output == "-") {
    std::cout << text;
    return std::cout.flush() ? 0 : 2;
  }
  const std::filesystem::path folder = std::filesystem::path(options.output).parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder)) {
    fmt::print(stderr, "cdot explain: cannot write {}: there is no folder {}\n", options.output, folder.string());
    return 2;
  }
  write_file(options.output, text);
  return 0;
}

// A spec that can be read but not derived.
int refused(const ReadResult& read, const std::string& reason) {
  Diagnostics diagnostics;
  diagnostics.error(read.joint->rows.empty() ? Span{} : read.joint->rows.front().where, reason);
  text::print_messages(stderr, render(*read.file, diagnostics));
  return 2;
}

int run(const Options& options) {
  const SpecsFolder folder(options.specs_folder);
  const ReadResult read = folder.read(folder.find(options.spec));
  text::print_messages(stderr, render(*read.file, read.diagnostics));
  if (!read.joint) return 2;
  if (read.joint->dimension == 2 && options.form != "global") {
    fmt::print(stderr, "cdot explain: --form is for spatial joints: in the plane w is one number, in every form\n");
    return 2;
  }
  try {
    return print(explanation(*read.joint, options), options);
  } catch (const NotLinear& e) {
    return refused(read, e.what());
  } catch (const NumberTooLarge& e) {
    return refused(read, e.what());
  }
}

void add_options(Line& line, Options& options) {
  line.add("SPEC", &options.spec, "A spec, by path or by name; - is standard input").required();
  line.add("--format", &options.format,
           "text; html: a page of its own, with pictures of poses where K is singular; latex: an article")
      .one_of({"text", "html", "latex"})
      .shows_default();
  line.add("--form", &options.form,
           "Form of velocity, in space. global: w in world axes; local: w' in the bodies' axes;\n"
           "euler: the rates of the Euler parameters. J has the same form")
      .one_of({"global", "local", "euler"})
      .shows_default();
  line.add("--json", &options.json, "Every entry as an expression for other programs (see below)")
      .excludes("--format")
      .excludes("--form");
  line.add("-o,--output", &options.output, "File to write instead of the terminal; - is standard output")
      .shown_as("FILE");
  add_specs(line, options.specs_folder);
  line.footer(json_schema);
}

}  // namespace

Run explain_command(Line& line) { return with_options<Options>(line, add_options, run); }

}  // namespace cdot::derive
