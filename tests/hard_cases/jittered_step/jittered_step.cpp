// A hanging chain at rest in steps of 1/30 s and 1/240 s at random: the impulses for warm starting have the wrong size.
#include <algorithm>
#include <cmath>
#include <random>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::jittered_step {
namespace {

void jitter(Trial& t) {
  t.start();
  const Frame start = t.frame();
  std::minstd_rand random(1);
  double moved = 0, speed = 0;
  for (int k = 0; k < 600; ++k) {
    t.step(random() % 2 ? 1.0 / 30 : 1.0 / 240);
    const Frame now = t.frame();
    for (std::size_t i = 0; i < now.bodies.size(); ++i) {
      const BodyState &a = start.bodies[i], &b = now.bodies[i];
      moved = std::max(moved, std::hypot(a.x - b.x, a.y - b.y, a.z - b.z));
      speed = std::max(speed, std::hypot(b.vx, b.vy, b.vz));
    }
  }
  t.at_most("moved [m]", moved, 1e-3, 1e-2);
  t.at_most("speed [m/s]", speed, 0.05, 0.5);
}

const Register planar({"jittered_step", "planar", only(direct(), {Integrator::implicit}), jitter});

}  // namespace
}  // namespace cdot::hard::jittered_step
