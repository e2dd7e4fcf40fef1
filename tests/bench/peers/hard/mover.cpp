#include "tests/bench/peers/hard/mover.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <fmt/format.h>
#include <limits>

#include <cdot/spatial.hpp>

#include "runtime/state/world_data.hpp"
#include "tests/bench/peers/geometry.hpp"
#include "tests/bench/peers/measure.hpp"
#include "tests/bench/peers/problem.hpp"
#include "tests/bench/peers/tree.hpp"
#include "tests/hard_cases/trial.hpp"

namespace cdot::peers {
namespace {

constexpr double beyond_measure = 1e4;                      // largest distance of a body, in sizes of the scene
constexpr std::array accuracies{1e-3, 1e-6};                // accuracies of adaptive methods
constexpr double start_off = 1e-9, float_start_off = 1e-6;  // share of the largest position or speed

template <std::size_t size>
void put(char (&to)[size], const std::string& text) {
  to[text.copy(to, size - 1)] = 0;
}

double size_of(const Problem& problem) {
  double size = 0;
  const Vec3 from = problem.bodies.at(0).start.x;
  for (const Body& body : problem.bodies) size = std::max(size, norm(body.start.x - from));
  for (const Joint& joint : problem.joints) size = std::max(size, norm(joint.anchor - from));
  return size > 0 ? size : 1;
}

// In float only the rounded start of the engine counts, not the reference's start.
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
  // Chooses the sign of the quaternion nearest to the last one.
  const auto last = world.pose(body);
  const double side = last.e0 * s.q[0] + last.e1 * s.q[1] + last.e2 * s.q[2] + last.e3 * s.q[3] < 0 ? -1 : 1;
  world.set_pose(body, {s.x[0], s.x[1], s.x[2], side * s.q[0], side * s.q[1], side * s.q[2], side * s.q[3]});
}

// Adds times, which some engines need to choose steps.
template <class S>
Problem posed(const Scene& scene, const BasicWorld<S>& world) {
  Problem problem = problem_of(scene, world);
  problem.duration = 1;
  problem.times = {1};
  return problem;
}

// Moves one trial. The run starts with the first step, because some engines need its length.
template <class S>
class Stand final : public hard::Mover {
 public:
  Stand(const Asked& asked, Told& told, const Scene& scene, BasicWorld<S>& world)
      : asked_(asked),
        told_(&told),
        scene_(&scene),
        problems_{posed(scene, world)},
        world_(&world),
        parts_(scene.settings.substeps * asked.finer),
        reach_(beyond_measure * size_of(problem())) {
    const std::vector<Setting> all = settings(*asked.engine, problem());
    if (all.empty()) throw CannotSay("knows the plane only");
    if (asked.setting >= int(all.size())) throw NoSuchSetting();
    setting_ = all[std::size_t(asked.setting)];
    say(told, setting_);
    for (const Body& body : problem().bodies) velocities_.push_back(world.velocity(body.number));
    remember_joints();
  }

  void step(double by) override {
    if (run_) {
      follow(by / parts_);
    } else {
      begin(by / parts_);
      check_start(problem(), *run_, asked_.engine->number == "float");
    }
    for (int part = 0; part < parts_; ++part) run_->step(by / parts_);
    WorldData<S>& state = world_->data();
    told_->time = state.time += by;
    for (std::size_t k = 0; k < problem().bodies.size(); ++k) take(int(k), by);
    break_overloaded();
  }

  double force(int joint) const override {
    try {
      return run_->force(joint);
    } catch (const CannotSay&) {
      return std::numeric_limits<double>::quiet_NaN();
    }
  }

  int sleeping_islands() const override {  // all at once, in one island
    if (problem().sleep_after == 0) return 0;
    for (std::size_t k = 0; k < problem().bodies.size(); ++k)
      if (!run_->asleep(int(k))) return 0;
    return 1;
  }

 private:
  const Problem& problem() const { return problems_.back(); }
  using Velocity = typename S::Velocity;

  void begin(double step) { run_ = setting_.series.start(setting_.knob > 0 ? setting_.knob : step); }

