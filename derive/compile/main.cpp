// `cdot-compile`: the command `compile` of `cdot`, in a program of its own. It links the runtime, which is built from
// what `cdot` writes.
#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <stdexcept>

#include "derive/compile/bill.hpp"
#include "derive/compile/header.hpp"
#include "runtime/command_line/command_line.hpp"
#include "runtime/command_line/waiting.hpp"
#include "runtime/text/stage.hpp"
#include "runtime/tool/failure.hpp"
#include "runtime/tool/run/output.hpp"

namespace cdot::compile {
namespace {

using command_line::Line;
using command_line::Run;

struct Options {
  std::string scene, output = "-", specs = "specs", struct_name;
  Wishes wishes;
  bool bill = false, json = false;
};

// The command that writes the same header.
std::string command_of(const Options& options) {
  std::string command = "cdot compile " + std::filesystem::path(options.scene).filename().string();
  if (!options.wishes.integrator.empty()) command += " --integrator " + options.wishes.integrator;
  if (!options.wishes.drift.empty()) command += " --drift " + options.wishes.drift;
  if (options.wishes.step > 0) command += fmt::format(" --step {}", options.wishes.step);
  for (const std::string& input : options.wishes.inputs)
    command += (input == options.wishes.inputs.front() ? " --input " : ",") + input;
  if (options.wishes.plain) command += " --no-foresight";
  if (!options.struct_name.empty()) command += " --name " + options.struct_name;
  return command;
}

std::string compiled(const Options& options) {
  const command_line::Waiting waiting("cdot compile " + std::filesystem::path(options.scene).filename().string());
  const text::Stage reading("reading the scene");
  const Mechanism mechanism = read_mechanism(options.scene, options.wishes);
  for (const std::string& note : mechanism.notes) fmt::print(stderr, "note: {}\n", note);
  const derive::SpecsFolder specs(options.specs);
  if (options.bill) {
    const text::Stage counting("counting what each part costs");
    return bill_of(mechanism, specs, options.json);
  }
  const text::Stage writing("eliminating and sharing");
  return header_of(mechanism, {options.struct_name, command_of(options)}, specs).text;
}

int run(const Options& options) {
  if (options.json && !options.bill)
    throw std::runtime_error("--json prints the bill: a header is no JSON. Fix: give --bill, or leave out --json");
  write_file(options.output, compiled(options));
  return 0;
}

void add_options(Line& line, Options& options) {
  line.add("SCENE", &options.scene, "A scene: a TOML file, the name of one in specs/scenes, or - for standard input")
      .required();
  line.add("-o,--output", &options.output, "File to write; - is standard output").shown_as("FILE");
  line.add("--integrator", &options.wishes.integrator,
           "Method of the step; without it that of the scene, or rk4 if the scene names none")
      .one_of({"euler", "implicit", "rattle", "rk4", "dop853", "radau5"});
  line.add("--drift", &options.wishes.drift,
           "Correction of C; without it that of the scene, or projection: baumgarte and none go with euler")
      .one_of({"projection", "baumgarte", "none"});
  line.add("--step", &options.wishes.step, "Its usual length [s]; without it that of the scene, or 0.001").positive();
  line.add("--input", &options.wishes.inputs,
           "A number that a run may change, as hinge.angle.motor.speed: a member of State::p. Several are separated by "
           "commas")
      .separated_by_commas();
  line.add("--no-foresight", &options.wishes.plain,
           "By euler and rattle: smaller code that projects onto C = 0 in more rounds, from where the step ends");
  line.add("--name", &options.struct_name, "Name of the struct; without it that of the file").shown_as("NAME");
  line.add("--bill", &options.bill,
           "Instead of the header: what each joint and effect costs in a step, and what dropping it saves");
  line.add("--json", &options.json, "With --bill: print JSON");
  line.add("--specs", &options.specs, "Folder of specs").shown_as("DIR").shows_default();
}

Run compile_command(Line& line) { return command_line::with_options<Options>(line, add_options, run); }

constexpr command_line::Command commands[] = {
    {"compile", "Write a scene as its own step: a C++ header of straight lines", compile_command}};
constexpr command_line::Program program = {
    "cdot", "A scene as a C++ header, which includes at most <cmath>",
    "Exit status: 0 all well; 2 bad usage or input, or a scene that cannot be compiled: each part is shown with its "
    "line."};

}  // namespace
}  // namespace cdot::compile

int main(int argc, char** argv) {
  try {
    return run(cdot::compile::program, cdot::compile::commands, argc, argv);
  } catch (const std::exception&) {
    return cdot::report_failure("cdot compile");
  }
}
