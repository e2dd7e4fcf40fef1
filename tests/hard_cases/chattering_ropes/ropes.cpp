// Inequality rows that become active and inactive at every step.
#include "tests/hard_cases/scaled.hpp"
#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::chattering_ropes {
namespace {

void swing(Trial& t) {
  t.start();
  const double start = 0.5 * 9 + 0.5 * (1.25 / 12) * 4;
  const Watch w = t.run(10);
  t.at_most("a rope too long by [m]", w.gap, 1e-3);
  t.at_most("energy gained, of the throw's", w.rise / start, 0.01);
}

// The resolution of a rope's length, rate and force decides whether the rope is taut, at every scale.
void swing_scaled(Trial& t, double length, double mass) {
  scale(t.scene, length, mass);
  t.start();
  const Watch w = t.run(5);
  t.at_most("a rope too long by, of a box's length", w.gap / length, 1e-6, 1e-3);
  t.at_most("energy gained, of the box's weight times its length", w.rise / (g * mass * length * length), 5e-3);
}

const Register planar({"chattering_ropes", "planar", all_ways(), swing});
const Register spatial({"chattering_ropes", "spatial", all_ways(), swing});

struct RegisterScaled {
  RegisterScaled() {
    const struct {
      const char* name;
      double length, mass;
    } scales[] = {{"1e-6 m, 1e-9 kg", 1e-6, 1e-9}, {"1e-3 m, 1e-6 kg", 1e-3, 1e-6}, {"1e6 m, 1e9 kg", 1e6, 1e9}};
    for (const char* space : {"planar", "spatial"})
      for (const auto& [name, length, mass] : scales)
        Register({"chattering_ropes", space, all_ways(),
                  [length = length, mass = mass](Trial& t) { swing_scaled(t, length, mass); }, name});
  }
} const scaled;

}  // namespace
}  // namespace cdot::hard::chattering_ropes
