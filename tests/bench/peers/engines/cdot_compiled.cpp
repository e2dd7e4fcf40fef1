// Scenes compiled by `cdot compile` and the machine's compiler: alone, and eight mechanisms at a time.
#include <fmt/format.h>
#include <map>
#include <memory>
#include <stdexcept>

#include <cdot/methods.hpp>

#include "runtime/tool/compiled/compiled_scenes.hpp"
#include "tests/bench/peers/geometry.hpp"
#include "tests/bench/peers/problem.hpp"

namespace cdot::peers {
namespace {

// Of a problem that is a scene of the project.
const CompiledScenes& compiled(const Problem& problem) {
  static std::map<std::string, std::unique_ptr<CompiledScenes>> all;
  std::unique_ptr<CompiledScenes>& made = all[problem.scene];
  if (made) return *made;
  std::vector<Way> ways = compiled_ways();
  const SceneCompiler compiler{CDOT_COMPILE, CDOT_SOURCE_DIR "/runtime/include"};
  made = std::make_unique<CompiledScenes>(
      read_scene(fmt::format("{}/specs/scenes/{}.toml", CDOT_SOURCE_DIR, problem.scene)), ways, compiler,
      [](const std::string&) {});
  if (!made->left_out().empty()) throw std::runtime_error(problem.name + ": " + made->left_out().front());
  return *made;
}

class CompiledSteps : public SteppedRun {
 public:
  CompiledSteps(const Problem& problem, const Way& way, double h)
      : SteppedRun(h), problem_(problem), run_(compiled(problem), way) {}
  void step(double by) override {
    run_.advance(by);
    stale_ = true;
  }
  State state(int body) const override {
    if (stale_) frame_ = run_.frame(0);
    stale_ = false;
    const BodyState& s = frame_.bodies[std::size_t(problem_.bodies[std::size_t(body)].number)];
    State state{{s.x, s.y, s.z}, {s.e0, s.e1, s.e2, s.e3}, {s.vx, s.vy, s.vz}, {s.wx, s.wy, s.wz}};
    if (problem_.planar) state.q = about_z(s.angle), state.w = {0, 0, s.w};
    return state;
  }

 private:
  const Problem& problem_;
  mutable CompiledRun run_;
  mutable Frame frame_;
  mutable bool stale_ = true;
};

std::vector<Series> series(const Problem& problem, int lanes) {
  std::vector<Series> all;
  if (problem.scene.empty() || problem.reference.empty()) return all;
  for (const Way& way : compiled_ways()) {
    if (way.lanes != lanes) continue;
    const std::string name(name_of(integrators, way.integrator));
    const bool fine = row_of(way.integrator).order > 1;
    all.push_back({name, "integrator = " + name, "h", fine ? fine_steps(problem) : steps(problem),
                   [&problem, way](double h) { return std::make_unique<CompiledSteps>(problem, way, h); }});
  }
  return all;
}

const Registration alone{{"Cdot compiled", CDOT_VERSION, "double", "#8250df", "the scene by `cdot compile`",
                          [](const Problem& problem) { return series(problem, 1); }}};
const Registration in_lanes{{"Cdot compiled in 8 lanes", CDOT_VERSION, "double", "#bf8cff",
                             "eight mechanisms at a time, alike; the time of each",
                             [](const Problem& problem) { return series(problem, 8); }, 8}};

}  // namespace
}  // namespace cdot::peers
