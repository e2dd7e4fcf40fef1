// `cdot-play`: the command `play` of `cdot`, in a program of its own: a scene -> a page where it moves.
#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <spawn.h>
#include <thread>
#include <unistd.h>

#include "derive/language/specs_folder.hpp"
#include "derive/play/page.hpp"
#include "derive/play/server/native_engine.hpp"
#include "derive/play/server/serve.hpp"
#include "runtime/command_line/command_line.hpp"
#include "runtime/command_line/installation.hpp"
#include "runtime/command_line/waiting.hpp"
#include "runtime/text/stage.hpp"
#include "runtime/tool/failure.hpp"
#include "runtime/tool/run/output.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot::play {
namespace {

namespace fs = std::filesystem;
using command_line::Line;
using command_line::Run;

struct Options {
  std::string start, output, specs = "specs", engine;
  int port = 8060;
  bool no_browser = false;
};

// Where the build, or an installation, keeps the engine.
fs::path engine_of(const Options& options) {
  if (!options.engine.empty()) return options.engine;
  if (const fs::path installed = command_line::installed("playground"); !installed.empty()) return installed;
  return command_line::own_folder().parent_path() / "playground";
}

fs::path own_program() { return fs::read_symlink("/proc/self/exe"); }

int write_page(const Options& options, const std::string& start) {
  const std::string page = [&] {
    const command_line::Waiting waiting("cdot play");
    const text::Stage stage("deriving what the page begins with");
    return playground_page(start, options.specs, engine_of(options));
  }();
  write_file(options.output, page);
  fmt::print("file://{}\n", fs::absolute(options.output).lexically_normal().string());
  return 0;
}

// By the desktop's own choice, where there is a desktop.
void open_in_browser(std::string address) {
  if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY")) return;
  std::string program = "xdg-open";
  char* const arguments[] = {program.data(), address.data(), nullptr};
  pid_t child;
  posix_spawnp(&child, program.c_str(), nullptr, nullptr, arguments, environ);
}

int serve_page(const Options& options, const std::string& start) {
  // This thread and those that follow leave the signals to the one that waits for them.
  sigset_t ends;
  sigemptyset(&ends), sigaddset(&ends, SIGINT), sigaddset(&ends, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &ends, nullptr);
  const auto server = [&] {
    const command_line::Waiting waiting("cdot play");
    const text::Stage stage("deriving what the page begins with");
    return std::make_unique<PageServer>(start, fs::absolute(options.specs), engine_of(options), own_program(),
                                        options.port);
  }();
  fmt::print("{}\nThe page follows {} on disk. Ctrl-C ends it; -o FILE writes a page that needs no server.\n",
             server->address(), start.empty() ? "the specs" : start);
  std::fflush(stdout);
  if (!options.no_browser) open_in_browser(server->address());
  std::thread waits([&] {
    int signal;
    sigwait(&ends, &signal);
    server->stop();
  });
  server->run();
  waits.join();
  return 0;
}

// A scene, else a spec, by path or name.
std::string file_of_start(const Options& options) {
  if (options.start.empty()) return "";
  try {
    return file_of_scene(options.start);
  } catch (const SceneError& no_scene) {
    try {
      return derive::SpecsFolder(options.specs).find(options.start).string();
    } catch (const derive::NoSuchSpec& no_spec) {
      throw SceneError(fmt::format("{}{}: error: {}\n", no_scene.what(), options.start, no_spec.what()), 1);
    }
  }
}

int run(const Options& options) {
  const std::string start = file_of_start(options);
  return options.output.empty() ? serve_page(options, start) : write_page(options, start);
}

void add_options(Line& line, Options& options) {
  line.add("SCENE|SPEC", &options.start,
           "To begin with: a scene, or a joint or effect in a first scene for it; each by its file or its name");
  line.add("-o,--output", &options.output, "Write the page instead of serving it: one file that needs no server")
      .shown_as("FILE");
  line.add("--port", &options.port, "Where the page is served on 127.0.0.1; if it is taken, or 0, any that is free")
      .shows_default();
  line.add("--no-browser", &options.no_browser, "Do not open the page in the desktop's browser");
  line.add("--engine", &options.engine,
           "Folder of engine.js and engine.wasm, which the target `playground` builds; a served page does without")
      .shown_as("DIR");
  line.add("--specs", &options.specs, "Folder of specs").shown_as("DIR").shows_default();
}

Run play_command(Line& line) { return command_line::with_options<Options>(line, add_options, run); }

// Begun by the requests of a page; not for people.
Run engine_command(Line& line) {
  line.retire();
  return [] { return answer_lines(); };
}

constexpr command_line::Command commands[] = {
    {"play", "Open a page where equation, derivation and moving mechanism are live", play_command},
    {"engine", "Answer the requests of a page", engine_command}};
constexpr command_line::Program program = {
    "cdot", "Equation, derivation and moving mechanism on one page, which computes in the browser",
    "Exit status: 0 all well; 2 bad usage or input, or the engine is not built."};

}  // namespace
}  // namespace cdot::play

int main(int argc, char** argv) {
  try {
    return run(cdot::play::program, cdot::play::commands, argc, argv);
  } catch (const std::exception&) {
    return cdot::report_failure("cdot play");
  }
}
