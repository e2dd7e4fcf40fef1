// Effects on the coordinate of any joint: `coordinate s [any]`, without an expression. Their law reads s, its rate, its
// effective mass, parameters and time; they name no body.
#include <algorithm>

#include "derive/expression/symbols.hpp"
#include "derive/language/elaborate.hpp"

namespace cdot::derive {

// coordinate NAME [unit]
void Elaborator::free_coordinate(Source& source, const StatementAst& s) {
  const DeclaredAst& d = s.declared;
  if (joint_.law->on_joint) {
    error(source, d.name.where, "an effect on a joint has no coordinate",
          "write `effect " + joint_.name + " coordinate`");
    return enter(source, d.name.text, "coordinate", Value{}, d.name.where);
  }
  if (!d.unit)
    error(source, d.name.where, "the unit of " + quote(d.name.text) + " is missing",
          "write coordinate " + d.name.text + " [any], or [m] or [rad] for coordinates in that unit alone");
  if (joint_.law->free)
    return error(source, d.name.where, "an effect acts on one coordinate, not on two", "write a second effect",
                 {joint_.law->free->where});
  if (!name_is_free(source, d.name, d.name.text)) return;
  const Unit unit = d.unit ? d.unit->unit : Unit{.any = 1};
  const std::string text = d.name.text;
  Row row;
  row.C = pool_->symbol("coordinate " + text, Role::given);  // never written: the input's leaf stands for it
  row.unit = unit;
  joint_.law->free = Coordinate{text, {}, unit, d.name.where, "of any joint", "", {}, false};
  add_input(text, std::move(row), true);
  joint_.law->free->value = law_values_.at(text).e;
  bounded_candidates_.emplace(text, *joint_.law->free);
  enter(source, text, "coordinate", law_values_.at(text), d.name.where);
}

// 1/K of the coordinate. It changes with the pose, which slopes leave out.
const Value& Elaborator::mass() {
  EffectLaw& law = *joint_.law;
  const Unit any = law.free->unit;
  if (!law.mass) {
    law.mass = leaf_of_input("mass", false);
    mass_ = scalar(law.mass, Unit{.m = 2, .kg = 1} / (any * any));
  }
  return mass_;
}

// The size of the force of the row itself, in its events.
const Value& Elaborator::own_load() {
  if (!in_bound_->own_load) in_bound_->own_load = leaf_of_input("own_load", false);
  const Unit joule{.m = 2, .s = -2, .kg = 1};
  const Unit unit = joint_.law->on_joint ? Unit{.any = 1} : bounded_candidates_.at(in_bound_->coordinate).unit;
  return load_ = scalar(in_bound_->own_load, joule / unit);
}

// The force of another row of the effect, or of the joint whose coordinate it acts on. Null: there is none.
const Value* Elaborator::load(const std::string& name) {
  if (!in_bound_) return nullptr;
  if (in_event_) return name == in_bound_->name && in_bound_->cone_rows == 0 ? &own_load() : nullptr;
  const std::vector<BoundedRow>& all = joint_.law->bounded;
  const auto carrier = std::ranges::find(all, name, &BoundedRow::name);
  const bool of_joint = of_coordinate_ && name == "joint";
  if (!of_joint && (carrier == all.end() || carrier->cone_rows > 0)) return nullptr;
  const int index = of_joint ? -1 : static_cast<int>(carrier - all.begin());
  const Unit joule{.m = 2, .s = -2, .kg = 1};
  if (in_bound_->load) return in_bound_->load_of == index ? &load_ : nullptr;
  in_bound_->load_of = index;
  in_bound_->load = leaf_of_input("load_of_" + name, false);
  const Unit of = of_joint ? Unit{.m = 1} : bounded_candidates_.at(carrier->coordinate).unit;
  load_ = scalar(in_bound_->load, joule / of);
  return &load_;
}

void Elaborator::check_free(Source& spec) {
  const EffectLaw& law = *joint_.law;
  Diagnostics& d = spec.diagnostics;
  if (!of_coordinate_) return;
  if (!law.free)
    return d.error(spec.ast.name.where, "the effect names no coordinate that it acts on", "write coordinate s [any]");
  const auto placed =
      std::ranges::find_if(joint_.parameters, [](const Parameter& p) { return p.kind != ParameterKind::scalar; });
  if (!bodies_.empty() || placed != joint_.parameters.end())
    return d.error(bodies_.empty() ? placed->where : bodies_.begin()->second,
                   "an effect on the coordinate of a joint has no bodies and no points",
                   "write `effect " + joint_.name + " planar` for an effect between bodies");
  if (law.inputs.size() + law.bounded.size() > 1)
    return d.error(spec.ast.name.where, "an effect on a coordinate is a force or one row with bounds, not both",
                   "write two effects");
}

}  // namespace cdot::derive
