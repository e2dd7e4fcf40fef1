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

namespace {

// By its form alone: sums and products of numbers, parameters and masses that cannot be negative.
bool cannot_be_negative(const Joint& joint, Expr e) {
  const auto all = [&](const std::vector<Expr>& parts) {
    return std::ranges::all_of(parts, [&](Expr part) { return cannot_be_negative(joint, part); });
  };
  switch (e->kind) {
    case Kind::number: return e->value.sign() >= 0;
    case Kind::sum: return std::ranges::all_of(e->coefs, [](Rational c) { return c.sign() > 0; }) && all(e->args);
    case Kind::product:
      for (std::size_t i = 0; i < e->args.size(); ++i)
        if (e->exponents[i] % 2 != 0 && !cannot_be_negative(joint, e->args[i])) return false;
      return true;
    case Kind::symbol: break;
    default: return false;
  }
  if (e->role == Role::constant || e == joint.law->mass) return true;
  const auto parameter = std::ranges::find(joint.parameters, e, &Parameter::symbol);
  return parameter != joint.parameters.end() && parameter->above >= 0;
}

}  // namespace

SlopesOfLaw slopes_of(const Joint& joint, const DerivedLaw& law) {
  std::vector<Expr> slopes;
  for (const auto* matrix : {&law.stiffness, &law.damping})
    for (const std::vector<Expr>& row : *matrix) slopes.insert(slopes.end(), row.begin(), row.end());
  const auto known = [&](Expr leaf) {
    return leaf->role == Role::parameter || leaf->role == Role::constant || leaf == joint.law->mass;
  };
  const bool limited = std::ranges::any_of(joint.law->inputs, [](const LawInput& i) { return bool(i.lower); });
  return {!limited && !depends_on_time(law) && std::ranges::all_of(leaves_of(slopes), known) &&
              std::ranges::all_of(slopes, [&](Expr e) { return cannot_be_negative(joint, e); }),
          std::ranges::all_of(slopes, [](Expr e) { return is_zero(e); })};
}

std::vector<bool> acts_of(const DerivedLaw& law) {
  std::vector<bool> acts;
  for (const Expr force : law.force) acts.push_back(!is_zero(force));
  return acts;
}

bool depends_on_time(const DerivedLaw& law) {
  return std::ranges::any_of(leaves_of(law.force), [](Expr leaf) { return leaf->role == Role::time; });
}

KernelBound plan_bound(const Joint& joint, const BoundedRow& row, const DerivedBound& derived) {
  PoseInputs parameters(joint);
  Components components;
  std::map<const Node*, Expr> own;
  if (row.own_rate) own.emplace(&*row.own_rate, joint.pool->symbol(bounded_rate, Role::given));
  if (row.value) own.emplace(&*row.value, joint.pool->symbol(bounded_value, Role::given));
  if (row.own_load) own.emplace(&*row.own_load, joint.pool->symbol(bounded_load, Role::given));
  std::vector<NamedExpr> outputs;
  const auto add = [&](const char* name, Expr e) {
    if (e) outputs.push_back({name, parameters.of(components.of(substitute(e, own)))});
  };
  std::vector<KernelFunction> others;
  if (row.load) {
    add("B.lower", derived.by_lower);
    add("B.upper", derived.by_upper);
    others.push_back({"by_load", "what each unit of the load adds to the bounds", assemble(outputs), false, {}});
    outputs.clear();
  }
  for (const auto& [name, distance] :
       {std::pair("after", row.after), std::pair(joint.law->on_joint ? "breaks" : "until", row.until)}) {
    if (!distance) continue;
    add("D", distance);
    others.push_back({name, "the distance from that event, at most 0 where it happens", assemble(outputs), false, {}});
    outputs.clear();
  }
  add("B.lower", derived.lower);
  add("B.upper", derived.upper);
  if (row.of_rate && !is_zero(derived.rate)) add("B.rate", derived.rate), add("B.acceleration", derived.acceleration);
  const auto reads = [](std::initializer_list<Expr> numbers, auto is_wanted) {
    return std::ranges::any_of(numbers, [&](Expr e) {
      return e && std::ranges::any_of(leaves_of({&e, 1}), is_wanted);
    });
  };
  const bool in_time =
      reads({row.lower, row.upper, row.rate, row.after, row.until}, [](Expr leaf) { return leaf->role == Role::time; });
  const bool of_value = reads({row.lower, row.upper, row.rate}, [&](Expr leaf) { return leaf == row.value; });
  const auto place = std::ranges::find(joint.coordinates, row.coordinate, &Coordinate::name);
  const char* const summary = row.of_rate ? "bounds of the force, and the rate" : "ends of the coordinate";
  return {&row,     static_cast<int>(place - joint.coordinates.begin()), in_time,
          of_value, {"bounds", summary, assemble(outputs), false, {}},   std::move(others)};
}

}  // namespace cdot::derive
