// A door on a hinge, a weight on a rod, a ball on a pin: three joints in space, chosen by cdot_use_joints.
#include <cmath>
#include <cstdio>

#include <cdot/world.hpp>

int main() {
  cdot::Settings settings;
  settings.gravity_z = -9.81;
  cdot::SpatialWorld<double> world(settings);
  cdot::SpatialBodyDefinition body;
  body.mass = 1;
  body.inertia = {0.1, 0.1, 0.1, 0, 0, 0};
  body.x = 1;
  const int door = world.add_body(body);
  world.add_joint({"hinge", {world.ground(), door}, {{"pa", {0, 0, 0}}, {"fa", {0, 1, 0}}}, {}});
  body.x = 2;
  const int weight = world.add_body(body);
  world.add_joint({"distance", {door, weight}, {{"pa", {0, 0, 0}}, {"pb", {0, 0, 0}}}, {}});
  body.x = 3;
  const int ball = world.add_body(body);
  world.add_joint({"spherical", {weight, ball}, {{"pa", {0.5, 0, 0}}}, {}});
  for (int step = 0; step < 1000; ++step) world.step(1e-3);
  const double off = world.worst_position_error().value;
  const auto known = cdot::joint_types(cdot::Dimension::spatial).size();
  std::printf("%zu joints known, worst |C| %.1e m, the door is at %.3f m\n", known, off, world.pose(door).z);
  return known == 3 && off < 1e-9 && world.pose(door).z < -0.1 ? 0 : 1;
}
