// That the page of hard cases is whole, and that what an engine makes of a case is not a mistake of its adapter.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "tests/bench/peers/geometry.hpp"
#include "tests/bench/peers/hard/table.hpp"
#include "tests/bench/peers/measure.hpp"
#include "tests/bench/peers/problem.hpp"

namespace cdot::peers {
namespace {

const std::string folder = CDOT_SOURCE_DIR "/tests/bench/peers/";

std::string text_of(const std::string& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

nlohmann::json committed() { return nlohmann::json::parse(text_of(folder + "hard_cases.json")); }

TEST(HardCases, HaveACellForEveryCaseAndEngine) {
  const nlohmann::json found = committed();
  int cells = 0;
  for (const Row& row : rows()) {
    if (!row.reason.empty()) continue;
    ASSERT_TRUE(found.contains(row.name)) << row.name << ": remake the page";
    for (const Column& column : columns()) {
      EXPECT_TRUE(found.at(row.name).contains(column.title)) << row.name << ", " << column.title;
      ++cells;
    }
  }
  EXPECT_EQ(text_of(folder + "hard_cases.md"), page(found)) << "remake it with --page";
  std::printf("%d cells\n", cells);
}

// Small steps: 1/6000 s, or a hundredth of a radian; and so many.
constexpr int moment = 120;
double fine_step(const Problem& problem) {
  double spin = 60;
  for (const Body& body : problem.bodies) spin = std::max(spin, norm(body.start.w));
  return 0.01 / spin;
}

std::vector<State> after_a_moment(const Problem& problem, const Setting& setting, double& start_off) {
  const double h = fine_step(problem);
  const auto run = setting.series.start(setting.knob > 0 ? setting.knob : h);
  start_off = start_error(problem, *run);
  for (int k = 0; k < moment; ++k) run->step(h);
  std::vector<State> states;
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) states.push_back(run->state(int(k)));
  return states;
}

double apart(const std::vector<State>& a, const std::vector<State>& b) {
  double worst = 0;
  for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, norm(a[k].x - b[k].x));
  return worst;
}

const Engine& named(const std::string& name) {
  return *std::find_if(engines().begin(), engines().end(), [&](const Engine& e) { return e.name == name; });
}

Setting exact(const Problem& problem) {
  for (const Setting& setting : settings(named("Cdot"), problem))
    if (setting.series.name.starts_with("dop853, adaptive") && setting.knob < 1e-5) return setting;
  throw std::logic_error("no such setting");
}

// How far a start is from its joints, and the largest number in it.
double open(const Problem& problem) {
  double gap = 0;
  for (const Joint& joint : problem.joints) gap = std::max(gap, norm(joint.anchor_b - joint.anchor));
  return gap;
}
double scale(const Problem& problem) {
  double most = 1;
  for (const Body& body : problem.bodies)
    most = std::max({most, norm(body.start.x), norm(body.start.v), norm(body.start.w)});
  return most;
}

// Sweeps come closer slowly where masses are a million apart.
double share(const Problem& problem) {
  double least = never, most = 0;
  for (const Body& body : problem.bodies) {
    least = std::min(least, body.mass);
    most = std::max(most, body.mass);
  }
  return most > 1e5 * least ? 0.12 : 0.02;
}

// Settings that the page knows to end the process, or to be no number at once, which ends some: they would end the
// test.
bool ends_at_once(const nlohmann::json& cell, const std::string& setting) {
  const std::vector<Outcome> all = cell_of(cell).settings;
  return std::any_of(all.begin(), all.end(), [&](const Outcome& o) {
    return o.setting == setting && (o.kind == Outcome::aborts || (o.kind == Outcome::explodes && o.time < 0.1));
  });
}

// How far bodies came in that moment, or would fall.
double way(const Problem& problem, const std::vector<State>& right) {
  const double time = moment * fine_step(problem);
  return std::max(apart(right, starts(problem)), 0.5 * norm(problem.gravity) * time * time);
}

// The least that a setting is off, against what it may be; never if none could be asked.
double least_off(const Question& asked, const Problem& problem, const nlohmann::json& cell, const std::string& what) {
  double off = 0, best = never;
  const std::vector<State> right = after_a_moment(problem, exact(problem), off);
  const double grain = (asked.engine->number == "float" ? 1e-6 : 1e-12) * scale(problem);
  const double bound = share(problem) * way(problem, right) + grain;
  for (const Setting& setting : settings(*asked.engine, problem)) {
    if (best <= bound) break;
    if (ends_at_once(cell, setting.series.name)) continue;
    try {
      best = std::min(best, apart(after_a_moment(problem, setting, off), right));
    } catch (const CannotSay&) {
      throw;
    } catch (const std::exception& gave_up) {
      std::printf("%s, %s: %s\n", what.c_str(), setting.series.name.c_str(), gave_up.what());
    }
    EXPECT_LE(off, std::max(grain, 1e-9 * scale(problem))) << what << ", " << setting.series.name << ": start";
  }
  return best / bound;
}

// Where no setting may be asked, all fail for reasons that the page tells.
bool all_end_at_once(const nlohmann::json& cell) {
  const std::vector<Outcome> all = cell_of(cell).settings;
  return std::all_of(all.begin(), all.end(), [&](const Outcome& o) { return ends_at_once(cell, o.setting); });
}

// In small steps, in the best of its settings, every engine goes where Cdot goes.
TEST(HardCases, AreTheSameForEveryEngineInSmallSteps) {
  const nlohmann::json found = committed();
  int agreed = 0;
  for (const Row& row : rows()) {
    if (!row.reason.empty()) continue;
    for (const Column& column : columns()) {
      const Question asked = question(row, column);
      const nlohmann::json cell = found.at(row.name).at(column.title);
      if (asked.hard_case == nullptr || all_end_at_once(cell)) continue;
      const std::string what = row.name + ", " + column.title;
      try {
        const Problem problem = problem_of(*asked.hard_case);
        if (problem.bodies.size() > 50 || open(problem) > 1e-6 * scale(problem)) continue;
        EXPECT_LE(least_off(asked, problem, cell, what), 1) << what;
        ++agreed;
      } catch (const CannotSay&) {
      }
    }
  }
  std::printf("%d agree\n", agreed);
  EXPECT_GT(agreed, 200);
}

// A chain of three rods that swings in the plane, with all that a problem can say of it.
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

// A word, and what is done after half the time.
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
  const auto add_angle = [](Run& run, const Problem& problem) {
    Problem now = problem;
    for (std::size_t k = 0; k < now.bodies.size(); ++k) now.bodies[k].start = run.state(int(k));
    Joint angle = problem.joints[2];
    angle.kind = JointKind::orientation;
    angle.number = 3;
    if (!run.add(now, angle)) throw CannotSay("made anew");
  };
  static const std::vector<Word> all = {{"torque",
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

// Over a quarter of a second, in small steps.
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

// The first of an engine's settings that is as near as that, or else the best; why is what it says if it cannot.
double least_apart(const Engine& engine, const Problem& problem, const Done& done, const std::vector<State>& right,
                   double enough, std::string& why) {
  double best = never;
  try {
    for (const Setting& setting : settings(engine, problem)) {
      if (best <= enough) break;
      best = std::min(best, apart(said(problem, setting, done), right));
    }
  } catch (const std::exception& cannot) {
    why = cannot.what();
  }
  return best;
}

// What the top pin of the chain carries, in the best of an engine's settings, as a share of what it carries in Cdot.
TEST(HardCases, TellWhatJointsCarry) {
  const Problem plain = swinging();
  const auto carried = [&](const Setting& setting) {
    const double h = 0.25 / steps_of_a_word;
    const auto run = setting.series.start(setting.knob > 0 ? setting.knob : h);
    for (int k = 0; k < steps_of_a_word; ++k) run->step(h);
    return run->force(0);
  };
  const double right = carried(settings(named("Cdot"), plain).front());
  for (const Engine& engine : engines()) {
    double best = never;
    for (const Setting& setting : settings(engine, plain))
      best = std::min(best, std::fabs(carried(setting) / right - 1));
    std::printf("%s: %.1e off %.2f N\n", engine.name.c_str(), best, right);
    EXPECT_LE(best, 0.02) << engine.name;
  }
}

// Box2D's softest pin, a mouse joint, damps the spin of its body in each step.
bool means_another(const Word& word, const Engine& engine) {
  return engine.name == "Box2D" && word.name == std::string("soft");
}

// Every word does to every engine that knows it what it does to Cdot, which without it goes elsewhere.
TEST(HardCases, AreSaidInWordsThatMeanTheSame) {
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
