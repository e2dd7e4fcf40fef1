// A game loop with effects: a door whose motor follows the player's keys, with limits, a hinge that breaks, frames of
// any length over steps of one length, and a rewind.
#include <cmath>
#include <cstdio>

#include <cdot/effects.hpp>
#include <cdot/world.hpp>

namespace {

constexpr double step = 1.0 / 120;

struct Game {
  cdot::World<double> world{[] {
    cdot::Settings settings;
    settings.gravity_y = 0;  // seen from above
    return settings;
  }()};
  int door = world.add_body({.x = 0.5, .mass = 20, .inertia = 20.0 / 12});
  int hinge = world.add_joint({.type = "revolute",
                               .bodies = {world.ground(), door},
                               .parameters = {{"pa", {0, 0}}, {"pb", {-0.5, 0}}},
                               .soft = {}});
  int stops = add_limit(world, hinge, "angle", {.lower = 0.0, .upper = 1.5});
  int motor = add_motor(world, hinge, "angle", {.speed = 0, .max_force = 30});
  double owed = 0;    // time of frames that no step has covered yet
  double before = 0;  // the angle one step ago

  Game() { set_breaking_load(world, hinge, 2000); }

  // Keys act on the motor, steps are all alike, and the rest of the frame waits for the next one.
  void frame(double seconds, double wish) {
    cdot::set_motor(world, hinge, motor, {.speed = wish, .max_force = 30});
    for (owed += seconds; owed >= step; owed -= step) {
      before = world.place(door).angle;
      if (!world.step(step)) std::printf("the step failed\n");
    }
  }
  // The angle to draw: between the last two steps.
  double drawn() const { return before + (world.place(door).angle - before) * owed / step; }
};

int failures = 0;
void expect(bool holds, const char* what) {
  std::printf("%s: %s\n", holds ? "holds" : "FAILS", what);
  failures += holds ? 0 : 1;
}

}  // namespace

int main() {
  Game game;
  double shortest = 1.0 / 144;
  for (int k = 0; k < 200; ++k) game.frame(k % 3 == 0 ? 1.0 / 30 : shortest, 1);  // a frame rate that jumps
  expect(std::fabs(game.world.place(game.door).angle - 1.5) < 1e-3, "the open door rests at its stop");
  expect(std::fabs(game.drawn() - 1.5) < 1e-3, "and is drawn there");

  const cdot::Snapshot open = game.world.snapshot();
  for (int k = 0; k < 60; ++k) game.frame(1.0 / 60, -2);
  const double closed = game.world.place(game.door).angle;
  expect(closed < 0.2, "it follows the key back");

  game.world.apply_impulse(game.door, {400, 0, 0});  // a kick along the door: 400 N s within a step
  game.frame(2 * step, 0);
  expect(game.world.broken(game.hinge), "the kick tears it off its hinge");

  game.world.restore(open);
  game.owed = 0;
  expect(!game.world.broken(game.hinge), "the rewind mends the hinge");
  for (int k = 0; k < 60; ++k) game.frame(1.0 / 60, -2);
  expect(std::fabs(game.world.place(game.door).angle - closed) < 0.05, "and the same keys close the door again");
  return failures == 0 ? 0 : 1;
}
