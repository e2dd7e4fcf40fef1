// Rows, patterns and islands change between two steps.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::changed_while_running {
namespace {

// A joint that welds two rods in their present pose removes their relative spin. The energy falls only by the work of
// the least impulse.
void add(Trial& t) {
  t.start();
  t.run(0.5);
  t.change([](auto& world) {
    const bool planar = std::is_same_v<std::decay_t<decltype(world)>, World<double>> ||
                        std::is_same_v<std::decay_t<decltype(world)>, World<float>>;
    if (planar) world.add_joint({"angle", {1, 2}, {}, {}});
    else world.add_joint({"relative_orientation", {1, 2}, {{"fa", {1, 0, 0}}}, {}});
  });
  const Watch w = t.run(2);
  t.at_most("gap [m, rad]", w.gap, 1e-3);
  t.at_most("energy gained, of the fall's", w.rise / (4 * g * 2), 5e-3);
}

// After a pin is removed the rods below fall freely: their centre of mass falls by g t^2 / 2.
void let_go(Trial& t, int pin) {
  t.at_most("not broken", t.ask([&](const auto& world) { return world.broken(pin) ? 0.0 : 1.0; }), 0);
  const bool planar = t.scene.dimension == Dimension::planar;
  const auto height = [&] {
    const BodyState a = t.body("rod3"), b = t.body("rod4");
    return planar ? 0.5 * (a.y + b.y) : 0.5 * (a.z + b.z);
  };
  const auto speed = [&] {
    const BodyState a = t.body("rod3"), b = t.body("rod4");
    return planar ? 0.5 * (a.vy + b.vy) : 0.5 * (a.vz + b.vz);
  };
  const double y = height(), v = speed();
  const Watch w = t.run(1);
  // A first-order method applies a step's gravity at its start or its end: an error of half a step's speed.
  t.near("free fall after 1 s [m]", height() - y, v - 0.5 * g, g / 480 + 1e-9, g / 480 + 1e-3);
  t.at_most("gap [m]", w.gap, 1e-4);
}

void breaks(Trial& t) {
  const int pin = t.joint_named("pin2");
  t.start();
  t.run(0.5);
  t.change([&](auto& world) { set_breaking_load(world, pin, 1e-3); });
  t.step(1.0 / 240);
  let_go(t, pin);
}

void remove(Trial& t) {
  const int pin = t.joint_named("pin2");
  t.start();
  t.run(0.5);
  t.change([&](auto& world) { world.remove_joint(pin); });
  let_go(t, pin);
}

// Every pin moves 1 mm a step along its rod, back and forth, for a second. The rods follow, and the swing neither gains
// energy nor breaks apart.
void change(Trial& t) {
  t.start();
  t.run(0.5);
  const Watch w = t.run(2, 0, [&, step = 0]() mutable {
    const double at = -0.5 + 1e-3 * std::abs((step++ + 10) % 40 - 20) - 0.01;
    NamedValue end{"pb", std::vector<double>(t.scene.dimension == Dimension::planar ? 2 : 3, 0.0)};
    end.numbers[0] = at;
    t.change([&](auto& world) {
      for (int pin = 1; pin < 4; ++pin) world.set_parameters(pin, {end});
    });
  });
  t.at_most("gap [m]", w.gap, 1e-3);
  t.at_most("energy gained, of the fall's", w.rise / (4 * g * 2), 5e-2);
}

const Register planar({"changed_while_running", "planar", all_ways(), add, "a joint added"});
const Register spatial({"changed_while_running", "spatial", all_ways(), add, "a joint added"});
const Register planar_remove({"changed_while_running", "planar", all_ways(), breaks, "a joint broken"});
const Register spatial_remove({"changed_while_running", "spatial", all_ways(), breaks, "a joint broken"});

const Register planar_gone({"changed_while_running", "planar", all_ways(), remove, "a joint removed"});
const Register spatial_gone({"changed_while_running", "spatial", all_ways(), remove, "a joint removed"});
const Register planar_change({"changed_while_running", "planar", all_ways(), change, "joints changed"});
const Register spatial_change({"changed_while_running", "spatial", all_ways(), change, "joints changed"});

}  // namespace
}  // namespace cdot::hard::changed_while_running
