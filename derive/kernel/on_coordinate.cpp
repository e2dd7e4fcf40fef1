// The law of an effect that reads one coordinate alone acts on the coordinate of any joint. Its parameters are there
// what the law reads of them.
#include <algorithm>
#include <set>

#include "derive/kernel/plan.hpp"

namespace cdot::derive {
namespace {

// The coordinate that the law is about; null if it reads or pushes more than one, or has more than one row.
const std::string* only_coordinate(const Joint& joint) {
  const EffectLaw& law = *joint.law;
  if (law.free) return &law.free->name;
  if (law.inputs.size() + law.bounded.size() != 1) return nullptr;
  if (!law.bounded.empty()) return &law.bounded[0].coordinate;
  const LawInput& input = law.inputs[0];
  const bool declared = joint.rows[0].text.starts_with(input.name + " = ");
  return declared && !input.rate->vector ? &input.name : nullptr;
}

std::vector<Expr> numbers_of(const EffectLaw& law) {
  std::vector<Expr> numbers;
  const auto add = [&](Expr e) {
    if (e) numbers.push_back(e);
  };
  add(law.energy);
  for (const LawInput& input : law.inputs) add(input.force), add(input.lower), add(input.upper);
  for (const BoundedRow& row : law.bounded)
    for (const Expr e : {row.lower, row.upper, row.rate, row.after, row.until}) add(e);
  return numbers;
}

}  // namespace

std::optional<OnCoordinate> on_coordinate(const Joint& joint) {
  const std::string* const coordinate = joint.law ? only_coordinate(joint) : nullptr;
  if (!coordinate) return {};
  const auto own = std::ranges::find(joint.coordinates, *coordinate, &Coordinate::name);
  const bool bounded = own != joint.coordinates.end();
  const std::optional<Coordinate>& free = joint.law->free;
  const Expr C = free ? free->value : bounded ? own->value : joint.rows[0].C;
  const Unit unit = free ? free->unit : bounded ? own->unit : joint.law->inputs[0].unit;
  OnCoordinate on{joint.law->on_joint ? "joint" : text(unit), {}};
  on.uses.assign(joint.parameters.size(), OnCoordinate::none);
  std::set<const Node*> read;
  for (const Expr leaf : leaves_of(numbers_of(*joint.law))) read.insert(&*leaf);
  // A default may read parameters before it: from the last to the first, all readers of one come before it.
  for (std::size_t i = joint.parameters.size(); i-- > 0;) {
    const Parameter& p = joint.parameters[i];
    if (!read.contains(&*p.symbol)) continue;
    const Expr by_default = p.default_value;
    on.uses[i] = !by_default                     ? OnCoordinate::required
                 : by_default == C               ? OnCoordinate::value
                 : depends_on_bodies(by_default) ? OnCoordinate::required
                                                 : OnCoordinate::by_default;
    if (on.uses[i] != OnCoordinate::by_default) continue;
    for (const Expr leaf : leaves_of(std::span<const Expr>(&by_default, 1))) read.insert(&*leaf);
  }
  return on;
}

}  // namespace cdot::derive
