#include "tests/torture/draw/generate.hpp"

#include <algorithm>
#include <fmt/format.h>

#include <cdot/methods.hpp>

#include "tests/torture/draw/draw.hpp"
#include "tests/torture/draw/in_time.hpp"
#include "tests/torture/draw/own_effects.hpp"
#include "tests/torture/draw/scene_text.hpp"
#include "tests/torture/draw/spec_effects.hpp"

namespace cdot::torture {
namespace {

// A growing mechanism with its scales of length, rate and mass.
class Growth {
 public:
  Growth(Random& random, const Wish& wish) : random_(random), wish_(wish) {}

  Mechanism grown();

 private:
  template <class S>
  void grow();
  const std::string& any_type();
  void choose_scales();
  void choose_method();
  void add_bodies();
  template <class S>
  bool add_joint(BasicWorld<S>& world, const std::string& type, int child);
  template <class S>
  void add_tree(BasicWorld<S>& world);
  template <class S>
  void add_loops(BasicWorld<S>& world);
  template <class S>
  void settle();
  template <class S>
  bool settled(bool disturbed);
  std::vector<int> bodies_for(const JointType& type, int child);

  Random& random_;
  const Wish& wish_;
  Mechanism made_;
  Scales scales_;
  bool anchored_ = true;
  std::string type_;
};

void Growth::choose_scales() {
  scales_.length = random_.chance(0.6) ? 1 : random_.log_between(1e-3, 1e3);
  scales_.rate = random_.chance(0.6) ? 1 : random_.log_between(1e-2, 1e2);
  scales_.mass = random_.chance(0.5) ? 1 : random_.log_between(1e-6, 1e6);
  scales_.spread = random_.of<double>({1, 10, 10, 1e3, 1e6});
  anchored_ = random_.chance(0.55);
}

// For a freely floating mechanism mostly joints without a connection to the world.
const std::string& Growth::any_type() {
  const auto types = joint_types(made_.scene.dimension);
  const auto holds_the_world = [](const JointType& type) {
    return type.bodies == 1 ||
           std::any_of(type.parameters.begin(), type.parameters.end(),
                       [](const ParameterInfo& info) { return info.body < 0 && info.kind != ParameterKind::scalar; });
  };
  const bool free = !anchored_ && random_.chance(0.9);
  const auto joints = std::count_if(types.begin(), types.end(), [](const JointType& type) { return !type.is_effect; });
  do type_ = types[static_cast<std::size_t>(random_.below(static_cast<int>(joints)))].name;  // effects come last
  while (free && holds_the_world(*find_joint_type(made_.scene.dimension, type_)));
  return type_;
}

void Growth::choose_method() {
  Scene& scene = made_.scene;
  Settings& s = scene.settings;
  s.solver = random_.chance(0.7) ? Solver::direct : Solver::iterative;
  // radau5 only by wish: seeds keep their mechanisms.
  s.integrator = integrators[static_cast<std::size_t>(random_.below(5))].method;
  scene.single = random_.chance(0.4);
  s.solver = wish_.solver.value_or(s.solver);
  s.integrator = wish_.integrator.value_or(s.integrator);
  scene.single = wish_.single.value_or(scene.single);
  if (random_.chance(0.15)) s.drift = random_.chance(0.5) ? Drift::baumgarte : Drift::none;
  if (random_.chance(0.2)) s.substeps = 1 + random_.below(4);
  if (random_.chance(0.3)) s.iterations = 1 + random_.below(30);
  if (random_.chance(0.3)) s.kernels = kernel_forms[static_cast<std::size_t>(random_.below(3))].method;
  if (random_.chance(0.2)) s.warm_start = false;
  if (random_.chance(0.1)) s.sleep_after = random_.between(0.1, 1) / scales_.rate;
  if (random_.chance(0.2) && works_on_accelerations(s.integrator))
    s.local_error = random_.log_between(1e-8, 1e-4) * scales_.length;
  if (random_.chance(0.2)) scene.on_failure = OnFailure::retry;
  // Soft drift only by wish, as radau5.
  s.drift = wish_.drift.value_or(s.drift);
  if (s.drift == Drift::soft) s.solver = Solver::iterative, s.integrator = Integrator::euler, s.local_error = 0;
  if (mistake_in_methods(s)) s.drift = Drift::projection;
  if (mistake_in_methods(s)) s.solver = Solver::direct;
  scene.step = random_.log_between(0.002, 0.1) / scales_.rate;
  scene.duration = wish_.steps * scene.step;
  if (random_.chance(anchored_ ? 0.8 : 0.2)) {
    const double g = scales_.length * scales_.rate * scales_.rate * random_.log_between(0.1, 10);
    const auto direction = random_.in_cube(1, scene.dimension == Dimension::spatial);
    const double length = std::max(1e-3, std::hypot(direction[0], direction[1], direction[2]));
    s.gravity_x = g * direction[0] / length, s.gravity_y = g * direction[1] / length;
    s.gravity_z = g * direction[2] / length;
  }
}

void Growth::add_bodies() {
  const int count = random_.chance(0.9) ? 1 + random_.below(6) : 7 + random_.below(14);
  for (int k = 0; k < count; ++k) {
    SceneBody body = random_body(random_, scales_, made_.scene.dimension);
    body.name = fmt::format("b{}", k + 1);
    if (k > 0 && anchored_ && random_.chance(0.05)) make_static(body);
    made_.scene.bodies.push_back(std::move(body));
  }
}

// The child and earlier bodies, in any order; the world if there are too few.
std::vector<int> Growth::bodies_for(const JointType& type, int child) {
  std::vector<int> others;
  for (int k = 0; k < static_cast<int>(made_.scene.bodies.size()); ++k)
    if (k != child) others.push_back(k);
  for (std::size_t k = 0; k + 1 < others.size(); ++k)
    std::swap(others[k], others[k + static_cast<std::size_t>(random_.below(static_cast<int>(others.size() - k)))]);
  if (anchored_ && (child == 0 || random_.chance(0.15))) others.insert(others.begin(), world_body);
  std::vector<int> bodies{child};
  const auto wanted = static_cast<std::size_t>(type.bodies);
  for (std::size_t k = 0; k < others.size() && bodies.size() < wanted; ++k)
    if (others[k] < child || !anchored_ || others[k] == world_body || bodies.size() + others.size() - k <= wanted)
      bodies.push_back(others[k]);
  while (bodies.size() < wanted) bodies.push_back(world_body);
  if (bodies.size() > 1 && random_.chance(0.5)) std::swap(bodies[0], bodies[1]);
  return bodies;
}

// Adds the joint to the World too, so a refused joint is left out at once.
template <class S>
bool Growth::add_joint(BasicWorld<S>& world, const std::string& type, int child) {
  const JointType& info = *find_joint_type(S::dimension, type);
  if (!anchored_ && type != wish_.joint && info.bodies > static_cast<int>(made_.scene.bodies.size())) return false;
  SceneJoint joint;
  joint.name = fmt::format("j{}", made_.scene.joints.size() + 1);
  joint.definition.type = type;
  joint.definition.bodies = bodies_for(info, child);
  joint.definition.parameters = random_parameters(random_, scales_, info, made_.scene, joint.definition.bodies);
  JointDefinition in_world = joint.definition;
  for (int& body : in_world.bodies) body = body == world_body ? world.ground() : body;
  try {
    const int index = world.add_joint(in_world);
    joint.definition.parameters = all_parameters(info, world.joint_parameters(index));
    loosen(random_, info, joint.definition.parameters);
    made_.scene.joints.push_back(std::move(joint));
    return true;
  } catch (const Error& error) {
    made_.refused.push_back(error.what());
    return false;
  }
}

template <class S>
void Growth::add_tree(BasicWorld<S>& world) {
  const int bodies = static_cast<int>(made_.scene.bodies.size());
  if (!wish_.joint.empty()) add_joint(world, wish_.joint, random_.below(bodies));
  for (int child = 0; child < bodies; ++child)
    if (random_.chance(wish_.islands ? 0.4 : 0.9)) add_joint(world, any_type(), child);
}

// Joints beyond the tree: they close a loop or repeat a joint.
template <class S>
void Growth::add_loops(BasicWorld<S>& world) {
  const int bodies = static_cast<int>(made_.scene.bodies.size());
  if (random_.chance(0.4))
    for (int k = random_.below(1 + bodies / 2); k >= 0; --k) add_joint(world, any_type(), random_.below(bodies));
  if (random_.chance(0.2) && !made_.scene.joints.empty()) {
    SceneJoint copy = random_.of(made_.scene.joints);
    copy.name += "_again";
    made_.scene.joints.push_back(copy);
  }
}

// Disturbs the poses and projects them and the velocities onto all joints. False if the projection fails.
template <class S>
bool Growth::settled(bool disturbed) {
  Scene trial = made_.scene;
  if (disturbed)
    for (SceneBody& body : trial.bodies) disturb(random_, scales_, trial.dimension, body);
  for (SceneBody& body : trial.bodies) set_in_motion(random_, scales_, trial.dimension, body);
  BasicWorld<S> world = build_world_in<S>(trial);
  world.project(1e-12);
  if (!on_joints(world, trial)) return false;
  for (std::size_t k = 0; k < trial.bodies.size(); ++k) take_state(world, static_cast<int>(k), trial.bodies[k]);
  made_.scene = std::move(trial);
  return true;
}

template <class S>
void Growth::settle() {
  const bool disturbed = random_.chance(0.7);
  for (;;) {
    try {
      if ((disturbed && settled<S>(true)) || settled<S>(false) || made_.scene.joints.empty()) return;
    } catch (const SceneError& error) {  // a joint has no direction at the disturbed poses
      made_.refused.push_back(error.what());
    }
    made_.scene.joints.pop_back();
    ++made_.left_out;
  }
}

template <class S>
void Growth::grow() {
  BasicWorld<S> world;
  for (const SceneBody& body : made_.scene.bodies) {
    if constexpr (S::dimension == Dimension::planar) world.add_body(body.definition);
    else world.add_body(body.spatial);
  }
  add_tree(world);
  add_loops(world);
  settle<S>();
  try {
    if (random_.chance(0.4)) add_effects<S>(random_, scales_, made_.scene);
    const int most = wish_.islands ? std::max(3, 2 * static_cast<int>(made_.scene.bodies.size())) : 3;
    const auto add = [&](const EffectTypes& types) {
      add_spec_effects<S>(random_, scales_, types, most, made_.scene, made_.refused);
    };
    if (wish_.effects || wish_.islands) add(effects_of_catalogue(S::dimension));
    if (wish_.own) add(own_effects(random_, S::dimension));
    if (wish_.late) add(late_ends(random_, S::dimension));
    if (wish_.tables) add_tables<S>(random_, scales_, made_.scene, made_.refused);
    if (wish_.in_time) add_numbers_in_time<S>(random_, scales_, made_.scene, made_.refused);
  } catch (const SceneError& error) {  // the World refuses the projected poses, as gears that have turned too far
    made_.refused.push_back(error.what());
  }
}

Mechanism Growth::grown() {
  Scene& scene = made_.scene;
  scene.dimension = random_.chance(0.5) ? Dimension::planar : Dimension::spatial;
  scene.dimension = wish_.dimension.value_or(scene.dimension);
  scene.file = "torture";
  scene.project = true;
  scene.source = std::make_shared<Mistakes>(scene.file, "");
  choose_scales();
  choose_method();
  add_bodies();
  if (scene.dimension == Dimension::planar) grow<Planar<double>>();
  else grow<Spatial<double>>();
  return std::move(made_);
}

}  // namespace

Mechanism generate(std::uint64_t seed, const Wish& wish) {
  Random random(seed);
  Mechanism mechanism = Growth(random, wish).grown();
  plain_zeros(mechanism.scene);
  mechanism.scene.title = fmt::format("seed {:#x}", seed);
  return mechanism;
}

}  // namespace cdot::torture
