// An axis of any length but zero is a direction.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::axis_not_unit {
namespace {

void slide(Trial& t) {
  t.start();
  t.run(2);
  double apart = 0;
  const BodyState one = t.body("block1");
  for (const char* name : {"block2", "block3"}) {
    const BodyState b = t.body(name);
    apart = std::max(apart, std::hypot(b.x - one.x, b.y - one.y, b.z - one.z));
  }
  t.at_most("apart [m]", apart, 1e-12, 1e-5);
  // g sin 30 t^2 / 2, plus the error of a first-order method: half a step.
  const double way = std::hypot(one.x, one.y, one.z);
  t.at_most("way short of 9.81 m, relative", 1 - way / 9.81, 1e-9, 1e-5);
  t.at_most("way beyond it, relative", way / 9.81 - 1, 1.0 / 120 + 1e-9, 1.0 / 120 + 1e-5);
}

void zero(Trial& t) {
  for (NamedValue& value : t.scene.joints[0].definition.parameters)
    if (value.name == "t" || value.name == "fa") std::fill(value.numbers.begin(), value.numbers.end(), 0.0);
  t.at_most("accepted", t.refused("must not be zero") ? 0 : 1, 0);
}

const Register planar({"axis_not_unit", "planar", all_ways(), slide});
const Register spatial({"axis_not_unit", "spatial", all_ways(), slide});
const Register planar_zero({"axis_not_unit", "planar", all_ways(), zero, "the zero axis"});
const Register spatial_zero({"axis_not_unit", "spatial", all_ways(), zero, "the zero axis"});

}  // namespace
}  // namespace cdot::hard::axis_not_unit
