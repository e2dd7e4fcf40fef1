// `cdot emit`: a joint as a header that makes it one of another engine.
#include <fmt/format.h>
#include <optional>

#include "derive/commands/commands.hpp"
#include "derive/engines/engines.hpp"
#include "derive/pipeline/pipeline.hpp"
#include "runtime/command_line/waiting.hpp"
#include "runtime/text/colour.hpp"

namespace cdot::derive {
namespace {

struct EmitOptions {
  std::string spec, engine, output = "-", specs_folder = "specs";
  bool single_header = false;
};

// The texts of the named file and of the one beside it.
EmittedJoint emitted(const Engine& engine, const Kernel& kernel, const EmitOptions& options) {
  if (options.single_header || options.output == "-") return {"", "", single_header(engine, kernel)};
  return emit_for(engine, kernel);
}

void write_emitted(const EmittedJoint& made, const EmitOptions& options) {
  if (!made.common_name.empty())
    write_file(std::filesystem::path(options.output).parent_path() / made.common_name, made.common);
  write_file(options.output, made.joint);
}

int emit(const EmitOptions& options) {
  const SpecsFolder folder(options.specs_folder);
  const std::filesystem::path spec = folder.find(options.spec);
  const Engine& engine = engine_named(options.engine);
  try {
    std::optional<EmittedJoint> made;
    const Outcome outcome = [&] {
      const command_line::Waiting waiting("cdot emit " + options.spec);
      return derive_spec(spec, folder, ProofRecord(), usual_bounds,
                         [&](const Kernel& kernel) { made = emitted(engine, kernel, options); });
    }();
    if (made) write_emitted(*made, options);
    text::print_messages(stderr, outcome.complaints + outcome.said);
    return outcome.proved ? 0 : command_line::wrong_usage;
  } catch (const CannotEmit& e) {
    fmt::print(stderr, "cdot emit: {}\n", e.what());
    return command_line::wrong_usage;
  }
}

void add_emit_options(Line& line, EmitOptions& options) {
  std::vector<std::string> names;
  std::string list = "Engines:\n";
  for (const Engine& engine : engines()) {
    names.emplace_back(engine.name);
    list += fmt::format("  {:<9} {}\n", engine.name, engine.title);
  }
  line.add("SPEC", &options.spec, "A joint, by path or by name; - is standard input").required();
  line.add("--for", &options.engine, "The engine (see below)").one_of(names).required();
  line.add("--single-header", &options.single_header,
           "All in one file, as on standard output. Else joints share cdot_ENGINE.hpp, written beside FILE");
  line.add("-o,--output", &options.output, "Header to write; - is standard output").shown_as("FILE").shows_default();
  add_specs(line, options.specs_folder);
  line.footer(
      list +
      "The header is C++17, MIT-licensed, and includes <cmath> and the engine alone. It begins with the kernel:\n"
      "C, J, K and their use, proved as by `cdot derive`.");
}

}  // namespace

Run emit_command(Line& line) { return with_options<EmitOptions>(line, add_emit_options, emit); }

}  // namespace cdot::derive
