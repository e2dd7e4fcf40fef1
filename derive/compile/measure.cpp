#include "derive/compile/measure.hpp"

#include <atomic>
#include <chrono>
#include <fmt/format.h>
#include <fstream>
#include <mutex>
#include <sstream>
#include <thread>

#include "runtime/tool/compiled/compiler.hpp"

namespace cdot::compile {
namespace {

// The states of the whole scene, one after the other.
constexpr const char* whole_program = R"(#include "{0}"
using Scene = cdot::scenes::{1}<double>;
extern "C" void cdot_whole(Scene::Pose* q, Scene::Velocity* v, double& time) {{
  static Scene::State state;
  static bool runs = false;
  if (runs) Scene::step(state);
  else Scene::reset(state);
  runs = true;
  time = state.time;
  for (int i = 0; i < Scene::bodies; ++i) q[i] = state.q[i], v[i] = state.v[i];
}}
)";

// A step of a variant from each of them.
constexpr const char* variant_program = R"(#include "{0}"
using Scene = cdot::scenes::{1}<double>;
extern "C" void cdot_whole(Scene::Pose* q, Scene::Velocity* v, double& time);
extern "C" __attribute__((noinline)) void cdot_begin(Scene::State& state) {{ Scene::begin(state); }}
extern "C" __attribute__((noinline)) void cdot_step(Scene::State& state) {{ Scene::step(state); }}
int main() {{
  static Scene::State state;
  Scene::Pose q[Scene::bodies];
  Scene::Velocity v[Scene::bodies];
  for (int k = 0; k < {2}; ++k) {{
    cdot_whole(q, v, state.time);
    for (int i = 0; i < Scene::bodies; ++i) state.q[i] = q[i], state.v[i] = v[i];
    cdot_begin(state);
    cdot_step(state);
  }}
}}
)";

class Bench {
 public:
  Bench() : compiles_(has_program(compiler_) && has_program("size")), counts_(compiles_ && has_program("valgrind")) {}
  bool compiles() const { return compiles_; }
  bool counts() const { return counts_; }
  const std::string& compiler() const { return compiler_; }

  // `error` gets the first complaint of the compiler. Its struct gets a name of its own: else the linker would take its
  // functions for those of the variants.
  bool compile_whole(const Source& source, std::string& error) const {
    return compile(source, whole_program, "whole", error, fmt::format("-D{0}=whole_{0}", source.struct_name));
  }

  Measured measure(const Source& source, std::size_t number, std::string& error) const {
    Measured measured;
    if (!compile(source, variant_program, std::to_string(number), error)) return measured;
    const std::string name = folder_.file(std::to_string(number));
    const Ran built =
        shell(fmt::format("{0} {1}.o {2}.o -o {1} && size -A -d {1}.o", compiler_, name, folder_.file("whole")));
    measured.code = bytes_in(built.output);
    if (!counts_) return measured;
    const Ran counted = shell(
        fmt::format("valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect=cdot_step {}", name));
    const std::size_t at = counted.output.find("Collected : ");
    if (at != std::string::npos) measured.instructions = std::stol(counted.output.substr(at + 12)) / measured_steps;
    return measured;
  }

 private:
  bool compile(const Source& source, const char* text, const std::string& file, std::string& error,
               const std::string& option = {}) const {
    const std::string name = folder_.file(file);
    std::ofstream(name + ".hpp") << source.header;
    std::ofstream(name + ".cpp") << fmt::format(fmt::runtime(text), name + ".hpp", source.struct_name, measured_steps);
    const Ran built = shell(
        fmt::format("{0} {1} {3} -ffunction-sections -c {2}.cpp -o {2}.o", compiler_, measured_options, name, option));
    if (!built.well) error = first_line(built.output);
    return built.well;
  }

  // Of the sections of functions and constants, without main() and begin().
  static long bytes_in(const std::string& sizes) {
    std::istringstream lines(sizes);
    long bytes = 0;
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string section;
      long size = 0;
      if (!(words >> section >> size)) continue;
      const bool of_step = section.starts_with(".text") && !section.starts_with(".text.startup") &&
                           section.find("begin") == std::string::npos;
      if (of_step || section.starts_with(".rodata")) bytes += size;
    }
    return bytes;
  }

  std::string compiler_ = compiler_name();
  bool compiles_, counts_;
  ScratchFolder folder_;
};

}  // namespace

std::vector<Measured> measure(const std::vector<Source>& sources, double seconds, std::vector<std::string>& notes) {
  const Bench bench;
  std::vector<Measured> all(sources.size());
  if (!bench.compiles()) {
    notes.push_back("bytes of code and instructions are not measured: " + no_compiler());
    return all;
  }
  if (!bench.counts()) notes.push_back("instructions are not counted: there is no valgrind. Fix: install valgrind");
  using Clock = std::chrono::steady_clock;
  const Clock::time_point end = Clock::now() + std::chrono::milliseconds(static_cast<long>(1000 * seconds));
  std::atomic<std::size_t> next = 0;
  std::mutex of_errors;
  std::string error;
  if (!bench.compile_whole(sources[0], error)) {
    notes.push_back(fmt::format("{} failed: {}", bench.compiler(), error));
    return all;
  }
  const auto work = [&] {
    for (std::size_t k; Clock::now() < end && (k = next++) < all.size();) {
      std::string failure;
      all[k] = bench.measure(sources[k], k, failure);
      const std::lock_guard lock(of_errors);
      if (error.empty()) error = failure;
    }
  };
  std::vector<std::thread> threads;
  for (unsigned t = 0; t < std::max(1u, std::thread::hardware_concurrency()); ++t) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
  if (!error.empty()) notes.push_back(fmt::format("{} failed: {}", bench.compiler(), error));
  if (next < all.size())
    notes.push_back(
        fmt::format("{} of {} variants were not measured within {} s", all.size() - next, all.size(), seconds));
  return all;
}

}  // namespace cdot::compile
