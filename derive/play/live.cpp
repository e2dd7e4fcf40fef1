// A scene -> a World that runs while a person looks, in either space.
#include "derive/play/live.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>

#include <cdot/methods.hpp>
#include <cdot/recommended.hpp>

#include "derive/language/specs_folder.hpp"
#include "derive/play/describe.hpp"
#include "derive/play/spec.hpp"
#include "runtime/tool/scene/scene.hpp"
#include "runtime/tool/watch/sensors.hpp"

namespace cdot::play {
namespace {

using nlohmann::json;

constexpr double start_projected = 1e-10;   // [m], [rad]: of the projection of a start
constexpr double start_tolerance = 1e-6;    // above which a start is reported as inconsistent
constexpr double usual_rate = 240;          // [1/s] steps, where neither the scene nor the person says
constexpr double most_of_a_request = 0.05;  // [s] of simulated time per request `step`
constexpr int finer = 8;                    // steps of the run beside it, per step, that shows the error
constexpr double pull = 6;                  // [rad/s] at which the pointer's spring would swing the whole mechanism

// The scene with the person's wishes.
Scene with_wishes(Scene scene, const json& wishes) {
  const std::string method = wishes.value("method", "");
  if (method != "") {
    const auto row = std::find_if(integrator_rows.begin(), integrator_rows.end(),
                                  [&](const IntegratorRow& one) { return one.name == method; });
    if (row == integrator_rows.end()) throw Error(fmt::format("there is no method \"{}\"", method));
    scene.settings = {.gravity_x = scene.settings.gravity_x,
                      .gravity_y = scene.settings.gravity_y,
                      .gravity_z = scene.settings.gravity_z};
    scene.settings.integrator = row->integrator, scene.names_integrator = true;
  }
  if (wishes.contains("gravity")) {
    const auto g = wishes.at("gravity").get<std::array<double, 3>>();
    scene.settings.gravity_x = g[0], scene.settings.gravity_y = g[1], scene.settings.gravity_z = g[2];
  }
  scene.settings.local_error = 0;
  scene.step = 1 / std::clamp(wishes.value("rate", scene.step > 0 ? 1 / scene.step : usual_rate), 10.0, 100000.0);
  return scene;
}

template <class S>
class LiveSceneIn final : public LiveScene {
 public:
  LiveSceneIn(Scene scene, const json& wishes) : scene_(std::move(scene)) {
    measures_ = wishes.value("measure", false);
    start(with_wishes(scene_, wishes));
    warnings_ += inconsistency_report(scene_, *world_, start_tolerance);
  }

  json description() const override {
    json d = description_of(scene_, *world_);
    d["warnings"] = warnings_, d["method"] = name_of(integrators, world_->settings().integrator);
    d["why"] = why_, d["rate"] = 1 / step_, d["state"] = const_cast<LiveSceneIn*>(this)->state();
    return d;
  }

  json state() override {
    json bodies = json::array();
    for (int body = 0; body < std::ssize(scene_.bodies); ++body)
      for (const double number : numbers_of(world_->place(body))) bodies.push_back(number);
    const WorstError worst = world_->worst_position_error();
    json broken = json::array();
    for (int joint = 0; joint < std::ssize(scene_.joints); ++joint)
      if (world_->broken(joint)) broken.push_back(joint);
    return {{"time", time_before_ + world_->time()},
            {"bodies", bodies},
            {"energy", world_->energy()},
            {"error", worst.value},
            {"worst", worst.joint},
            {"sensors", sensor_values(scene_, *world_, accelerations_)},
            {"broken", broken},
            {"forces", forces()},
            {"cpu", cpu_},
            {"failed", failed_},
            {"off", finer_ ? json(off()) : json()}};
  }

