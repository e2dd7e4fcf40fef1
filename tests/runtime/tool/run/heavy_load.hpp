// A load at the end of a light chain: its transverse oscillations are far too fast for a step of 1/60 s.
#pragma once

#include <numbers>

#include <cdot/world.hpp>

namespace cdot::test {

// Ten rods of 1 m and 1 kg on pins, hanging. Returns the last.
inline int hang_rods(World<double>& world) {
  int above = world.ground();
  for (int link = 0; link < 10; ++link) {
    const int rod = world.add_body({.y = -0.5 - link, .angle = -std::numbers::pi / 2, .mass = 1, .inertia = 1.0 / 12});
    world.add_joint({"revolute", {above, rod}, {{"pa", {link ? 0.5 : 0.0, 0}}, {"pb", {-0.5, 0}}}, {}});
    above = rod;
  }
  return above;
}

// Nine beads of 1 kg, on bars of 1 m.
inline int hang_beads(World<double>& world) {
  int above = world.ground();
  for (int link = 1; link < 10; ++link) {
    const int bead = world.add_body({.y = -double(link), .mass = 1, .inertia = 0.01});
    world.add_joint({"distance", {above, bead}, {{"pa", {0, 0}}, {"pb", {0, 0}}}, {}});
    above = bead;
  }
  return above;
}

// The load [kg] at the end of either chain, 10 m down, kicked aside by 1 m/s. Returns it.
inline int hang_load(World<double>& world, bool beads, double mass) {
  const int above = beads ? hang_beads(world) : hang_rods(world);
  const int load = world.add_body({.y = -10, .vx = 1, .mass = mass});
  world.add_joint({beads ? "distance" : "revolute", {above, load}, {{"pa", {beads ? 0 : 0.5, 0}}, {"pb", {0, 0}}}, {}});
  return load;
}

}  // namespace cdot::test
