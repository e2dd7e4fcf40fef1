// Steps of varying lengths, and what acts from outside while a mechanism runs.
#pragma once

#include <cmath>
#include <numbers>

#include "runtime/tool/scene/scene.hpp"

namespace cdot::torture {

// The share of the scene's step that step k takes: between 0.2 and 1, spread evenly by the golden ratio.
inline double share_of_step(int k) {
  const double turns = 0.6180339887498949 * k;
  return 0.2 + 0.8 * (turns - std::floor(turns));
}

inline double mass_of(const Scene& scene, const SceneBody& body) {
  return scene.dimension == Dimension::planar ? body.definition.mass : body.spatial.mass;
}

// Step k of a run, and the size of its mechanism [m].
struct At {
  int k, steps;
  double length;
};

// Every ninth step pushes a body, first at once, then for good; a third of the way takes the last joint away.
template <class S>
void change(BasicWorld<S>& world, const Scene& scene, const At& at) {
  if (at.k == at.steps / 3 && !scene.joints.empty()) world.remove_joint(static_cast<int>(scene.joints.size()) - 1);
  if (at.k % 9 != 4) return;
  const int body = at.k % static_cast<int>(scene.bodies.size());
  if (world.is_static(body)) return;
  const double impulse = 0.1 * at.length / scene.duration / double(world.inverse_mass(body).m);
  if (at.k % 2 == 0) {
    typename S::Exact::Velocity shove{};
    shove.x = impulse, shove.y = -impulse;
    world.apply_impulse(body, shove);
  } else {
    typename S::Wrench force{};
    force.force_x = -impulse / scene.duration, force.force_y = impulse / scene.duration;
    world.set_force(body, force);
  }
}

// Moves the body alone by ten sizes of its mechanism in the time of the run [N].
inline double largest_force(const Scene& scene, const SceneBody& body, double length) {
  return 20 * mass_of(scene, body) * length / (scene.duration * scene.duration);
}

// Forces that turn once about in the run, each in a direction of its own, and constant in a step.
template <class S>
void push_in_time(BasicWorld<S>& world, const Scene& scene, const At& at) {
  for (int body = 0; body < static_cast<int>(scene.bodies.size()); ++body) {
    if (world.is_static(body)) continue;
    const double size = largest_force(scene, scene.bodies[static_cast<std::size_t>(body)], at.length);
    const double angle = 2 * std::numbers::pi * at.k / at.steps + body;
    typename S::Wrench force{};
    force.force_x = size * std::cos(angle), force.force_y = size * std::sin(angle);
    world.set_force(body, force);
  }
}

// The scene with forces as large as those of push_in_time() ever get.
inline Scene under_largest_forces(Scene scene, double length) {
  for (SceneBody& body : scene.bodies)
    body.definition.force_x = body.spatial.force_x = largest_force(scene, body, length);
  return scene;
}

}  // namespace cdot::torture
