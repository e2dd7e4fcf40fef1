// An island that slept has old impulses, factors and start values.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::awakened {
namespace {

// A World takes impulses in doubles.
template <class T>
planar::Velocity<double> exact(const planar::Velocity<T>&);
template <class T>
spatial::Velocity<double> exact(const spatial::Velocity<T>&);

// It moves like an island that never slept.
void strike(Trial& t) {
  Trial restless(t.file, t.way);
  restless.scene.settings.sleep_after = 0;
  double asleep = 0, apart = 0;
  for (Trial* trial : {&t, &restless}) {
    trial->start();
    trial->run(1);
  }
  asleep = t.sleeping_islands();
  for (Trial* trial : {&t, &restless})
    trial->change([](auto& world) {
      decltype(exact(world.velocity(0))) impulse{};
      impulse.x = 3;
      world.apply_impulse(2, impulse);
    });
  for (int k = 0; k < 480; ++k) {
    t.step(1.0 / 240);
    restless.step(1.0 / 240);
    const BodyState a = t.body("rod3"), b = restless.body("rod3");
    apart = std::max(apart, std::hypot(a.x - b.x, a.y - b.y, a.z - b.z));
  }
  t.near("islands asleep before", asleep, 1, 0);
  t.at_most("apart from one that never slept [m]", apart, 1e-9, 1e-3);
  t.at_most("gap [m]", t.gap(), 1e-4);
}

const Register planar({"awakened", "planar", all_ways(), strike});
const Register spatial({"awakened", "spatial", all_ways(), strike});

}  // namespace
}  // namespace cdot::hard::awakened
