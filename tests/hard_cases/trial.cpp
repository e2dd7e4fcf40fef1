#include "tests/hard_cases/trial.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cdot/methods.hpp>
#include <cdot/recommended.hpp>

#include "runtime/tool/watch/worst.hpp"

namespace cdot::hard {
namespace {

std::vector<Case>& registered() {
  static std::vector<Case> cases;
  return cases;
}

template <class S>
std::unique_ptr<AnyWorld> started(const Scene& scene, bool chooses) {
  auto any = std::make_unique<AnyWorld>(build_world_in<S>(scene));
  auto& world = std::get<BasicWorld<S>>(*any);
  if (scene.project) world.project(1e-9);
  if (chooses) world.use(recommended(world, scene.step).settings);
  return any;
}

template <class T>
double norm(const std::vector<T>& numbers) {
  double squares = 0;
  for (const double number : numbers) squares += number * number;
  return std::sqrt(squares);
}

double force_norm(const planar::Wrench& w) { return std::hypot(w.force_x, w.force_y); }
double force_norm(const spatial::Wrench& w) { return std::hypot(w.force_x, w.force_y, w.force_z); }

}  // namespace

std::function<std::unique_ptr<Mover>(const Scene&, AnyWorld&)> another_engine;

bool Finding::held() const { return std::isfinite(value) && value <= bound; }

bool Finding::together() const {
  const bool gap = what.starts_with("gap") || what.starts_with("a rope") || what.starts_with("rope off");
  return std::isfinite(value) && (!gap || value <= 10 * bound);
}

Trial::Trial(const std::string& scene_file, const Way& the_way)
    : file(scene_file), way(the_way), scene(read_scene(std::string(CDOT_HARD_CASES) + "/" + scene_file + ".toml")) {
  if (way.chosen) return;
  scene.settings.solver = way.solver;
  scene.settings.integrator = way.integrator;
}

void Trial::start() {
  const bool planar = scene.dimension == Dimension::planar, single = way.single && !another_engine;
  if (planar) world_ = single ? started<Planar<float>>(scene, way.chosen) : started<Planar<double>>(scene, way.chosen);
  else world_ = single ? started<Spatial<float>>(scene, way.chosen) : started<Spatial<double>>(scene, way.chosen);
  if (way.chosen)
    chosen_.insert(
        std::string(name_of(integrators, ask([](const auto& world) { return world.settings().integrator; }))));
  if (another_engine) mover_ = another_engine(scene, *world_);
}

bool Trial::refused(const std::string& why) {
  try {
    start();
  } catch (const std::exception& error) {
    return std::string(error.what()).find(why) != std::string::npos;
  }
  return false;
}

void Trial::step(double by) {
  if (mover_) return mover_->step(by);
  diagnose(by);
  const StepResult result = std::visit([&](auto& world) { return world.step(by); }, *world_);
  if (!result) say(in_words(result, "", ""));
}

void Trial::say(const std::string& what) {
  if (listening_) throw Warned{what};
}

// Diagnoses like `cdot-run simulate`, but at growing intervals, because the lengths of cases differ widely.
void Trial::diagnose(double by) {
  if (!listening_ || ++steps_ < next_diagnosis_) return;
  next_diagnosis_ = steps_ + steps_ / 2 + 1;
  std::vector<WorstOfIsland> worst;
  change([&](auto& world) {
    add_diagnosis(cdot::diagnose(world, by / scene.settings.substeps), world.time(), worst);
    if (world.step_counts().rescued > 0)
      say(fmt::format("{} steps left to an implicit method", world.step_counts().rescued));
  });
  Scene asked = scene;
  asked.step = by, asked.single = way.single;
  for (const Concern& concern : concerns_about(asked, worst, true)) say(concern.what);
}

Watch Trial::run(double seconds, double step_of, const std::function<void()>& each) {
  Watch watch;
  const double by = step_of > 0 ? step_of : scene.step;
  const long steps = std::lround(seconds / by);
  const double start = energy();
  for (long k = 0; k < steps && watch.finite; ++k) {
    step(by);
    const Frame now = frame();
    watch.finite = cdot::finite(now) && std::isfinite(now.worst.value);
    watch.gap = std::max(watch.gap, gap());
    watch.rise = std::max(watch.rise, now.energy - start);
    watch.fall = std::max(watch.fall, start - now.energy);
    for (const BodyState& b : now.bodies) watch.speed = std::max(watch.speed, std::hypot(b.vx, b.vy, b.vz));
    if (each) each();
  }
  if (!watch.finite) watch.gap = watch.rise = watch.fall = watch.speed = finite_only;
  return watch;
}

double Trial::time() const {
  return ask([](const auto& world) { return world.time(); });
}
Frame Trial::frame() const {
  return ask([&](const auto& world) { return frame_of(world, world.time(), static_cast<int>(scene.bodies.size())); });
}
BodyState Trial::body(const std::string& name) const {
  return frame().bodies[static_cast<std::size_t>(body_named(name))];
}
double Trial::energy() const {
  return ask([](const auto& world) { return double(world.energy()); });
}
double Trial::norm_of_error(int joint) const {
  return ask([&](const auto& world) { return norm(world.position_error(joint)); });
}
double Trial::gap() const {
  const WorstError worst = ask([](const auto& world) { return world.worst_position_error(); });
  if (worst.joint < 0) return 0;
  const auto kinds = ask([&](const auto& world) { return world.joint_type(worst.joint).row_kinds; });
  const bool one_sided = std::count(kinds.begin(), kinds.end(), RowKind::inequality) > 0;
  return one_sided ? worst.value : norm_of_error(worst.joint);  // C > 0 is slack
}
double Trial::force(int joint) const {
  if (mover_) return mover_->force(joint);
  return ask([&](const auto& world) { return force_norm(world.reaction(joint, world.joint_bodies(joint).back())); });
}
double Trial::coordinate(int joint, const char* name) const {
  return ask([&](const auto& world) { return double(world.coordinate(joint, name)); });
}
int Trial::sleeping_islands() const {
  if (mover_) return mover_->sleeping_islands();
  return ask([](const auto& world) { return world.sleeping_islands(); });
}
bool Trial::finite() const { return cdot::finite(frame()); }

int Trial::body_named(const std::string& name) const {
  for (std::size_t k = 0; k < scene.bodies.size(); ++k)
    if (scene.bodies[k].name == name) return static_cast<int>(k);
  throw Error("no body " + name);
}
int Trial::joint_named(const std::string& name) const {
  for (std::size_t k = 0; k < scene.joints.size(); ++k)
    if (scene.joints[k].name == name) return static_cast<int>(k);
  throw Error("no joint " + name);
}

void Trial::at_most(const std::string& what, double value, double bound) { at_most(what, value, bound, bound); }
void Trial::at_most(const std::string& what, double value, double bound, double bound_in_float) {
  findings_.push_back({what, value, way.single ? bound_in_float : bound});
}
void Trial::near(const std::string& what, double value, double right, double within) {
  at_most(what, std::abs(value - right), within);
}
void Trial::near(const std::string& what, double value, double right, double within, double within_in_float) {
  at_most(what, std::abs(value - right), within, within_in_float);
}

Register::Register(Case hard_case) { registered().push_back(std::move(hard_case)); }

std::string name_of(const Case& hard_case) {
  std::string name = hard_case.fault + "_" + hard_case.scene;
  if (!hard_case.variant.empty()) name += "_" + hard_case.variant;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == ' ' || c == ','; }, '_');
  return name;
}

