// Helpers for tests of scenes: paths, commands, temporary folders, reference trajectories.
#pragma once

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "runtime/tool/run/trajectory.hpp"
#include "runtime/tool/search/simulate.hpp"

namespace cdot::test {

std::filesystem::path source_dir();
std::filesystem::path scenes_dir();
std::string read_text(const std::filesystem::path& path);
// A scene of specs/scenes by its path there without .toml.
Scene scene_named(const std::string& name);
struct Recorded {
  RunResult result;
  std::vector<Frame> rows;
};
Recorded recorded(const Scene& scene, double seconds_between_rows);
// The largest difference of two runs at the same times [m, rad].
double largest_apart(const Scene& scene, const std::vector<Frame>& a, const std::vector<Frame>& b);
// The states of a run at equal intervals.
std::vector<Frame> run_of(Scene scene, double until, double every_seconds);

// The largest distance of a run, at twenty times, from one with dop853 that chooses its steps.
Apart true_error(const Scene& scene);

// Every scene file of specs/scenes and of tests/hard_cases.
std::vector<std::filesystem::path> all_scene_files();

// All files with this ending in a folder, by name.
std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder, const std::string& ending);

class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  std::vector<std::string> contents() const;

 private:
  std::filesystem::path path_;
};

struct CommandResult {
  int status;
  std::string out, err;
};
CommandResult run_command(const std::string& command);
CommandResult cdot_run(const std::string& arguments);

struct ReferenceSample {
  double time;
  std::map<std::string, BodyState> bodies;
};
struct Reference {
  double accuracy;  // the bound that its source states
  std::vector<ReferenceSample> samples;
};
Reference read_reference(const std::string& problem, double until);
// A reference of tests/bench/peers, computed without the runtime's code.
Reference read_reference_of_peers(const std::string& problem);

// The largest differences from the reference over its samples and bodies, in SI units.
struct Distance {
  double position = 0, angle = 0, velocity = 0, spin = 0;
  double largest() const { return std::max({position, angle, velocity, spin}); }
};
Distance distance_to(const Reference& reference, const Scene& scene);

}  // namespace cdot::test
