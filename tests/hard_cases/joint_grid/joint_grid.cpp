// Almost twice as many pins as bodies, so as many independent loops as bodies.
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::joint_grid {
namespace {

void add_pin(Trial& t, int a, int b, double dx, double dy) {
  SceneJoint joint;
  joint.definition = {"revolute", {a, b}, {{"pa", {dx / 2, dy / 2}}, {"pb", {-dx / 2, -dy / 2}}}, {}};
  t.scene.joints.push_back(joint);
}

void build(Trial& t, int n) {
  const SceneBody disc_of_scene = t.scene.bodies[0];
  t.scene.bodies.clear();
  for (int k = 0; k < n * n; ++k) {
    SceneBody disc = disc_of_scene;
    const int row = k / n, column = k % n;
    disc.is_static = row == 0 && std::abs(column - n / 2) <= 3;
    disc.definition.x = column;
    disc.definition.y = -row;
    disc.definition.is_static = disc.is_static;
    t.scene.bodies.push_back(disc);
    if (column > 0) add_pin(t, k - 1, k, 1, 0);
    if (row > 0) add_pin(t, k - n, k, 0, -1);
  }
}

void hang(Trial& t, int n, int steps) {
  build(t, n);
  t.start();
  const Watch w = t.run(steps * h);
  t.at_most("gap [m]", w.gap, 1e-2);
}
// 5 s of a small grid, and a few CPU seconds of the whole grid.
void small(Trial& t) { hang(t, 25, 300); }
void whole(Trial& t) { hang(t, 100, t.way.single ? 2 : 12); }

Ways settled() { return in_double(only(direct(), {Integrator::rattle})) + only(direct(), {Integrator::implicit}); }

const Register planar({"joint_grid", "planar", settled(), small, "25 x 25", true});
const Register planar_whole({"joint_grid", "planar", only(direct(), {Integrator::implicit}), whole, "100 x 100", true});

}  // namespace
}  // namespace cdot::hard::joint_grid
