// step() does not allocate: counts every operator new of the process while it runs.
#include <cdot/methods.hpp>

#include "tests/runtime/spatial_support.hpp"

namespace cdot::test {

extern long allocations;  // counting_new.cpp

namespace {

// All kinds of rows and forces, a joint that breaks and an island that falls asleep during the run.
template <class T>
void add_everything(World<T>& world) {
  const auto rods = add_chain(world, 10, -0.4);
  add_motor(world, 1, "angle", {.speed = 1, .max_force = 2});
  add_limit(world, 2, "angle", {.lower = -0.1, .upper = 0.1});
  add_friction(world, 3, "angle", {.max_force = 0.1});
  add_spring(world, 4, "angle", {.softness = {.by_frequency = true, .frequency = 2}, .rest = 0.2});
  set_breaking_load(world, 7, 30);
  distance(world, rods[0], rods[5], 4, Softness{.by_frequency = true, .frequency = 3, .damping_ratio = 0.2});
  world.add_spring({.body_a = rods[1], .body_b = rods[9], .stiffness = 5, .rest_length = 3});
  world.add_joint({"max_distance", {rods[2], rods[6]}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"l", {4.0}}}, {}});
  add_chain(world, 3, -pi / 2);
}

template <class T>
long allocations_of_a_run(Solver solver, Drift drift, Integrator integrator) {
  Settings s = settings(solver, drift, -9.81);
  s.integrator = integrator;
  s.sleep_after = 0.1;
  s.substeps = 2;
  World<T> world(s);
  add_everything(world);
  world.prepare();
  const long before = allocations;
  for (int i = 0; i < 200; ++i) {
    world.step(0.005);
    if (i % 50 == 49) world.apply_impulse(world.body_count() - 1, {0.1, 0, 0});
  }
  const long made = allocations - before;
  EXPECT_TRUE(world.broken(7));
  EXPECT_TRUE(finite(world));
  return made;
}

// True if a World accepts this combination; setup_test.cpp tests the refused ones.
bool runs(Solver solver, Drift drift, Integrator integrator) {
  if (integrator == Integrator::rattle) return drift == Drift::projection;
  if (!row_of(integrator).any_solver && sweeps(solver)) return false;
  if (!works_on_accelerations(integrator)) return true;
  return drift == Drift::projection || (drift == Drift::none && solver == Solver::direct);
}

TEST(Allocation, TheCounterCounts) {
  const long before = allocations;
  std::vector<int> memory(100);
  EXPECT_EQ(allocations - before, 1) << memory.size();
}

TEST(Allocation, StepDoesNotAllocate) {
  for (Solver solver : {Solver::direct, Solver::iterative}) {
    for (Drift drift : {Drift::none, Drift::baumgarte, Drift::projection}) {
      for (const auto& [name, integrator] : integrators) {
        if (!runs(solver, drift, integrator)) continue;
        EXPECT_EQ(allocations_of_a_run<double>(solver, drift, integrator), 0) << name;
        EXPECT_EQ(allocations_of_a_run<float>(solver, drift, integrator), 0) << name;
      }
    }
  }
}

TEST(Allocation, StepInSpaceDoesNotAllocate) {
  for (Solver solver : {Solver::direct, Solver::iterative}) {
    for (Drift drift : {Drift::none, Drift::baumgarte, Drift::projection}) {
      for (const auto& [name, integrator] : integrators) {
        if (!runs(solver, drift, integrator)) continue;
        Settings s = settings(solver, drift);
        s.integrator = integrator;
        SpatialWorld<double> world(s);
        add_free_mechanism(world);
        world.prepare();
        const long before = allocations;
        for (int i = 0; i < 200; ++i) world.step(0.005);
        EXPECT_EQ(allocations - before, 0) << name;
      }
    }
  }
}

}  // namespace
}  // namespace cdot::test
