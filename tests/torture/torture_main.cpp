// Draws and judges mechanisms until stopped; shrinks and saves those that break an invariant.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

#include <cdot/methods.hpp>

#include "tests/torture/advice.hpp"
#include "tests/torture/draw/own_effects.hpp"
#include "tests/torture/draw/scene_text.hpp"
#include "tests/torture/misfit.hpp"
#include "tests/torture/shrink.hpp"
#include "tests/torture/tally.hpp"

namespace cdot::torture {
namespace {

constexpr double slow = 5;  // [s] of CPU time; a mechanism takes some milliseconds

struct Options {
  std::uint64_t seed = 1;
  int count = 1000, every = 0;
  double seconds = 0;
  std::optional<std::uint64_t> swept;
  Wish wish;
  std::string method, keep, save, scene;
  int dimension = 0;
  bool no_bits = false, no_shrink = false, print = false, varying = false, changes = false, forces = false,
       misfit = false, advice = false, hurry = false;

  Asked asked() const {
    Asked asked;
    asked.bits = !no_bits, asked.varying = varying, asked.changes = changes, asked.forces = forces, asked.hurry = hurry;
    asked.swept = swept;
    return asked;
  }
};

// One or more of "direct", "rattle", "float", ...
void read_method(const std::string& method, Wish& wish) {
  std::istringstream words(method);
  for (std::string word; words >> word;) {
    const auto has = [&](const auto& table) {
      const auto names = names_of(table);
      return std::find(names.begin(), names.end(), word) != names.end();
    };
    if (has(solvers)) wish.solver = method_called(solvers, word);
    else if (has(integrators)) wish.integrator = method_called(integrators, word);
    else if (has(precisions)) wish.single = method_called(precisions, word);
    else if (has(drifts)) wish.drift = method_called(drifts, word);
    else throw Error(fmt::format("--method: no solver, integrator, drift correction or precision is called {}", word));
  }
}

std::string told(const Verdict& v) {
  return fmt::format("{}{}{}: {:.3g}, at most {:.3g}, after step {}", v.what, v.detail.empty() ? "" : " of ", v.detail,
                     v.value, v.bound, v.step);
}

Verdict judged(const Options& options, const Scene& scene, const Asked& asked) {
  if (options.advice) return judge_advice(scene);
  return options.misfit ? judge_misfit(scene) : judge(scene, asked);
}

std::vector<std::pair<std::string, std::string>> files_of(const Scene& scene) {
  auto files = tables_of(scene);
  std::ranges::move(own_specs_of(scene), std::back_inserter(files));
  return files;
}

// The scene with its tables and specs, as files of a folder.
void write(const std::string& folder, const std::string& name, const Scene& scene) {
  std::filesystem::create_directories(folder);
  std::ofstream(folder + "/" + name) << text_of(scene);
  for (const auto& [file, content] : files_of(scene)) std::ofstream(folder + "/" + file) << content;
}

// Prints the broken invariant, the shrunk scene and the command that repeats it.
void report(const Options& options, std::uint64_t seed, const Scene& scene, const Verdict& verdict, Asked asked) {
  fmt::print("\nBROKEN {}\n  seed {:#x}, {}\n", told(verdict), seed, way_of(scene));
  std::fflush(stdout);  // shrinking may take a while
  if (options.no_shrink || options.advice) return;
  asked.bits = verdict.what.starts_with("bits");
  Shrunk small = shrink(scene, verdict, [&](const Scene& of) {
    const bool settles = !options.misfit || steps_of(of) == steps_of(scene);
    return settles ? judged(options, of, asked) : Verdict{};
  });
  small.scene.title = fmt::format("seed {:#x}: {}", seed, small.verdict.what);
  const std::string text = text_of(small.scene), name = fmt::format("{:016x}.toml", seed);
  fmt::print("  shrunk in {} tries: {} bodies, {} joints, {} steps: {}\n", small.tries, small.scene.bodies.size(),
             small.scene.joints.size(), steps_of(small.scene), told(small.verdict));
  const std::string how = asked.swept      ? fmt::format(" --sweeps {:#x}", *asked.swept)
                          : options.misfit ? " --misfit"
                                           : "";
  fmt::print(
      "  again: torture --seed {:#x} --count 1 --steps {}; the small one: torture --scene {}{}; cdot-run simulate "
      "{}\n\n{}\n",
      seed, options.wish.steps, name, how, name, text);
  for (const auto& [file, content] : files_of(small.scene)) fmt::print("{}\n{}\n", file, content);
  if (!options.keep.empty()) write(options.keep, name, small.scene);
}

void say(const Verdict& verdict) {
  const char* words[] = {"held", "refused", "limited", "BROKEN"};
  const std::string why = verdict.what.empty() ? "" : ": " + told(verdict);
  fmt::print("{}{}\n", words[static_cast<int>(verdict.outcome)], why);
}

Mechanism drawn(const Options& options, std::uint64_t seed) {
  return options.misfit ? nearly_misfitting(seed, options.wish) : generate(seed, options.wish);
}

int save(const Options& options) {
  for (int k = 0; k < options.count; ++k) {
    const std::uint64_t seed = options.seed + static_cast<std::uint64_t>(k);
    write(options.save, fmt::format("{:016x}.toml", seed), drawn(options, seed).scene);
  }
  return 0;
}

int judge_file(const Options& options) {
  const Scene scene = read_scene(options.scene);
  const Verdict verdict = judged(options, scene, options.asked());
  say(verdict);
  return verdict.broken();
}

int torture(const Options& options) {
  const auto start = std::chrono::steady_clock::now();
  const auto passed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  Tally tally;
  for (int k = 0; options.seconds > 0 ? passed() < options.seconds : k < options.count; ++k) {
    const std::uint64_t seed = options.seed + static_cast<std::uint64_t>(k);
    const Mechanism mechanism = drawn(options, seed);
    if (options.print) fmt::print("{}\n", text_of(mechanism.scene));
    const std::clock_t began = std::clock();
    Asked asked = options.asked();
    Verdict verdict = judged(options, mechanism.scene, asked);
    if (verdict.outcome != Outcome::refused && !verdict.broken() && !options.misfit && !options.advice &&
        !options.wish.late) {  // steps by sweeps pay for what an end lifts
      asked.swept = seed;
      const Verdict by_sweeps = judge(mechanism.scene, asked);
      if (by_sweeps.broken()) verdict = by_sweeps;
      else asked.swept.reset();
    }
    const double took = double(std::clock() - began) / CLOCKS_PER_SEC;
    if (took > slow)
      fmt::print("slow: seed {:#x} took {:.1f} s of CPU time, {}\n", seed, took, way_of(mechanism.scene));
    tally.add(mechanism, verdict);
    if (verdict.broken()) report(options, seed, mechanism.scene, verdict, asked);
    else if (options.count == 1) say(verdict);
    if (k % 100 == 99) fmt::print(stderr, "\r{} mechanisms, {} broken", k + 1, tally.count(Outcome::broken));
    if (options.every > 0 && (k + 1) % options.every == 0) {  // a long run may be stopped at any time
      fmt::print("up to seed {:#x}: {}\n", seed, tally.outcomes());
      std::fflush(stdout);
    }
  }
  fmt::print(stderr, "\r{:60}\r", "");
  if (options.count > 1) fmt::print("{}", tally.text());
  return tally.count(Outcome::broken) > 0;
}

}  // namespace
}  // namespace cdot::torture

