#include "derive/compile/methods/state.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "derive/compile/foresight/foresight.hpp"
#include "derive/compile/methods/modes.hpp"
#include "derive/compile/one_freedom/step.hpp"

namespace cdot::compile {
namespace {

constexpr const char* state_begins =
    R"(  // All of a run: a copy is a snapshot. After a change of poses or velocities call begin().
  struct State {
    T time;  // [s]
    Pose q[bodies];
    Velocity v[bodies];
)";

constexpr const char* state_ends = R"(  };
  struct Evaluated {  // where J was evaluated
    T time;
    Pose q[bodies];
  };
)";

std::string of_bodies(const Mechanism& mechanism, const Contents& has) {
  std::string text;
  if (has.gyroscopes && !mechanism.on_accelerations())
    text += fmt::format("    Gyroscope g[{}];\n", std::ranges::count_if(mechanism.bodies, &Body::inertia_turns));
  if (mechanism.on_accelerations()) text += "    Velocity a[bodies];\n";
  if (has.pulls()) text += "    Velocity pull[bodies];  // accelerations by the joints and motors\n";
  return text;
}

std::string of_rows(const Mechanism& mechanism, const Contents& has) {
  std::string text;
  if (has.rows)
    text += fmt::format("    T lambda[rows];  // {} of the joints\n",
                        mechanism.method == Method::euler ? "impulses before the correction" : "forces");
  if (has.foresees)
    text += fmt::format(
        "    Multipliers past[{}];  // the last {}, and their differences\n    T known;  // so many of them form a "
        "series\n"
        "    T share;  // of the error, which the first round of Newton's method left last\n",
        foreseen_by(mechanism.method == Method::rattle),
        mechanism.method == Method::rattle ? "forces of first halves"
                                           : "corrections' multipliers by the step's square");
  if (has.one_freedom) text += state_of_freedom();
  if (has.bounded)
    text += fmt::format(
        "    T hold[bounded];  // of the rows with bounds: -1 at the lower one, 1 at the upper one, 0 between{}\n",
        has.modes && has.late_ends ? ",\n                      // 1/4 held beyond an end" : "");
  if (has.bounded && (has.midpoint || has.weighs)) text += "    T force[bounded];  // of these\n";
  if (has.carries_over()) {
    text +=
        "    T load[bounded];    // impulses with which bounds grew\n    T before[bounded];  // forces of "
        "corrections\n";
    if (has.rows) text += "    T drawn[rows];      // of the joints\n";
  }
  if (has.cones) text += "    T share[bounded];  // directions of forces along several coordinates\n";
  if (has.sticks()) text += "    T stuck[bounded];  // 1: has its rate, 0: slips\n";
  if (has.repeats()) text += "    T repeats[bounded];  // forces that they repeat\n";
  return text;
}

}  // namespace

std::string reset_of(const Contents& has) {
  std::string text;
  const auto set = [&](bool has, const char* of, const char* list, int value) {
    if (has) text += fmt::format("    for (T& {0} : s.{1}) {0} = T({2});\n", of, list, value);
  };
  if (has.gyroscopes) text += "    for (Pose& of_body : s.q) of_body.I = {};\n";  // those that do not turn stay so
  set(has.bounded, "of_row", "hold", 0);
  set(has.sticks(), "of_row", "stuck", 0);
  set(has.events, "of_row", "events.began", 0), set(has.events, "of_row", "events.ended", 0);
  if (has.bonds) text += "    s.bonds = {};\n";
  set(has.bonds, "of_joint", "bonds.holds", 1);
  set(has.angles, "angle", "angles.angle", 0), set(has.angles, "turns", "angles.turns", 0);
  return text;
}

std::string state_of(const Mechanism& mechanism, const Contents& has, bool inputs) {
  std::string text =
      (has.strides() ? modes_types(has) : "") + state_begins + of_bodies(mechanism, has) + of_rows(mechanism, has);
  if (has.strides()) text += "    Modes modes;\n";
  if (inputs) text += "    Inputs p;\n";
  if (has.angles) text += "    Angles angles;\n";
  if (has.events) text += "    Events events;\n";
  if (has.bonds) text += "    Bonds bonds;\n";
  if (has.exerts) text += "    T begins[groups];  // 1 before the first step of a mechanism\n";
  if (has.closes()) text += "    T residual;      // the largest |C| [m], [rad]\n";
  if (has.rows)
    text += has.numbers_of_J ? "    Jacobian J;      // of the poses q\n"
                             : "    inline static Jacobian J;  // without numbers: no byte of a State\n";
  return text + state_ends;
}

}  // namespace cdot::compile
