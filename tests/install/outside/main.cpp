// A pendulum on a shipped joint, a bead on this project's own joint; both conserve energy and keep C = 0.
#include <cmath>
#include <cstdio>

#include <cdot/planar/ellipse.hpp>
#include <cdot/planar/revolute.hpp>
#include <cdot/world.hpp>

int main() {
  static_assert(cdot::planar::ellipse::rows == 2 && cdot::planar::revolute::rows == 2);
  cdot::Settings settings;
  settings.gravity_y = -9.81;
  cdot::World<double> world(settings);
  cdot::BodyDefinition body;
  body.mass = 1;
  body.inertia = 0.1;
  body.x = 1;
  const int pendulum = world.add_body(body);
  world.add_joint({"revolute", {world.ground(), pendulum}, {{"pa", {0, 0}}, {"pb", {-1, 0}}}, {}});
  body.x = 2;
  const int bead = world.add_body(body);
  const int on = world.add_joint(
      {"ellipse", {bead, world.ground()}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {1, 0}}, {"l", {2}}}, {}});
  const double energy = world.energy();
  double lowest = 0;
  for (int step = 0; step < 5000; ++step) {
    world.step(2e-4);
    lowest = std::fmin(lowest, world.pose(bead).y);
  }
  const double drift = std::fabs(world.energy() - energy), off = world.worst_position_error().value;
  std::printf("worst |C| %.1e m, energy off by %.1e J, the bead went down to %.3f m, along %.3f m\n", off, drift,
              lowest, world.coordinate(on, "along"));
  const bool found = cdot::find_joint_type(cdot::Dimension::planar, "ellipse") != nullptr;
  return found && off < 1e-9 && drift < 0.05 && lowest < -0.5 ? 0 : 1;
}