  json step(double time) override {
    due_ += std::clamp(time, 0.0, most_of_a_request);
    const auto before = std::chrono::steady_clock::now();
    const double from = world_->time();
    while (due_ > 0.5 * step_ && failed_.empty()) {
      due_ -= step_;
      add_velocities(-1);
      if (const StepResult result = world_->step(step_); !result) failed_ = failure_text(scene_, result);
      add_velocities(1);
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - before;
    if (world_->time() > from) cpu_ = took.count() / (world_->time() - from);
    for (const double end = world_->time() - 0.5 * step_ / finer; finer_ && finer_->time() < end;)
      if (!finer_->step(step_ / finer)) finer_ = nullptr;
    return state();
  }

  void change(const json& wishes) override {
    const BasicWorld<S> old = std::move(*world_);
    const double time = time_before_ + old.time();
    const int hand = hand_joint_;
    measures_ = wishes.value("measure", false);
    start(with_wishes(scene_, wishes));
    in_each([&](BasicWorld<S>& world) {
      for (int body = 0; body < std::ssize(scene_.bodies); ++body) {
        world.set_pose(body, old.place(body));
        const typename S::Exact::Velocity velocity = old.velocity(body);
        world.set_velocity(body, velocity);
      }
    });
    time_before_ = time;
    if (hand >= 0) drag(last_drag_);
  }

  void drag(const json& request) override {
    const int body = request.at("body");
    if (body < 0 || body >= std::ssize(scene_.bodies) || world_->is_static(body)) return;
    const auto local = request.at("local").get<Vec3>(), target = request.at("target").get<Vec3>();
    const bool same = hand_joint_ >= 0 && last_drag_.at("body") == request.at("body") &&
                      last_drag_.at("local") == request.at("local");
    last_drag_ = request;
    if (same)
      return in_each([&](BasicWorld<S>& world) {
        world.set_parameters(hand_joint_, {{"pa", {target.begin(), target.begin() + dimensions}}});
      });
    drop();
    const double stiffness = request.value("stiffness", 1.0) * mass_ * pull * pull;
    JointDefinition spring{.type = dimensions == 2 ? "revolute" : "spherical",
                           .bodies = {world_->ground(), body},
                           .parameters = {{"pa", {target.begin(), target.begin() + dimensions}},
                                          {"pb", {local.begin(), local.begin() + dimensions}}},
                           .soft = Softness{.by_frequency = false, .stiffness = stiffness, .damping = mass_ * pull}};
    in_each([&](BasicWorld<S>& world) { hand_joint_ = world.add_joint(spring); });
  }

  void drop() override {
    if (hand_joint_ >= 0) in_each([&](BasicWorld<S>& world) { world.remove_joint(hand_joint_); });
    hand_joint_ = -1;
  }

  void set_parameter(const json& request) override {
    in_each([&](BasicWorld<S>& world) {
      world.set_parameters(request.at("joint").get<int>(), {{request.at("name"), request.at("numbers")}});
    });
  }

  void set_motor(const json& request) override {
    in_each([&](BasicWorld<S>& world) {
      set_effect(world, request.at("joint").get<int>(), request.at("effect").get<int>(),
                 Motor{request.at("speed").get<double>(), request.value("max", unlimited)});
    });
  }

  json marks(const json& request) override {
    const int joint = request.at("joint");
    if (joint < 0 || joint >= std::ssize(scene_.joints)) throw Error("there is no such joint");
    JointPose pose{{}, world_->joint_parameters(joint), world_->time(), {}};
    for (const int body : world_->joint_bodies(joint)) {
      pose.bodies.push_back(sample_of(world_->place(body)));
      pose.forces.push_back(world_->is_static(body) ? derive::Triple<double>{}
                                                    : force_of(world_->reaction(joint, body)));
    }
    return marks_of_spec(spec_of(world_->joint_type(joint)), pose);
  }

 private:
  using Place = typename S::Place;
  static constexpr int dimensions = S::dimension == Dimension::planar ? 2 : 3;

  // In the World that is shown, and in the one beside it.
  template <class Do>
  void in_each(Do change) {
    change(*world_);
    if (finer_) change(*finer_);
  }

  // The largest distance of a body from its place in the run with shorter steps [m].
  double off() const {
    double most = 0;
    for (int body = 0; body < std::ssize(scene_.bodies); ++body) {
      const std::vector<double> here = numbers_of(world_->place(body)), there = numbers_of(finer_->place(body));
      double square = 0;
      for (std::size_t k = 0; k < static_cast<std::size_t>(dimensions); ++k)
        square += (here[k] - there[k]) * (here[k] - there[k]);
      most = std::max(most, std::sqrt(square));
    }
    return most;
  }

  void start(const Scene& scene) {
    step_ = scene.step, due_ = 0, failed_.clear(), hand_joint_ = -1, time_before_ = 0;
    world_ = std::make_unique<BasicWorld<S>>(build_world_in<S>(scene));
    if (scene.project) world_->project(start_projected);
    if (!scene.names_integrator) {
      const Recommendation found =
          recommended(*world_, step_, [&](int b) { return scene.bodies.at(std::size_t(b)).name; });
      world_->use(found.settings), why_ = found.reason;
    }
    finer_ = measures_ ? std::make_unique<BasicWorld<S>>(build_world_in<S>(scene)) : nullptr;
    if (finer_) {
      if (scene.project) finer_->project(start_projected);
      finer_->use(world_->settings());
    }
    in_each([](BasicWorld<S>& world) { world.ground(); });
    accelerations_.assign(scene.bodies.size(), {});
    mass_ = 0;
    for (int body = 0; body < std::ssize(scene.bodies); ++body)
      if (!world_->is_static(body)) mass_ += 1 / double(world_->inverse_mass(body).m);
  }

  // Of each joint on its first movable body [N].
  json forces() const {
    json all = json::array();
    for (int joint = 0; joint < std::ssize(scene_.joints); ++joint) {
      double force = 0;
      for (const int body : world_->joint_bodies(joint)) {
        if (world_->is_static(body)) continue;
        force = size_of(world_->reaction(joint, body));
        break;
      }
      all.push_back(force);
    }
    return all;
  }
  static derive::Triple<double> force_of(const planar::Wrench& w) { return {w.force_x, w.force_y, 0}; }
  static derive::Triple<double> force_of(const spatial::Wrench& w) { return {w.force_x, w.force_y, w.force_z}; }
  static double size_of(const planar::Wrench& w) { return std::hypot(w.force_x, w.force_y); }
  static double size_of(const spatial::Wrench& w) { return std::hypot(w.force_x, w.force_y, w.force_z); }

  // Of the last step: velocities after it (sign 1), less those before it (-1), by its length.
  void add_velocities(int sign) {
    if (scene_.sensors.empty()) return;
    for (std::size_t body = 0; body < scene_.bodies.size(); ++body) {
      double v[S::freedom];
      S::InDoubles::write(world_->velocity(static_cast<int>(body)), v);
      std::array<double, 6>& a = accelerations_[body];
      if (sign < 0) a = {};
      for (int k = 0; k < S::freedom; ++k)
        a[static_cast<std::size_t>(k < dimensions ? k : k - dimensions + 3)] += sign * v[k] / step_;
    }
  }

  // The file of a joint's spec; "line#2" is another state of line.joint.
  static std::string spec_of(const JointType& type) {
    const std::string name(type.name.substr(0, type.name.find('#')));
    const std::string space = S::dimension == Dimension::planar ? "planar/" : "spatial/";
    return derive::SpecsFolder().find(space + name).string();
  }

  static derive::Sample::Body sample_of(const Place& place) {
    derive::Sample::Body body;
    if constexpr (S::dimension == Dimension::planar) {
      body.x = {place.x, place.y, 0}, body.theta = place.angle;
    } else {
      body.x = {place.x, place.y, place.z}, body.e = {place.e0, place.e1, place.e2, place.e3};
    }
    return body;
  }

  Scene scene_;
  std::unique_ptr<BasicWorld<S>> world_;
  std::unique_ptr<BasicWorld<S>> finer_;  // the same with shorter steps, if the error is measured
  bool measures_ = false;
  std::string warnings_, why_, failed_;
  double step_ = 1 / usual_rate, due_ = 0, cpu_ = 0, mass_ = 0, time_before_ = 0;
  int hand_joint_ = -1;  // the pointer's spring
  Accelerations accelerations_;
  json last_drag_;
};

}  // namespace

std::unique_ptr<LiveScene> LiveScene::load(const std::string& path, const json& wishes) {
  Scene scene = read_scene(path);
  return in_space_of<double>(scene, [&]<class S>(S) -> std::unique_ptr<LiveScene> {
    return std::make_unique<LiveSceneIn<S>>(std::move(scene), wishes);
  });
}

}  // namespace cdot::play
