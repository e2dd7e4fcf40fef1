// The functions of an effect's law. Their inputs are C, its rate, parameters and time.
#include <algorithm>
#include <map>

#include "derive/expression/components.hpp"
#include "derive/kernel/factor.hpp"
#include "derive/kernel/plan.hpp"

namespace cdot::derive {

void plan_law(const Joint& joint, const DerivedLaw& law, std::vector<KernelFunction>& functions) {
  PoseInputs parameters(joint);
  Components components;
  const auto of = [&](Expr e) { return parameters.of(components.of(e)); };
  const auto add = [&](std::string name, std::string summary, const std::vector<NamedExpr>& outputs) {
    functions.push_back({std::move(name), std::move(summary), assemble(outputs), false, {}});
  };
  const auto elements = [&](const std::string& array, const std::vector<Expr>& numbers) {
    std::vector<NamedExpr> outputs;
    for (std::size_t i = 0; i < numbers.size(); ++i) outputs.push_back({element(array, i), of(numbers[i])});
    return outputs;
  };
  if (law.energy) add("energy", "the energy E(C)", {{"E", of(law.energy)}});
  add("force", "the force along each row", elements("F", law.force));
  std::vector<NamedExpr> limits;
  std::size_t row = 0;
  for (const LawInput& input : joint.law->inputs) {
    if (input.lower) {
      limits.push_back({element("lower", row), of(input.lower)});
      limits.push_back({element("upper", row), of(input.upper)});
    }
    row += input.rate->vector ? static_cast<std::size_t>(joint.dimension) : 1;
  }
  if (!limits.empty()) add("limits", "the limits of the force", limits);
  const bool works = std::ranges::any_of(law.unstored, [](Expr e) { return !is_zero(e); });
  if (works && law.energy) add("unstored", "the part of the force without an energy", elements("F", law.unstored));
  std::vector<NamedExpr> slopes;
  for (std::size_t i = 0; i < law.force.size(); ++i) {
    for (std::size_t j = 0; j < law.force.size(); ++j) {
      slopes.push_back({element(element("k", i), j), of(law.stiffness[i][j])});
      slopes.push_back({element(element("d", i), j), of(law.damping[i][j])});
    }
  }
  add("slopes", "k = -dF/dC and d = -dF/d(rate)", slopes);
}

KernelBound plan_bound(const Joint& joint, const BoundedRow& row, const DerivedBound& derived) {
  PoseInputs parameters(joint);
  Components components;
  const std::map<const Node*, Expr> own = {{&*row.value, joint.pool->symbol(bounded_value, Role::given)}};
  std::vector<NamedExpr> outputs;
  const auto add = [&](const char* name, Expr e) {
    if (e) outputs.push_back({name, parameters.of(components.of(substitute(e, own)))});
  };
  add("B.lower", row.lower);
  add("B.upper", row.upper);
  if (row.of_rate && !is_zero(derived.rate)) add("B.rate", derived.rate), add("B.acceleration", derived.acceleration);
  const char* const summary = row.of_rate ? "bounds of the force, and the rate" : "ends of the coordinate";
  return {&row, {"bounds", summary, assemble(outputs), false, {}}};
}

}  // namespace cdot::derive