  // Applies the World's changes since the last step to the run.
  void follow(double step) {
    if (joints_changed()) {
      problems_.push_back(posed(*scene_, *world_));
      const bool told = tell_joints(problems_[problems_.size() - 2], problem());
      remember_joints();
      if (!told) return start_anew(step);
    }
    for (std::size_t k = 0; k < velocities_.size(); ++k) {
      const Body& body = problem().bodies[k];
      const Vec3 more = linear(world_->velocity(body.number)) - linear(velocities_[k]);
      if (norm(more) > 0) run_->strike(int(k), body.mass * more);
    }
  }

  bool joints_changed() const {
    if (world_->joint_count() != int(parameters_.size())) return true;
    for (const Joint& joint : problem().joints)
      if (world_->broken(joint.number) ||
          world_->joint_parameters(joint.number) != parameters_[std::size_t(joint.number)])
        return true;
    return false;
  }

  // False if the run does not support the change.
  bool tell_joints(const Problem& before, const Problem& now) {
    for (const Joint& joint : before.joints)
      if (world_->broken(joint.number) && !run_->remove(joint.number)) return false;
    for (const Joint& joint : now.joints) {
      if (joint.number >= int(parameters_.size())) {
        if (!run_->add(now, joint)) return false;
      } else if (world_->joint_parameters(joint.number) != parameters_[std::size_t(joint.number)]) {
        if (!run_->change(now, joint)) return false;
      }
    }
    return true;
  }

  // Starts a new run from the present state, in the coordinates of a tree.
  void start_anew(double step) {
    close_tree(problems_.back());
    for (const Setting& setting : settings(*asked_.engine, problem()))
      if (setting.series.name == setting_.series.name) setting_.series.start = setting.series.start;
    begin(step);
  }

  void remember_joints() {
    parameters_.clear();
    for (int k = 0; k < world_->joint_count(); ++k) parameters_.push_back(world_->joint_parameters(k));
  }

  // Joints that carry more than their effects allow.
  void break_overloaded() {
    const std::vector<Bond> bonds = world_->data().bonds;  // of which removed joints take theirs along
    for (const Bond& bond : bonds) {
      if (world_->broken(bond.joint)) continue;
      const double load = run_->force(bond.joint);
      if (bond.distance(bond.parameters.data(), told_->time, load) <= 0) world_->remove_joint(bond.joint);
    }
  }

  static Vec3 linear(const planar::Velocity<double>& v) { return {v.x, v.y, 0}; }
  static Vec3 linear(const spatial::Velocity<double>& v) { return {v.x, v.y, v.z}; }

  void take(int body, double by) {
    const State s = run_->state(body);
    const double gone = norm(s.x - problem().bodies[std::size_t(body)].start.x);
    const double all = gone + norm(s.v) + norm(s.w) + std::fabs(s.q[0] + s.q[1] + s.q[2] + s.q[3]);
    if (!std::isfinite(all) || gone > reach_) throw Exploded{told_->time};
    const int number = problem().bodies[std::size_t(body)].number;
    put(*world_, number, s, by);
    velocities_[std::size_t(body)] = world_->velocity(number);
  }

  Asked asked_;
  Told* told_;
  const Scene* scene_;
  std::deque<Problem> problems_;  // all versions of the problem, because runs and series refer to them
  BasicWorld<S>* world_;
  int parts_;
  double reach_;
  Setting setting_;
  std::unique_ptr<Run> run_;
  std::vector<Velocity> velocities_;             // of its bodies, as last set
  std::vector<std::vector<double>> parameters_;  // of the World's joints, as last passed on
};

template <class S>
std::unique_ptr<hard::Mover> stand(const Asked& asked, Told& told, const Scene& scene, BasicWorld<S>& world) {
  return std::make_unique<Stand<S>>(asked, told, scene, world);
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

void say(Told& told, const Setting& setting) {
  put(told.setting, setting.series.name);
  put(told.changed, setting.series.changed);
}

Problem problem_of(const hard::Case& hard_case) {
  Problem problem;
  struct Started {};
  hard::another_engine = [&](const Scene& scene, hard::AnyWorld& world) -> std::unique_ptr<hard::Mover> {
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
