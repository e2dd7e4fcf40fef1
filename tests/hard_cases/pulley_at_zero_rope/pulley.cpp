// One side of a pulley is pulled up to its wheel, where the rope has no direction, and past it.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::pulley_at_zero_rope {
namespace {

double up(const BodyState& b, Dimension dimension) { return dimension == Dimension::planar ? b.y : b.z; }
double aside(const BodyState& b, Dimension dimension) { return dimension == Dimension::planar ? 0 : b.y; }

void pull(Trial& t) {
  t.start();
  double length_off = 0;
  bool reached = false;
  const auto length = [&](const char* name, double x) {
    const BodyState b = t.body(name);
    return std::hypot(b.x - x, up(b, t.scene.dimension) - 10, aside(b, t.scene.dimension));
  };
  const Watch w = t.run(3, 0, [&] {
    const double a = length("b1", -1), b = length("b2", 1);
    reached = reached || a < 1e-3 || b < 1e-3;
    if (!reached) length_off = std::max(length_off, std::abs(a + b - 5.2));
  });
  t.at_most("rope off [m]", length_off, 1e-4);
  t.at_most("energy gained, of 147 J", w.rise / 147.15, 1e-3);
}

const Register planar({"pulley_at_zero_rope", "planar",
                       direct() + only(iterative(), {Integrator::euler, Integrator::implicit}), pull});
const Register spatial({"pulley_at_zero_rope", "spatial",
                        direct() + only(iterative(), {Integrator::euler, Integrator::implicit}), pull});

}  // namespace
}  // namespace cdot::hard::pulley_at_zero_rope
