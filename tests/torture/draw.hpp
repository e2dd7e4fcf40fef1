// The parts of random mechanisms: bodies, parameters of joints, effects. Nothing here knows a joint by name: what a
// parameter may be is told by its kind and unit.
#pragma once

#include "runtime/tool/scene/scene.hpp"
#include "tests/torture/random.hpp"

namespace cdot::torture {

// Everything is drawn in these units.
struct Scales {
  double length = 1, rate = 1, mass = 1;  // [m], [1/s], [kg]
  double spread = 1;                      // of masses: up to so many times more or less
};

SceneBody random_body(Random& random, const Scales& scales, Dimension dimension);
void make_static(SceneBody& body);
// Moves and turns it a little.
void disturb(Random& random, const Scales& scales, Dimension dimension, SceneBody& body);
void set_in_motion(Random& random, const Scales& scales, Dimension dimension, SceneBody& body);

// Those that have no default, and now and then one that has.
std::vector<NamedValue> random_parameters(Random& random, const Scales& scales, const JointType& type,
                                          const Scene& scene, const std::vector<int>& bodies);
// All numbers of a joint of a World, so that they no longer depend on the poses; frames in space by two axes.
std::vector<NamedValue> all_parameters(const JointType& type, const std::vector<double>& numbers);
// Gives a rope some slack.
void loosen(Random& random, const JointType& type, std::vector<NamedValue>& parameters);

// A body's pose and velocity become those that it has in the World.
template <class S>
void take_state(const BasicWorld<S>& world, int index, SceneBody& body);
template <class S>
bool on_joints(BasicWorld<S>& world, const Scene& scene);

// Motors, limits, springs, friction, soft joints, forces, damping.
template <class S>
void add_effects(Random& random, const Scales& scales, Scene& scene);

}  // namespace cdot::torture
