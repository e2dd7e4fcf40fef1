// Equations of motion have no scale, so thresholds must not have one.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/scaled.hpp"
#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::scales {
namespace {

// Compares with the same mechanism in metres and kilograms.
void swing(Trial& t, double length, double mass) {
  Trial usual(t.file, t.way);
  usual.start();
  scale(t.scene, length, mass);
  t.start();
  double apart = 0, gap = 0;
  for (int k = 0; k < 480; ++k) {
    usual.step(1.0 / 240);
    t.step(1.0 / 240);
    gap = std::max(gap, t.gap() / length);
    const Frame a = usual.frame(), b = t.frame();
    for (std::size_t i = 0; i < a.bodies.size(); ++i) {
      const BodyState &p = a.bodies[i], &q = b.bodies[i];
      apart = std::max(apart, std::hypot(p.x - q.x / length, p.y - q.y / length, p.z - q.z / length));
    }
  }
  t.at_most("gap, of a rod's length", gap, 1e-9, 1e-4);
  t.at_most("apart from the usual size, of a rod's length", apart, 1e-6, 1e-2);
}

struct Scale {
  const char* name;
  double length, mass;
  Ways ways;
};

struct RegisterAll {
  RegisterAll() {
    // In float the first-order methods fail at some scales; `--try scales` lists them.
    const Ways small = in_double(direct()) + only(direct(), {Integrator::rattle, Integrator::rk4, Integrator::dop853});
    const Ways large = small + only(direct(), {Integrator::euler});
    const Scale scales[] = {{"1e-6 m, 1e-9 kg", 1e-6, 1e-9, small}, {"1e-6 m, 1e9 kg", 1e-6, 1e9, small},
                            {"1e-3 m, 1e-6 kg", 1e-3, 1e-6, small}, {"1e3 m, 1e6 kg", 1e3, 1e6, large},
                            {"1e6 m, 1e-9 kg", 1e6, 1e-9, large},   {"1e6 m, 1e9 kg", 1e6, 1e9, large}};
    for (const char* space : {"planar", "spatial"})
      for (const Scale& s : scales)
        Register({"scales", space, s.ways, [length = s.length, mass = s.mass](Trial& t) { swing(t, length, mass); },
                  s.name});
  }
} const all;

}  // namespace
}  // namespace cdot::hard::scales
