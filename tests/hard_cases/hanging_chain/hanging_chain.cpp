// 100 links between two fixed points stay in their exact equilibrium.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::hanging_chain {
namespace {

void hold(Trial& t) {
  t.start();
  const Frame start = t.frame();
  double moved = 0;
  t.run(10);
  const Frame end = t.frame();
  for (std::size_t k = 0; k < end.bodies.size(); ++k) {
    const BodyState &a = start.bodies[k], &b = end.bodies[k];
    moved = std::max(moved, std::hypot(a.x - b.x, a.y - b.y, a.z - b.z));
  }
  t.at_most("moved in 10 s [m]", moved, 1e-6, 1e-3);
}

const Register planar({"hanging_chain", "planar", only(direct(), {Integrator::implicit, Integrator::dop853}), hold});
const Register spatial({"hanging_chain", "spatial", only(direct(), {Integrator::implicit, Integrator::dop853}), hold});

}  // namespace
}  // namespace cdot::hard::hanging_chain
