// The parts of random mechanisms: bodies, parameters of joints, effects. Kind and unit of a parameter determine its
// values; no code depends on a joint's name.
#pragma once

#include "runtime/tool/scene/scene.hpp"
#include "tests/torture/draw/random.hpp"

namespace cdot::torture {

// The units of all random numbers.
struct Scales {
  double length = 1, rate = 1, mass = 1;  // [m], [1/s], [kg]
  double spread = 1;                      // of masses: factor up and down
};

SceneBody random_body(Random& random, const Scales& scales, Dimension dimension);
void make_static(SceneBody& body);
// Moves and rotates a body a little.
void disturb(Random& random, const Scales& scales, Dimension dimension, SceneBody& body);
void set_in_motion(Random& random, const Scales& scales, Dimension dimension, SceneBody& body);

// Parameters without a default, and sometimes one with a default.
std::vector<NamedValue> random_parameters(Random& random, const Scales& scales, const JointType& type,
                                          const Scene& scene, const std::vector<int>& bodies);
// All parameters of a World's joint as numbers, independent of the poses; frames in space by two axes.
std::vector<NamedValue> all_parameters(const JointType& type, const std::vector<double>& numbers);
// Gives a rope some slack.
void loosen(Random& random, const JointType& type, std::vector<NamedValue>& parameters);

// Copies a body's pose and velocity from the World to the scene.
template <class S>
void take_state(const BasicWorld<S>& world, int index, SceneBody& body);
template <class S>
bool on_joints(BasicWorld<S>& world, const Scene& scene);

// Motors, limits, springs, friction, soft joints, forces, damping.
template <class S>
void add_effects(Random& random, const Scales& scales, Scene& scene);

}  // namespace cdot::torture
