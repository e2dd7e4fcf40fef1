// The page of hard cases is complete, and an engine's result is not an error of its adapter.
#include "tests/bench/peers/hard_test.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>

#include "tests/bench/peers/geometry.hpp"
#include "tests/bench/peers/hard/spoilt.hpp"
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
    ASSERT_TRUE(found.contains(row.name)) << row.name << ": remake the page";
    for (const Column& column : columns()) {
      EXPECT_TRUE(found.at(row.name).contains(column.title)) << row.name << ", " << column.title;
      ++cells;
    }
  }
  EXPECT_EQ(text_of(folder + "hard_cases.md"), page(found)) << "remake it with --page";
  std::printf("%d cells\n", cells);
}

// Length of small steps, 1/6000 s or a hundredth of a radian, also of a slider's spring, and their number.
constexpr int moment = 120;
double fine_step(const Problem& problem) {
  double spin = 60;
  for (const Body& body : problem.bodies) spin = std::max(spin, norm(body.start.w));
  for (const Joint& joint : problem.joints)
    if (joint.kind == JointKind::prismatic && joint.spring && joint.b != world)
      spin = std::max(spin, std::sqrt(joint.spring->stiffness / problem.bodies[std::size_t(joint.b)].mass));
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

Setting exact(const Problem& problem) {
  for (const Setting& setting : settings(named("Cdot"), problem))
    if (setting.series.name.starts_with("dop853, adaptive") && setting.knob < 1e-5) return setting;
  throw std::logic_error("no such setting");
}

// The largest |C| at the start, and the largest number in the start.
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

// Sweeps converge slowly at mass ratios of a million.
double share(const Problem& problem) {
  double least = never, most = 0;
  for (const Body& body : problem.bodies) {
    least = std::min(least, body.mass);
    most = std::max(most, body.mass);
  }
  return most > 1e5 * least ? 0.12 : 0.02;
}

// Settings that, by the page, end the process or give NaN at once; they would end the test.
bool ends_at_once(const nlohmann::json& cell, const std::string& setting) {
  const std::vector<Outcome> all = cell_of(cell).settings;
  return std::any_of(all.begin(), all.end(), [&](const Outcome& o) {
    return o.setting == setting && (o.kind == Outcome::aborts || (o.kind == Outcome::explodes && o.time < 0.1));
  });
}

// The distance that bodies move in that time, or the free fall.
double way(const Problem& problem, const std::vector<State>& right) {
  const double time = moment * fine_step(problem);
  return std::max(apart(right, starts(problem)), 0.5 * norm(problem.gravity) * time * time);
}

// The smallest error of a setting relative to its bound; infinite if no setting can run.
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

// True if all settings fail for reasons on the page.
bool all_end_at_once(const nlohmann::json& cell) {
  const std::vector<Outcome> all = cell_of(cell).settings;
  return std::all_of(all.begin(), all.end(), [&](const Outcome& o) { return ends_at_once(cell, o.setting); });
}

// With small steps and its best setting every engine follows Cdot.
TEST(HardCases, AreTheSameForEveryEngineInSmallSteps) {
  const nlohmann::json found = committed();
  int agreed = 0;
  for (const Row& row : rows()) {
    if (spoilt(row.cases.front())) continue;
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

// Each invalid problem has one fault: without the fault every engine accepts the scene; with it Cdot refuses or does
// nothing.
TEST(HardCases, HaveQuestionsThatMayBeRefusedForOneReason) {
  int asked = 0, refused = 0;
  for (const Row& row : rows()) {
    const Spoilt* question = spoilt(row.cases.front());
    if (question == nullptr) continue;
    for (const hard::Case& hard_case : row.cases) {
      Told told{};
      Outcome outcome;
      judge(*question, hard_case, {&named("Cdot")}, told, outcome);
      EXPECT_EQ(outcome.kind, Outcome::survives) << row.name << ": " << outcome.message;
      refused += !outcome.message.empty();
      Spoilt sound = *question;
      sound.spoil = [](Problem&) {};
      sound.mend = nullptr;
      sound.bound = 100;
      for (const Engine& engine : engines()) try {
          Outcome of_sound;
          judge(sound, hard_case, {&engine}, told = {}, of_sound);
          EXPECT_TRUE(of_sound.message.empty()) << row.name << ", " << engine.name << ": " << of_sound.message;
          EXPECT_EQ(of_sound.kind, Outcome::survives) << row.name << ", " << engine.name;
          ++asked;
        } catch (const CannotSay&) {
        }
    }
  }
  std::printf("Cdot refuses %d; %d sound ones go on\n", refused, asked);
  EXPECT_EQ(refused, 7);
  EXPECT_GT(asked, 40);
}

}  // namespace
}  // namespace cdot::peers
