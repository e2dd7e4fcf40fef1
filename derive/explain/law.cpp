// The law of an effect, after its rows.
#include "derive/explain/lecture.hpp"

namespace cdot::derive {

std::vector<Chain> law_chains(const Lecture& lecture) {
  std::vector<Chain> chains;
  if (!lecture.joint.law) return chains;
  const auto show = [&](const std::string& left, Expr e) {
    chains.push_back({leaf({}, left), {{lecture.notation.definition(e), ""}}});
  };
  if (lecture.joint.law->energy) show("E", lecture.joint.law->energy);
  for (const LawInput& input : lecture.joint.law->inputs)
    if (input.force) {
      show("F_" + input.name, input.force);
      if (input.lower) show("min F_" + input.name, input.lower), show("max F_" + input.name, input.upper);
    }
  return chains;
}

// The norm of the multipliers is the load: with C in metres that of a force, with C in radians that of a torque.
static void explain_breaking(Lecture& lecture, Step& step) {
  const BoundedRow& row = lecture.joint.law->bounded.front();
  step.say(row.name + ", `" + row.text + "`: the rows of the joint act until the event, and never again. The load of " +
           row.name + " is the norm of the forces along all these rows.");
  step.say("The event happens where D is not above 0, a share of what the condition compares:");
  const std::map<const Node*, Expr> load = {
      {row.own_load ? &*row.own_load : nullptr, lecture.joint.pool->symbol("load(" + row.name + ")", Role::given)}};
  step.show({leaf({}, "D"), {{lecture.notation.definition(substitute(row.until, load)), ""}}});
}

void explain_law(Lecture& lecture) {
  if (!lecture.joint.law) return;
  Step& step = lecture.section("The law");
  if (lecture.joint.law->mass)
    step.say("mass is the effective mass 1/K of the coordinate. The slopes of the force take it as constant.");
  if (!lecture.joint.rows.empty())
    step.say("The rows are no constraints: the effect pushes along them by a force F, J' F on the bodies.");
  for (Chain& chain : law_chains(lecture)) step.show(std::move(chain));
  if (lecture.joint.law->energy)
    step.say("The energy E adds its slope, -dE/dC, to the force along each row, and conserves what it stores.");
  if (lecture.joint.law->on_joint) return explain_breaking(lecture, step);
  for (const BoundedRow& row : lecture.joint.law->bounded)
    step.say(row.name + ", `" + row.text + "`: a force along the coordinate " + row.coordinate +
             (row.cone_rows > 0 ? ", a part of one force that keeps all these rates, as far as its size may grow. "
                                  "At the bound it acts against the slip."
              : row.of_rate     ? " keeps its rate, as far as its bounds allow. At a bound the coordinate slips."
                                : " acts at an end only, and only away from it."));
}

}  // namespace cdot::derive
