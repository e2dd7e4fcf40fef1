// Angles wrap at half a turn; limits and counted turns must not.
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::angle_past_half_a_turn {
namespace {

constexpr double degree = pi / 180;

void turn(Trial& t) {
  t.start();
  t.run(10);
  t.near("upper stop [deg]", t.coordinate(0, "angle") / degree, 45, 0.5);
  t.near("lower stop [deg]", t.coordinate(1, "angle") / degree, -200, 0.5);
  t.run(3770 * h - 10);
  t.near("1000 turns [rad]", t.coordinate(2, "angle"), 100 * 3770 * h, 1e-6, 1);
}

const Register planar({"angle_past_half_a_turn", "planar",
                       direct() + only(iterative(), {Integrator::euler, Integrator::implicit, Integrator::rattle}),
                       turn});
const Register spatial({"angle_past_half_a_turn", "spatial",
                        only(all_ways(), {Integrator::euler, Integrator::implicit}), turn});

}  // namespace
}  // namespace cdot::hard::angle_past_half_a_turn