int main(int count, char** arguments) {
  using namespace cdot::torture;
  Options options;
  CLI::App app("Random mechanisms, run in all ways, and what must hold of them. Exit 1: an invariant broke.");
  app.add_option("--seed", options.seed, "of the first mechanism; the next has the next");
  app.add_option("--count", options.count, "so many mechanisms");
  app.add_option("--every", options.every, "a line with the counts after so many mechanisms");
  app.add_option("--seconds", options.seconds, "in place of --count");
  app.add_option("--steps", options.wish.steps, "of each");
  app.add_option("--joint", options.wish.joint, "is part of each; of the space where it is known");
  app.add_option("--dimension", options.dimension, "of the space, 2 or 3");
  app.add_option("--method", options.method,
                 "solver, integrator, drift correction, precision: any of them, as in \"direct float\"");
  app.add_option("--keep", options.keep, "a folder for the scenes in which something breaks");
  app.add_option("--save", options.save, "write all scenes to this folder; judge nothing");
  app.add_option("--scene", options.scene, "judge this scene and no other");
  app.add_option("--sweeps", options.swept,
                 "judge steps by sweeps alone, drawn by this seed; each run has one beside the rest");
  app.add_flag("--varying", options.varying, "the lengths of the steps vary");
  app.add_flag("--changes", options.changes, "impulses, forces and the loss of a joint, while running");
  app.add_flag("--forces", options.forces, "a force on each body that is a function of time");
  app.add_flag("--effects", options.wish.effects, "effects of specs, on bodies and on coordinates");
  app.add_flag("--islands", options.wish.islands, "few joints, and effects of specs between the islands");
  app.add_flag("--own", options.wish.own, "effects whose specs are written at random, too");
  app.add_flag("--late", options.wish.late, "ends that begin to hold at a time, where they may be passed");
  app.add_flag("--tables", options.wish.tables, "forces, torques and loads that follow tables with kinks and jumps");
  app.add_flag("--in-time", options.wish.in_time, "numbers of joints and effects follow functions of time");
  app.add_flag("--advice", options.advice, "runs each by cdot-run, and follows its advice; judges nothing else");
  app.add_flag("--misfit", options.misfit, "mechanisms at rest with a joint that is a little off; judges nothing else");
  app.add_flag("--no-bits", options.no_bits, "without repetitions: three times as fast");
  app.add_flag("--hurry", options.hurry, "ends runs that Runge-Kutta left to another method and whose energy is lost");
  app.add_flag("--no-shrink", options.no_shrink);
  app.add_flag("--print", options.print, "every scene");
  CLI11_PARSE(app, count, arguments);
  try {
    read_method(options.method, options.wish);
    if (options.dimension == 2) options.wish.dimension = cdot::Dimension::planar;
    if (options.dimension == 3) options.wish.dimension = cdot::Dimension::spatial;
    if (!options.wish.joint.empty()) {
      const bool planar = cdot::find_joint_type(cdot::Dimension::planar, options.wish.joint) != nullptr;
      const bool spatial = cdot::find_joint_type(cdot::Dimension::spatial, options.wish.joint) != nullptr;
      if (!planar && !spatial) throw cdot::Error("--joint: no joint is called " + options.wish.joint);
      if (planar != spatial) options.wish.dimension = planar ? cdot::Dimension::planar : cdot::Dimension::spatial;
    }
    if (!options.save.empty()) return save(options);
    return options.scene.empty() ? torture(options) : judge_file(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
