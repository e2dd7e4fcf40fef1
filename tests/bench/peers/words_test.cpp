// Every feature of the adapters has the same effect in every engine as in Cdot.
#include <cmath>
#include <functional>
#include <gtest/gtest.h>

#include "tests/bench/peers/hard/mover.hpp"
#include "tests/bench/peers/hard_test.hpp"
#include "tests/bench/peers/measure.hpp"

namespace cdot::peers {
namespace {

// A chain of three rods that swings in the plane, the base of all problems here.
Problem swinging() {
  Problem problem;
  problem.planar = true;
  problem.gravity = {0, -9.81, 0};
  problem.duration = 1;
  problem.times = {1};
  for (int k = 0; k < 3; ++k) {
    Body rod;
    rod.name = "rod" + std::to_string(k + 1);
    rod.mass = 1 + 0.5 * k;
    rod.inertia = {0.1, 0.1, 0.1};
    rod.start.x = {0.5 + k, 0, 0};
    rod.number = k;
    problem.bodies.push_back(rod);
    Joint pin;
    pin.a = k - 1;
    pin.b = k;
    pin.anchor = pin.anchor_b = {double(k), 0, 0};
    pin.axis = {0, 0, 1};
    pin.number = k;
    problem.joints.push_back(pin);
  }
  problem.bodies[2].start.w = {0, 0, 5};
  problem.bodies[2].start.v = {0, 2.5, 0};
  return problem;
}
Joint& last_joint(Problem& problem) { return problem.joints.back(); }

using Done = std::function<void(Run&, const Problem& now)>;

// A feature, and an action after half the time.
struct Word {
  const char* name;
  std::function<void(Problem&)> say;
  Done done = {};
};
const std::vector<Word>& words() {
  const auto slide = [](Problem& problem) {
    last_joint(problem).kind = JointKind::prismatic;
    last_joint(problem).axis = {0, 3, 0};
    problem.bodies[2].start.v = {0, -1, 0};
    problem.bodies[2].start.w = {};
  };
  // In space the last link also rotates sideways, not about its length.
  const auto bend = [](Problem& problem) {
    problem.planar = false;
    for (Body& body : problem.bodies) body.inertia = {0.02, 0.1, 0.12};
    last_joint(problem).kind = JointKind::universal;
    last_joint(problem).turns = {{{0, 1, 0}, false, {}}, {{0, 0, 1}, false, {}}};
    problem.bodies[2].start.w = {0, 4, 5};
    problem.bodies[2].start.v = {0, 2.5, -2};
    problem.bodies[2].torque = {3, 0, 0};
  };
  const auto turn_about = [=](Problem& problem, std::size_t free) {
    bend(problem);
    last_joint(problem).kind = JointKind::six_dof;
    last_joint(problem).turns = {{{1, 0, 0}, true, {}}, {{0, 1, 0}, true, {}}, {{0, 0, 1}, true, {}}};
    last_joint(problem).turns[free].held = false;
    problem.bodies[2].start.w = free == 1 ? Vec3{0, 4, 0} : Vec3{0, 0, 5};
    problem.bodies[2].start.v = free == 1 ? Vec3{0, 0, -2} : Vec3{0, 2.5, 0};
  };
  // The last body hangs from the previous link, or over wheels.
  const auto hang = [](Problem& problem, JointKind kind) {
    Joint rope;
    rope.kind = kind;
    rope.a = 1;
    rope.b = 2;
    rope.anchor = {2, 0, 0};
    rope.anchor_b = {3, 0, 0};
    rope.wheel = {1, 2, 0};
    rope.wheel_b = {3.5, 1, 0};
    rope.ratio = 1.5;
    rope.length = kind == JointKind::pulley ? norm(rope.anchor - rope.wheel) + 1.5 * norm(rope.anchor_b - rope.wheel_b)
                                            : norm(rope.anchor_b - rope.anchor);
    rope.number = 3;
    problem.joints.push_back(rope);
  };
  // The last body is tied to a point of the world and starts at rest.
  const auto tie = [=](Problem& problem, JointKind kind) {
    hang(problem, kind);
    Joint& rope = problem.joints.back();
    rope.a = world;
    rope.anchor = {2, 2, 0};
    rope.length = std::sqrt(5);
    problem.bodies[2].start.w = problem.bodies[2].start.v = {};
  };
  const auto add_angle = [](Run& run, const Problem& problem) {
    Problem now = problem;
    for (std::size_t k = 0; k < now.bodies.size(); ++k) now.bodies[k].start = run.state(int(k));
    Joint angle = problem.joints[2];
    angle.kind = JointKind::orientation;
    angle.number = 3;
    if (!run.add(now, angle)) throw CannotSay("made anew");
  };
  static const std::vector<Word> all = {
      {"torque",
       [](Problem& p) {
         p.bodies[2].torque = {0, 0, 3};
       }},
      {"damping",
       [](Problem& p) {
         for (Body& body : p.bodies) body.damping = 2;
       }},
      {"damper",
       [](Problem& p) {
         last_joint(p).spring = Spring{0, 0.5};
       }},
      {"slider", slide},
      {"spring",
       [=](Problem& p) {
         slide(p);
         last_joint(p).spring = Spring{50, 2};
       }},
      {"soft",
       [](Problem& p) {
         p.joints[0].soft = Spring{2000, 50};
       }},
      {"stops",
       [](Problem& p) {
         last_joint(p).stops = Stops{-0.1, 0.05};
       }},
      {"motor",
       [](Problem& p) {
         last_joint(p).motor = Motor{1, 20};
       }},
      {"motor whose speed jumps",
       [](Problem& p) {
         last_joint(p).motor = Motor{0, 20, [](double t) { return t < 0.1 ? 1.0 : -2.0; }};
       }},
      {"motor of a slider",
       [=](Problem& p) {
         slide(p);
         last_joint(p).motor = Motor{1, 40};
       }},
      {"brakes",
       [](Problem& p) {
         last_joint(p).brakes = {0.5, 0.75};
       }},
      {"servo",
       [](Problem& p) {
         last_joint(p).servo = Servo{-0.3, 1e6, 5e4, 10};
       }},
      {"mount",
       [=](Problem& p) {
         Joint& mount = last_joint(p);
         mount.kind = JointKind::mount;
         mount.a = world;
         mount.axis = {0.8, 0.6, 0};
         mount.anchor = {2.4, 0.05, 0};
         mount.anchor_b = p.bodies[2].start.x;
         mount.mount = Mount{4000, 500, 30, 30};
         p.bodies[2].start.w = p.bodies[2].start.v = {};
         p.bodies[2].torque = {0, 0, 5};
       }},
      {"contact",
       [](Problem& p) {
         Joint contact;
         contact.kind = JointKind::contact;
         contact.a = 2;
         contact.b = world;
         contact.anchor = contact.anchor_b = {3, 0, 0};
         contact.anchor_b[1] = -0.1;
         contact.axis = {0, 1, 0};
         contact.friction = 0.4;
         contact.number = 3;
         p.joints.push_back(contact);
         p.bodies[2].start.w = {};
         p.bodies[2].start.v = {};
       }},
      {"universal", bend},
      {"universal, first turn held",
       [=](Problem& p) {
         bend(p);
         last_joint(p).turns[0].held = true;
         p.bodies[2].start.w = {0, 0, 5};
         p.bodies[2].start.v = {0, 2.5, 0};
       }},
      {"universal, second turn driven",
       [=](Problem& p) {
         bend(p);
         last_joint(p).turns[1].motor = Motor{1, 20};
       }},
      {"six degrees, about y", [=](Problem& p) { turn_about(p, 1); }},
      {"six degrees, about z", [=](Problem& p) { turn_about(p, 2); }},
      {"distance", [=](Problem& p) { tie(p, JointKind::distance); }},
      {"string", [=](Problem& p) { tie(p, JointKind::max_distance); }},
      {"pulley",
       [=](Problem& p) {
         hang(p, JointKind::pulley);
         p.bodies[2].start.w = p.bodies[2].start.v = {};
       }},
      {"strike", [](Problem&) {},
       [](Run& run, const Problem&) {
         run.strike(2, {-1, 2, 0});
       }},
      {"remove", [](Problem&) {},
       [](Run& run, const Problem&) {
         if (!run.remove(2)) throw CannotSay("made anew");
       }},
      {"add", [](Problem&) {}, add_angle}};
  return all;
}

constexpr int steps_of_a_word = 2000;
constexpr double half_a_step_late = 4e-4;  // [m]: Chipmunk moves bodies before it speeds them up

// Runs a quarter of a second in small steps.
std::vector<State> said(const Problem& problem, const Setting& setting, const Done& done) {
  const double h = 0.25 / steps_of_a_word;
  const auto run = setting.series.start(setting.knob > 0 ? setting.knob : h);
  for (int k = 0; k < steps_of_a_word; ++k) {
    if (done && k == steps_of_a_word / 2) done(*run, problem);
    run->step(h);
  }
  std::vector<State> states;
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) states.push_back(run->state(int(k)));
  return states;
}

// The error of the first of an engine's settings within the bound, or of the best one; `why` gets the reason if none
// runs.
double least_apart(const Engine& engine, const Problem& problem, const Done& done, const std::vector<State>& right,
                   double enough, std::string& why) {
  double best = never;
  try {
    const std::vector<Setting> all = settings(engine, problem);
    if (all.empty()) why = "not of its plane, or of its space";
    for (const Setting& setting : all) {
      if (best <= enough) break;
      best = std::min(best, apart(said(problem, setting, done), right));
    }
  } catch (const std::exception& cannot) {
    why = cannot.what();
  }
  return best;
}

// The load of the chain's top pin with an engine's best setting, relative to Cdot's.
TEST(Words, SayWhatJointsCarry) {
  const Problem plain = swinging();
  const auto carried = [&](const Setting& setting) {
    const double h = 0.25 / steps_of_a_word;
    const auto run = setting.series.start(setting.knob > 0 ? setting.knob : h);
    for (int k = 0; k < steps_of_a_word; ++k) run->step(h);
    return run->force(0);
  };
  const double right = carried(settings(named("Cdot"), plain).front());
  int asked = 0;
  for (const Engine& engine : engines()) {
    const std::vector<Setting> all = settings(engine, plain);
    if (all.empty()) continue;  // compiled scenes and chains by hand pose the problems of the table alone
    ++asked;
    double best = never;
    for (const Setting& setting : all) best = std::min(best, std::fabs(carried(setting) / right - 1));
    std::printf("%s: %.1e off %.2f N\n", engine.name.c_str(), best, right);
    EXPECT_LE(best, 0.02) << engine.name;
  }
  EXPECT_EQ(asked, 9);
}

// Box2D's softest pin, a mouse joint, damps the spin of its body in each step. Bullet's springs of a turn take the mass
// of a body for its inertia.
bool means_another(const Word& word, const Engine& engine) {
  return (engine.name == "Box2D" && word.name == std::string("soft")) ||
         (engine.name == "Bullet" && word.name == std::string("mount"));
}

// Every feature has the same effect in every engine that supports it, and Cdot moves differently without the feature.
TEST(Words, MeanTheSameToEveryEngine) {
  const Problem plain = swinging();
  const std::vector<State> without = said(plain, settings(named("Cdot"), plain).front(), {});
  int agreed = 0;
  for (const Word& word : words()) {
    Problem problem = swinging();
    word.say(problem);
    const std::vector<State> right = said(problem, settings(named("Cdot"), problem).front(), word.done);
    const double matters = apart(right, without);
    for (const Engine& engine : engines()) {
      std::string why;
      const double bound = 0.03 * matters + (engine.name == "Chipmunk" ? half_a_step_late : 0);
      const double off = least_apart(engine, problem, word.done, right, bound, why);
      if (means_another(word, engine)) continue;
      std::printf("%s, %s: %.1e of %.1e m %s\n", word.name, engine.name.c_str(), off, matters, why.c_str());
      EXPECT_TRUE(off <= bound || !why.empty()) << word.name << ", " << engine.name;
      agreed += why.empty();
    }
    EXPECT_GT(matters, 1e-3) << word.name;
  }
  std::printf("%d words meant the same\n", agreed);
  EXPECT_GT(agreed, 60);
}

}  // namespace
}  // namespace cdot::peers
