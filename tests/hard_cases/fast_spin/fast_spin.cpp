// 10 000 rad/s: a wheel about its own axis, 167 rad a step; other spins at half a radian a step.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::fast_spin {
namespace {

constexpr double fine = 5e-5;  // [s]

// The rod swings as if the wheel did not rotate, and the wheel keeps its spin.
void wheel(Trial& t) {
  Trial still(t.file, t.way);
  still.scene.bodies[1].definition.w = 0;
  for (Trial* trial : {&t, &still}) {
    trial->scene.bodies.resize(2);
    trial->scene.joints.resize(2);
    trial->start();
  }
  double apart = 0;
  for (int k = 0; k < 300; ++k) {
    still.step(h);
    t.step(h);
    apart = std::max(apart, std::abs(t.body("rod").angle - still.body("rod").angle));
  }
  t.at_most("rod apart from one with a still wheel [rad]", apart, 1e-9, 1e-3);
  t.near("wheel's spin, relative", t.body("wheel").w / 1e4, 1, 1e-12, 1e-5);
  t.at_most("gap [m]", t.gap(), 1e-5);
}

// A rod with a fast spin about a pin at its end: gravity is negligible, so the spin is constant.
void thrown(Trial& t) {
  t.scene.bodies.erase(t.scene.bodies.begin(), t.scene.bodies.begin() + 2);
  t.scene.joints.erase(t.scene.joints.begin(), t.scene.joints.begin() + 2);
  t.scene.joints[0].definition.bodies[1] = 0;
  t.start();
  const Watch w = t.run(0.1, fine);
  t.at_most("gap [m]", w.gap, 1e-6, 1e-3);
  t.near("turned by, relative", t.body("thrown").angle / 1e3, 1, 1e-4, 1e-3);
  t.at_most("energy off, relative", w.drift() / (0.5 * 1e8 / 3), 1e-4, 1e-3);
}

void gyroscope(Trial& t) {
  t.start();
  double dip = 0;
  const Watch w = t.run(0.5, fine, [&] { dip = std::max(dip, std::abs(t.body("disc").z)); });
  const BodyState b = t.body("disc");
  t.near("angle round the vertical [rad]", std::atan2(b.y, b.x), 0.0981 * 0.5, 1e-3, 1e-2);
  t.at_most("nods by [m]", dip, 1e-4, 1e-3);
  t.at_most("gap [m]", w.gap, 1e-9, 1e-5);
  t.near("spin, relative", std::hypot(b.wx, b.wy) / 1e4, 1, 1e-6, 1e-4);
}

const Register planar({"fast_spin", "planar", all_ways(), wheel, "a wheel"});
const Register planar_thrown({"fast_spin", "planar", only(all_ways(), {Integrator::dop853}), thrown, "a rod"});
const Register spatial({"fast_spin", "spatial",
                        in_double(only(all_ways(), {Integrator::euler, Integrator::rattle})) +
                            only(all_ways(), {Integrator::rk4, Integrator::dop853}),
                        gyroscope});

}  // namespace
}  // namespace cdot::hard::fast_spin
