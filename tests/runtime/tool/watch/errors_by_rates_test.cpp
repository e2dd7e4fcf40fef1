// The errors of four or six steps by RK4, as their own rates tell them, against the same time by Dormand-Prince.
#include "runtime/tool/watch/errors_by_rates.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <string>

#include "runtime/state/world_data.hpp"
#include "runtime/tool/run/frame.hpp"
#include "runtime/tool/run/simulate.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::errors_by_rates_test {
namespace {

template <class S>
BasicWorld<S> world_by(Scene scene, Integrator integrator, double local_error) {
  scene.settings.integrator = integrator, scene.settings.local_error = local_error;
  std::string warnings;
  return world_at_start<S>(scene, warnings);
}

template <class S>
struct SomeSteps {
  std::vector<BodyError> said, is;
};

template <class S>
SomeSteps<S> some_steps(const char* name, double h, int steps) {
  const Scene scene = scene_named(name);
  const int bodies = static_cast<int>(scene.bodies.size());
  auto run = world_by<S>(scene, Integrator::rk4, 0), exact = world_by<S>(scene, Integrator::dop853, 1e-14);
  ErrorsByRates<S> rates(steps);
  for (int k = 0; k < steps; ++k) {
    EXPECT_TRUE(run.step(h));
    EXPECT_TRUE(rates.add(run.data(), k, h));
    EXPECT_TRUE(exact.step(h));
  }
  SomeSteps<S> found;
  found.said.resize(scene.bodies.size());
  rates.read(run.data(), found.said);
  const auto ends = states_of(run, bodies), right = states_of(exact, bodies);
  for (std::size_t k = 0; k < ends.size(); ++k) {
    const BodyState &a = ends[k], &b = right[k];
    const auto turn = spatial::turn_between(orientation_of(b), orientation_of(a));
    found.is.push_back({{a.x - b.x, a.y - b.y, a.z - b.z},
                        {turn.x, turn.y, turn.z + a.angle - b.angle},
                        {a.vx - b.vx, a.vy - b.vy, a.vz - b.vz},
                        {a.wx - b.wx, a.wy - b.wy, a.wz + a.w - b.wz - b.w}});
  }
  return found;
}

// The largest component, and the largest difference of components, of one part of all bodies.
struct Compared {
  double size = 0, apart = 0;
};
template <class S>
Compared compared(const SomeSteps<S>& found, std::array<double, 3> BodyError::*part) {
  Compared all;
  for (std::size_t k = 0; k < found.is.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i) {
      const double is = (found.is[k].*part)[i], said = (found.said[k].*part)[i];
      all.size = std::max(all.size, std::abs(is)), all.apart = std::max(all.apart, std::abs(said - is));
    }
  return all;
}

// By what the errors of velocities displace within the steps, which the rule leaves out.
template <class S>
double displaced(const SomeSteps<S>& found, std::array<double, 3> BodyError::*part, double duration) {
  const bool of_velocity = part == &BodyError::velocity || part == &BodyError::spin;
  const auto rate = part == &BodyError::position ? &BodyError::velocity : &BodyError::spin;
  return of_velocity ? 0 : duration * compared(found, rate).size;
}

template <class S>
void expect_told(const char* name, double h, int steps) {
  const SomeSteps<S> found = some_steps<S>(name, h, steps);
  EXPECT_GT(compared(found, &BodyError::velocity).size, 1e-12) << name << ": round-off only";
  for (const auto& [what, part] : {std::pair{"position", &BodyError::position},
                                   {"angle", &BodyError::angle},
                                   {"velocity", &BodyError::velocity},
                                   {"spin", &BodyError::spin}}) {
    const auto [size, apart] = compared(found, part);
    fmt::print("{:22} {:8} off by {:.2e}, told to {:.0e} of it\n", name, what, size, apart / size);
    EXPECT_LE(apart, 1e-14 + 0.1 * size + displaced(found, part, steps * h)) << name << ", " << what;
  }
}

TEST(ErrorsByRates, AreThoseOfTheSteps) {
  for (const int steps : {4, 6}) {
    expect_told<Planar<double>>("double_pendulum", 0.005, steps);
    expect_told<Planar<double>>("machine", 0.002, steps);
    expect_told<Spatial<double>>("spatial/chain_10", 0.002, steps);
    expect_told<Spatial<double>>("spatial/gyroscope", 0.0002, steps);
  }
}

// A disc leaves its dome within a step: the rule would integrate over the jump of its acceleration.
TEST(ErrorsByRates, AreUnknownAcrossAnEvent) {
  Scene scene = scene_named("gallery/dome");
  auto run = world_by<Planar<double>>(scene, Integrator::rk4, 0);
  constexpr int steps = 4;
  ErrorsByRates<Planar<double>> rates(steps);
  bool known = true;
  int unknown = 0;
  for (int k = 0; k < 200; ++k) {
    const long long events = run.step_counts().events;
    ASSERT_TRUE(run.step(0.005));
    known = rates.add(run.data(), k % steps, 0.005) && (known || k % steps == 0);
    if (run.step_counts().events == events) continue;
    ++unknown;
    EXPECT_FALSE(known) << "step " << k;
  }
  EXPECT_EQ(unknown, 3) << "each of the three leaves its dome";
}

}  // namespace
}  // namespace cdot::test::errors_by_rates_test
