// A small program whose steps cost_test.cpp counts instruction by instruction. Built twice: CDOT_LINK_EFFECTS links the
// code of the effects; an argument selects an effect. Each scene is counted in a process of its own. All processes
// start alike, so that none costs more for what those before it left in memory.
//
//   cost_scene "direct|iterative PENDULUMS [none|limit|motor|friction|spring|breaking|sleep] [LINKS]"...
#include <cstdio>
#include <sstream>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

#include <cdot/world.hpp>
#ifdef CDOT_LINK_EFFECTS
#include <cdot/effects.hpp>
#endif

namespace {

using cdot::World;

// Adds a pendulum of `links` links; returns its last joint.
int add_pendulum(World<double>& world, double x, bool hanging, int links) {
  int before = world.ground(), joint = -1;
  for (int i = 0; i < links; ++i) {
    const int link = world.add_body({.x = hanging ? x : x + 0.5 + i,
                                     .y = hanging ? -0.5 - i : 0.0,
                                     .angle = hanging ? -1.5707963267948966 : 0.0,
                                     .mass = 1,
                                     .inertia = 1.0 / 12});
    const double anchor = i ? 0.5 : x, y = 0;
    joint = world.add_joint({"revolute", {before, link}, {{"pa", {anchor, y}}, {"pb", {-0.5, 0}}}, {}});
    before = link;
  }
  return joint;
}

#ifdef CDOT_LINK_EFFECTS
// Each effect is so weak or so far away that the motion keeps its bits.
void add_effect(World<double>& world, int joint, const std::string& effect) {
  if (effect == "limit") add_limit(world, joint, "angle", {.lower = -1e9, .upper = 1e9});
  if (effect == "motor") add_motor(world, joint, "angle", {.speed = 1, .max_force = 0});
  if (effect == "friction") add_friction(world, joint, "angle", {.max_force = 0});
  if (effect == "spring")
    add_spring(world, joint, "angle", {.softness = {.by_frequency = false, .damping = 1e-300}, .rest = 0});
  if (effect == "breaking") set_breaking_load(world, joint, 1e300);
}
#endif

}  // namespace

// The counted function: not inlined and not mangled, so valgrind finds its name.
extern "C" __attribute__((noinline)) void measured_steps(World<double>& world) {
  for (int i = 0; i < 20; ++i) world.step(1e-3);
}

namespace {

void run(const std::string& scene) {
  std::istringstream words(scene);
  std::string solver, effect;
  int pendulums = 0, links = 0;
  words >> solver >> pendulums;
  if (!(words >> effect)) effect = "none";
  if (!(words >> links)) links = 2;
  cdot::Settings settings;
  settings.solver = solver == "direct" ? cdot::Solver::direct : cdot::Solver::iterative;
  settings.gravity_y = -9.81;
  settings.sleep_after = 0.05;
  World<double> world(settings);
  const int joint = add_pendulum(world, 0, false, links);
  for (int i = 1; i < pendulums; ++i) add_pendulum(world, 4.0 * i, effect == "sleep", links);
#ifdef CDOT_LINK_EFFECTS
  add_effect(world, joint, effect);
#endif
  for (int i = 0; i < 100; ++i) world.step(1e-3);
  measured_steps(world);
  std::printf("joint %d, hash %llx, asleep %d\n", joint, static_cast<unsigned long long>(world.hash()),
              world.sleeping_islands());
}

}  // namespace

int main(int count, char** arguments) {
  for (int i = 1; i < count; ++i) {
    if (fork() == 0) return run(arguments[i]), 0;
    int status = -1;
    wait(&status);
    if (status != 0) return 1;
  }
}
