// A body that spins about its intermediate axis turns over at known times.
#include <cmath>
#include <vector>

#include <cdot/rotation.hpp>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::tumbling {
namespace {

using Vector = spatial::Vector<double>;

// The spin about the body's own y axis.
double middle_spin(const BodyState& b) {
  const double wx = b.wx, wy = b.wy, wz = b.wz, w = b.e0, x = b.e1, y = b.e2, z = b.e3;
  return 2 * (x * y - w * z) * wx + (1 - 2 * (x * x + z * z)) * wy + 2 * (y * z + w * x) * wz;
}
// World axes to the body's: R' w.
Vector in_body(const BodyState& b) {
  const double w = b.e0, x = b.e1, y = b.e2, z = b.e3;
  return {(1 - 2 * (y * y + z * z)) * b.wx + 2 * (x * y + w * z) * b.wy + 2 * (x * z - w * y) * b.wz, middle_spin(b),
          2 * (x * z + w * y) * b.wx + 2 * (y * z - w * x) * b.wy + (1 - 2 * (x * x + y * y)) * b.wz};
}
double momentum(const BodyState& b) {
  const Vector w = in_body(b);
  return std::hypot(w.x, 2 * w.y, 3 * w.z);
}

void flip(Trial& t) {
  t.start();
  const double start = momentum(t.body("body"));
  std::vector<double> flips;
  double before = middle_spin(t.body("body")), off = 0;
  const Watch w = t.run(20, 0, [&] {
    const double now = middle_spin(t.body("body"));
    if (before * now < 0) flips.push_back(t.time() - h * now / (now - before));
    before = now;
    off = std::max(off, std::abs(momentum(t.body("body")) / start - 1));
  });
  t.near("first flip, relative", (flips.empty() ? 0 : flips[0]) / 4.663209225324385, 1, 0.02);
  t.near("second flip, relative", (flips.size() < 2 ? 0 : flips[1]) / 12.84935266954442, 1, 0.02);
  t.at_most("angular momentum, relative", off, 1e-3);
  t.at_most("energy, relative", w.drift() / 4.005, 0.01);
}

const Register spatial({"tumbling", "spatial", all_ways(), flip});

}  // namespace
}  // namespace cdot::hard::tumbling
