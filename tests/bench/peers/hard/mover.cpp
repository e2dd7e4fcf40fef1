#include "tests/bench/peers/hard/mover.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "runtime/spatial.hpp"
#include "runtime/world_state.hpp"
#include "tests/bench/peers/geometry.hpp"
#include "tests/bench/peers/measure.hpp"
#include "tests/bench/peers/problem.hpp"
#include "tests/hard_cases/trial.hpp"

namespace cdot::peers {
namespace {

constexpr double beyond_measure = 1e4;                      // sizes of the scene that a body has gone
constexpr std::array accuracies{1e-3, 1e-6};                // of methods that choose their steps
constexpr double start_off = 1e-9, float_start_off = 1e-6;  // of the largest place or speed

template <std::size_t size>
void say(char (&to)[size], const std::string& text) {
  to[text.copy(to, size - 1)] = 0;
}

double size_of(const Problem& problem) {
  double size = 0;
  const Vec3 from = problem.bodies.at(0).start.x;
  for (const Body& body : problem.bodies) size = std::max(size, norm(body.start.x - from));
  for (const Joint& joint : problem.joints) size = std::max(size, norm(joint.anchor - from));
  return size > 0 ? size : 1;
}

// In float the reference counts from where it has to; only what the engine is told can be held against it.
void check_start(const Problem& problem, const Run& run, bool single) {
  double scale = 1;
  for (const Body& body : problem.bodies)
    scale = std::max({scale, norm(body.start.x), norm(body.start.v), norm(body.start.w)});
  const double off = start_error(problem, run) / scale;
  if (!(off <= (single ? float_start_off : start_off)))
    throw std::logic_error(fmt::format("starts off by {:.1e}: the adapter poses another problem", off));
}

void put(World<double>& world, int body, const State& s, double by) {
  const double guess = world.pose(body).angle + s.w[2] * by;
  world.set_velocity(body, {s.v[0], s.v[1], s.w[2]});
  world.set_pose(body, {s.x[0], s.x[1], guess + std::remainder(angle(s.q) - guess, 2 * hard::pi)});
}
void put(SpatialWorld<double>& world, int body, const State& s, double) {
  world.set_velocity(body, {s.v[0], s.v[1], s.v[2], s.w[0], s.w[1], s.w[2]});
  // Of the two quaternions of an orientation, that on the side of the last.
  const auto last = world.pose(body);
  const double side = last.e0 * s.q[0] + last.e1 * s.q[1] + last.e2 * s.q[2] + last.e3 * s.q[3] < 0 ? -1 : 1;
  world.set_pose(body, {s.x[0], s.x[1], s.x[2], side * s.q[0], side * s.q[1], side * s.q[2], side * s.q[3]});
}

// With times for those that choose steps by them.
template <class S>
Problem posed(const Scene& scene, const BasicWorld<S>& world) {
  Problem problem = problem_of(scene, world);
  problem.duration = 1;
  problem.times = {1};
  return problem;
}

// Of one trial. The run starts with the first step, whose length some engines have to know.
template <class S>
class Stand {
 public:
  Stand(const Asked& asked, Told& told, const Scene& scene, BasicWorld<S>& world)
      : asked_(asked),
        told_(&told),
        problem_(std::make_unique<Problem>(posed(scene, world))),
        world_(&world),
        parts_(scene.settings.substeps * asked.finer),
        reach_(beyond_measure * size_of(*problem_)) {
    std::vector<Setting> all = settings(*asked.engine, *problem_);
    if (all.empty()) throw CannotSay("knows the plane only");
    if (asked.setting >= int(all.size())) throw NoSuchSetting();
    setting_ = all[std::size_t(asked.setting)];
    say(told.setting, setting_.series.name);
    say(told.changed, setting_.series.changed);
  }

  void operator()(double by) {
    if (!run_) {
      run_ = setting_.series.start(setting_.knob > 0 ? setting_.knob : by / parts_);
      check_start(*problem_, *run_, asked_.engine->number == "float");
    }
    for (int part = 0; part < parts_; ++part) run_->step(by / parts_);
    WorldState<S>& state = world_->state();
    told_->time = state.time += by;
    for (std::size_t k = 0; k < problem_->bodies.size(); ++k) take(int(k), by);
  }

 private:
  void take(int body, double by) {
    const State s = run_->state(body);
    const double gone = norm(s.x - problem_->bodies[std::size_t(body)].start.x);
    const double all = gone + norm(s.v) + norm(s.w) + std::fabs(s.q[0] + s.q[1] + s.q[2] + s.q[3]);
    if (!std::isfinite(all) || gone > reach_) throw Exploded{told_->time};
    put(*world_, body, s, by);
  }

  Asked asked_;
  Told* told_;
  std::unique_ptr<Problem> problem_;
  BasicWorld<S>* world_;
  int parts_;
  double reach_;
  Setting setting_;
  std::shared_ptr<Run> run_;
};

template <class S>
hard::Mover stand(const Asked& asked, Told& told, const Scene& scene, BasicWorld<S>& world) {
  return [stand = std::make_shared<Stand<S>>(asked, told, scene, world)](double by) { (*stand)(by); };
}

}  // namespace

std::vector<Setting> settings(const Engine& engine, const Problem& problem) {
  std::vector<Setting> all;
  for (const Series& series : engine.series(problem)) {
    if (series.knob == "h") {
      all.push_back({series});
      continue;
    }
    for (const double knob : accuracies) {
      Setting setting{series, knob};
      setting.series.name += fmt::format(", {} {:.0e}", series.knob, knob);
      if (knob != accuracies.front()) setting.series.changed = setting.series.name;
      all.push_back(setting);
    }
  }
  const auto plain = std::find_if(all.begin(), all.end(), [](const Setting& s) { return s.series.changed.empty(); });
  if (plain != all.end()) std::rotate(all.begin(), plain, plain + 1);
  return all;
}

Problem problem_of(const hard::Case& hard_case) {
  Problem problem;
  struct Started {};
  hard::another_engine = [&](const Scene& scene, hard::AnyWorld& world) -> hard::Mover {
    problem = scene.dimension == Dimension::planar ? posed(scene, std::get<World<double>>(world))
                                                   : posed(scene, std::get<SpatialWorld<double>>(world));
    throw Started();
  };
  hard::Trial trial(hard_case.fault + "/" + hard_case.scene, {});
  try {
    hard_case.run(trial);
  } catch (const Started&) {
  }
  hard::another_engine = nullptr;
  return problem;
}

void let_move(const Asked& asked, Told& told) {
  hard::another_engine = [asked, &told](const Scene& scene, hard::AnyWorld& world) {
    if (scene.dimension == Dimension::planar) return stand(asked, told, scene, std::get<World<double>>(world));
    return stand(asked, told, scene, std::get<SpatialWorld<double>>(world));
  };
}

}  // namespace cdot::peers
