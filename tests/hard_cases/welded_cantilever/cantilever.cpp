// Ten welds carry the bending moment of ten blocks.
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::welded_cantilever {
namespace {

double torque(const planar::Wrench& w) { return w.torque; }
double torque(const spatial::Wrench& w) { return w.torque_y; }

void hold(Trial& t) {
  t.start();
  const double start = t.scene.dimension == Dimension::planar ? t.body("b9").y : t.body("b9").z;
  t.run(10);
  const BodyState tip = t.body("b9");
  const double drop = std::abs((t.scene.dimension == Dimension::planar ? tip.y : tip.z) - start);
  t.at_most("tip drops by [m]", drop, 1e-6, 1e-4);
  t.near("wall's force, relative", t.force(0) / (10 * g), 1, 1e-6, 1e-4);
  // About the centre of the first block: 98.1 N at 0.25 m, and 98.1 N m of the other nine ... about the wall 245.25 N
  // m.
  const double about_centre = t.ask([](const auto& world) { return std::abs(torque(world.reaction(0, 0))); });
  t.near("wall's moment, relative", (about_centre + 0.25 * 10 * g) / (10 * g * 2.5), 1, 1e-6, 1e-4);
}

const Register planar({"welded_cantilever", "planar", direct(), hold});
const Register spatial({"welded_cantilever", "spatial", direct(), hold});

}  // namespace
}  // namespace cdot::hard::welded_cantilever
