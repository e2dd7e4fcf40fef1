#include "tests/runtime/tool/support.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <sys/wait.h>

#include <cdot/rotation.hpp>

namespace cdot::test {

namespace fs = std::filesystem;

fs::path source_dir() { return CDOT_SOURCE_DIR; }
fs::path scenes_dir() { return source_dir() / "specs" / "scenes"; }

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<fs::path> files_in(const fs::path& folder, const std::string& ending) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ending) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "cdot-XXXXXX").string();
  path_ = ::mkdtemp(name.data());
}

TemporaryFolder::~TemporaryFolder() { fs::remove_all(path_); }

std::vector<std::string> TemporaryFolder::contents() const {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(path_)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

CommandResult run_command(const std::string& command) {
  const TemporaryFolder folder;
  const std::string out = folder / "out", err = folder / "err";
  const int status = std::system(fmt::format("{} >'{}' 2>'{}'", command, out, err).c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(out), read_text(err)};
}

CommandResult cdot_run(const std::string& arguments) {
  return run_command(fmt::format("'{}' {}", CDOT_RUN, arguments));
}

namespace {

std::vector<ReferenceSample> samples_of(const nlohmann::json& json, double until) {
  std::vector<ReferenceSample> samples;
  for (const auto& sample : json["samples"]) {
    if (sample["t"].get<double>() > until) continue;
    ReferenceSample& added = samples.emplace_back(ReferenceSample{sample["t"], {}});
    for (const auto& [name, v] : sample["bodies"].items())
      added.bodies[name] = v.size() == 6 ? BodyState{v[0], v[1], v[2], v[3], v[4], v[5]}
                                         : BodyState{v[0], v[1], 0,    v[7], v[8],  0,     v[2], v[9],
                                                     v[3], v[4], v[5], v[6], v[10], v[11], v[12]};
  }
  return samples;
}

nlohmann::json json_at(const fs::path& path) { return nlohmann::json::parse(read_text(source_dir() / path)); }

}  // namespace

Reference read_reference(const std::string& problem, double until) {
  const auto json = json_at("tests/runtime/tool/run/reference/" + problem + ".json");
  return {json["error_estimate"], samples_of(json, until)};
}

Reference read_reference_of_peers(const std::string& problem) {
  const auto json = json_at("tests/bench/peers/references/" + problem + ".json");
  double accuracy = 0;
  for (const auto& difference : json["routes_differ_by"]) accuracy = std::max(accuracy, difference.get<double>());
  return {accuracy, samples_of(json, std::numeric_limits<double>::infinity())};
}

Apart true_error(const Scene& scene) {
  const std::vector<double> times = equal_times(scene.duration, 20);
  RunOptions options;
  std::vector<Frame> frames;
  options.row = [&](const Frame& frame) { frames.push_back(frame); };
  options.row_times = times;
  std::string warnings;
  simulate(scene, options, warnings);
  const Way exact{.integrator = Integrator::dop853, .adaptive = true};
  const Trajectory reference = trajectory_of(scene, exact, {1, 1e-11}, times);
  Apart worst;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const Apart here = apart(frames[k], reference.frames.at(k), scene.dimension);
    worst.position = std::max(worst.position, here.position), worst.angle = std::max(worst.angle, here.angle);
  }
  return worst;
}

std::vector<fs::path> all_scene_files() {
  std::vector<fs::path> files;
  for (const fs::path& folder : {scenes_dir(), source_dir() / "tests/hard_cases"})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
      if (entry.path().extension() == ".toml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

Scene scene_named(const std::string& name) { return read_scene((scenes_dir() / (name + ".toml")).string()); }

Recorded recorded(const Scene& scene, double seconds_between_rows) {
  Recorded run;
  RunOptions options;
  options.row_times = every(seconds_between_rows, scene.duration);
  options.row = [&](const Frame& frame) { run.rows.push_back(frame); };
  std::string warnings;
  run.result = simulate(scene, options, warnings);
  return run;
}

double largest_apart(const Scene& scene, const std::vector<Frame>& a, const std::vector<Frame>& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, apart(a[k], b[k], scene.dimension).larger());
  return most;
}

std::vector<Frame> run_of(Scene scene, double until, double every_seconds) {
  std::vector<Frame> frames;
  scene.duration = until;
  RunOptions options;
  options.row_times = every(every_seconds, until);
  options.row = [&](const Frame& frame) { frames.push_back(frame); };
  std::string warnings;
  EXPECT_TRUE(simulate(scene, options, warnings).finite);
  EXPECT_EQ(warnings, "");
  return frames;
}

namespace {

// The angle between two orientations; q and -q are the same.
double turn_between(const BodyState& a, const BodyState& b) {
  return spatial::norm(spatial::turn_between(orientation_of(a), orientation_of(b)));
}

}  // namespace

Distance distance_to(const Reference& reference, const Scene& scene) {
  Distance worst;
  std::size_t next = 0;
  RunOptions options;
  for (const ReferenceSample& sample : reference.samples) options.row_times.push_back(sample.time);
  options.row = [&](const Frame& frame) {
    const ReferenceSample& sample = reference.samples[next++];
    for (std::size_t k = 0; k < frame.bodies.size(); ++k) {
      const BodyState &is = frame.bodies[k], &was = sample.bodies.at(scene.bodies[k].name);
      worst.position = std::max(worst.position, std::hypot(is.x - was.x, is.y - was.y, is.z - was.z));
      worst.angle = std::max({worst.angle, std::abs(is.angle - was.angle), turn_between(is, was)});
      worst.velocity = std::max(worst.velocity, std::hypot(is.vx - was.vx, is.vy - was.vy, is.vz - was.vz));
      worst.spin =
          std::max({worst.spin, std::abs(is.w - was.w), std::hypot(is.wx - was.wx, is.wy - was.wy, is.wz - was.wz)});
    }
  };
  Scene run = scene;
  run.duration = reference.samples.back().time;
  std::string warnings;
  const RunResult result = simulate(run, options, warnings);
  EXPECT_TRUE(result.finite);
  EXPECT_EQ(warnings, "");
  EXPECT_EQ(next, reference.samples.size());
  return worst;
}

}  // namespace cdot::test