std::vector<Case> all_cases() {
  std::vector<Case> cases = registered();
  std::sort(cases.begin(), cases.end(), [](const Case& a, const Case& b) { return name_of(a) < name_of(b); });
  return cases;
}

std::vector<Finding> findings_of(const Case& hard_case, const Way& way, std::string* chosen) {
  try {
    Trial trial(hard_case.fault + "/" + hard_case.scene, way);
    hard_case.run(trial);
    if (chosen) *chosen = fmt::format("{}", fmt::join(trial.chosen(), ", "));
    return trial.findings();
  } catch (const std::exception& error) {
    return {{fmt::format("thrown: {}", error.what()), finite_only, 0}};
  }
}

Verdict verdict_on(const Case& hard_case, const Way& way) {
  Verdict verdict;
  try {
    Trial trial(hard_case.fault + "/" + hard_case.scene, way);
    trial.listen();
    hard_case.run(trial);
    for (const Finding& found : trial.findings()) {
      verdict.together &= found.together();
      if (!found.held()) verdict.off += fmt::format("  {:.60} {:.2e}", found.what, found.value);
    }
    verdict.held = verdict.off.empty();
  } catch (const Trial::Warned& warned) {
    verdict.said = warned.what;
  } catch (const std::exception& error) {
    verdict.said = error.what();
  }
  return verdict;
}

}  // namespace cdot::hard
