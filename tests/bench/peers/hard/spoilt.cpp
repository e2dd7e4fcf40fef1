#include "tests/bench/peers/hard/spoilt.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/bench/peers/geometry.hpp"

namespace cdot::peers {
namespace {

constexpr double beyond_measure = 1e4;  // [m]

// Two static bodies with a hinge between them; the rod hangs from the first.
void add_idle(Problem& problem) {
  const int wall = int(problem.bodies.size());
  for (int k = 0; k < 2; ++k) {
    Body body;
    body.name = k == 0 ? "wall" : "post";
    body.mass = 1;
    body.inertia = {1, 1, 1};
    body.start.x = {double(k), 0, 0};
    body.moves = false;
    problem.bodies.push_back(body);
  }
  Joint& pivot = problem.joints.front();
  (pivot.a == world ? pivot.a : pivot.b) = wall;
  Joint idle = pivot;
  idle.kind = JointKind::revolute;
  idle.a = wall;
  idle.b = wall + 1;
  idle.anchor = idle.anchor_b = {0.5, 0, 0};
  ++idle.number;
  problem.joints.push_back(idle);
}
void remove_idle(Problem& problem) { problem.joints.pop_back(); }

void take_mass(Problem& problem) {
  problem.bodies.back().mass = 0;
  problem.bodies.back().inertia = {};
}

void take_axis(Problem& problem) { problem.joints.front().axis = {}; }

void take_length(Problem& problem) {
  for (Joint& joint : problem.joints)
    if (joint.kind == JointKind::distance) joint.length = 0;
}

void turn_axis_round(Problem& problem) {
  Joint& hinge = problem.joints.front();
  hinge.axis_b = -1.0 * hinge.axis;
  hinge.motor = {1, 10};
}

constexpr std::array questions{
    Spoilt{"antiparallel_axes", "a motor", 2, "gone [m]", hard::finite_only, turn_axis_round, nullptr},
    Spoilt{"axis_not_unit", "the zero axis", 2, "gone [m]", hard::finite_only, take_axis, nullptr},
    Spoilt{"both_immovable", "", 2, "off the way without the joint [m]", 1e-6, add_idle, remove_idle},
    Spoilt{"both_immovable", "mass 0", 2, "moved [m]", 1e-6, take_mass, nullptr},
    Spoilt{"zero_length_distance", "length 0", 5, "gap [m]", 1e-4, take_length, nullptr}};

// One run of a problem in one setting.
struct Going {
  Going(Problem the_problem, const Asked& asked, double h) : problem(std::move(the_problem)) {
    const std::vector<Setting> all = settings(*asked.engine, problem);
    if (all.empty()) throw CannotSay("knows the plane only");
    if (asked.setting >= int(all.size())) throw NoSuchSetting();
    setting = all[std::size_t(asked.setting)];
    run = setting.series.start(setting.knob > 0 ? setting.knob : h);
  }
  Vec3 place(std::size_t body) const { return run->state(int(body)).x; }

  Problem problem;  // that the rest refers to
  Setting setting;
  std::unique_ptr<Run> run;
};

// The largest distance of a body from its correct position.
double off(const Going& is, const Going* should) {
  double worst = 0;
  for (std::size_t k = 0; k < is.problem.bodies.size(); ++k) {
    const double gone = norm(is.place(k) - (should ? should->place(k) : is.problem.bodies[k].start.x));
    if (!(gone < beyond_measure)) return hard::finite_only;
    worst = std::max(worst, gone);
  }
  return worst;
}

}  // namespace

const Spoilt* spoilt(const hard::Case& hard_case) {
  const auto is = [&](const Spoilt& s) { return s.fault == hard_case.fault && s.variant == hard_case.variant; };
  const auto* at = std::find_if(questions.begin(), questions.end(), is);
  return at == questions.end() ? nullptr : at;
}

// The scene's own problem is valid; its start is not projected, because the joints will change.
Problem problem_of(const Spoilt& question, const hard::Case& hard_case) {
  hard::Case sound{hard_case.fault, hard_case.scene, {}, [](hard::Trial& trial) {
                     trial.scene.project = false;
                     trial.start();
                   }};
  Problem problem = problem_of(sound);
  question.spoil(problem);
  return problem;
}

void judge(const Spoilt& question, const hard::Case& hard_case, const Asked& asked, Told& told, Outcome& outcome) {
  const Problem problem = problem_of(question, hard_case);
  const double h = hard::h / asked.finer;
  std::unique_ptr<Going> is, should;
  try {
    is = std::make_unique<Going>(problem, asked, h);
    say(told, is->setting);
    is->run->step(h);
  } catch (const CannotSay&) {
    throw;
  } catch (const std::exception& error) {
    return ended(outcome, Outcome::survives, error.what());
  }
  if (question.mend != nullptr) {
    Problem mended = problem;
    question.mend(mended);
    should = std::make_unique<Going>(mended, asked, h);
    should->run->step(h);
  }
  double worst = 0;
  for (const long steps = std::lround(question.seconds / h); std::lround((told.time += h) / h) <= steps;) {
    worst = std::max(worst, off(*is, should.get()));
    if (!std::isfinite(worst)) throw Exploded{told.time};
    is->run->step(h);
    if (should) should->run->step(h);
  }
  outcome.findings.push_back({question.what, worst, question.bound});
  if (question.bound == hard::finite_only) outcome.findings.push_back({"accepted", 1, 0});
  outcome.kind = outcome.findings.back().held() ? Outcome::survives : Outcome::wrong;
}

}  // namespace cdot::peers
