// The effects of a scene, read by the table of their kinds (<cdot/effects.hpp>).
#include <algorithm>
#include <fmt/format.h>

#include "runtime/rows/parameters.hpp"
#include "runtime/tool/scene/keys.hpp"
#include "runtime/tool/scene/profile.hpp"
#include "runtime/tool/scene/read.hpp"

namespace cdot {
namespace {

Quantity quantity_of(EffectNumber::Range range, bool turns) {
  switch (range) {
    case EffectNumber::as_coordinate: return {Sign::any, turns};
    case EffectNumber::positive: return {Sign::positive};
    case EffectNumber::not_negative: return {Sign::not_negative};
    case EffectNumber::any: break;
  }
  return {};
}

std::vector<EffectKind::Given> read_table(Entry& table, const EffectKind& kind, bool turns) {
  std::vector<EffectKind::Given> given;
  for (const EffectNumber& number : kind.numbers) {
    if (!number.key) break;
    if (number.example) table.required(number.key, number.example);
    given.push_back({table.has(number.key), table.number(number.key, quantity_of(number.range, turns))});
  }
  return given;
}

// Hands the numbers of one effect to its kind.
void read_effect(Entry& entry, const EffectKind& kind, bool turns, CoordinateEffects& effects) {
  const Quantity quantity = quantity_of(kind.numbers[0].range, turns);
  std::vector<EffectKind::Given> given;
  std::string called;
  if (kind.form == EffectKind::number) {
    if (const auto number = entry.number(kind.key, quantity)) given = {{true, number}};
  } else if (auto table = entry.table(kind.key, kind.form == EffectKind::table ? kind.example : "")) {
    given = read_table(*table, kind, turns);
    called = table->what();
    table->close();
  } else if (kind.form == EffectKind::pair && entry.has(kind.key) && !entry.is_array(kind.key)) {
    entry.error(entry.where(kind.key), fmt::format("`{}` needs two ends", kind.key), kind.example);
  } else if (const auto both = kind.form == EffectKind::pair ? entry.numbers(kind.key, 2, quantity) : std::nullopt) {
    given = {{true, (*both)[0]}, {true, (*both)[1]}};
  }
  if (given.empty()) return;
  if (const auto wrong = kind.take(given, effects))
    entry.error(entry.where(kind.key), fmt::format(fmt::runtime(wrong->cause), called), wrong->fix);
}

bool is_key_of_kind(std::string_view name) {
  return std::ranges::any_of(effect_kinds, [&](const EffectKind* kind) { return kind->key == name; });
}

// "k = 1, most = 1": what must be given.
std::string example_of(const JointType& type) {
  std::string text;
  for (std::size_t k = 0; k < type.parameters.size(); ++k)
    if (type.coordinate_uses[k] == CoordinateUse::required)
      text += fmt::format("{}{} = 1", text.empty() ? "" : ", ", type.parameters[k].name);
  return text;
}

// Effects on a joint itself read it as a coordinate without a name. Its load is written as a force.
constexpr CoordinateInfo whole_joint{"", "joint"};

// "any/s" on an angle is "rad/s".
std::string unit_on(std::string_view unit, std::string_view coordinate) {
  std::string text(unit);
  if (const auto at = text.find("any"); at != std::string::npos)
    text.replace(at, 3, coordinate == whole_joint.unit ? "m" : coordinate);
  return text;
}

// An effect of a spec: { k = 50, most = 3 }, or the number of its only parameter.
void read_spec(Entry& entry, const std::string& key, const JointType& type, const CoordinateInfo& coordinate,
               Scene& scene, CoordinateEffects& effects) {
  if (!type.acts_on(coordinate.unit)) {
    entry.error(entry.where(key), fmt::format("`{}` acts on coordinates in {}; `{}` is in {}", key,
                                              type.coordinate_unit, coordinate.name, coordinate.unit));
    entry.has(key);  // read now, so that close() does not report it again
    return;
  }
  const bool turns = coordinate.unit == "rad";
  SpecEffect effect{std::string(type.name)};
  std::vector<const ParameterInfo*> needed;
  const auto quantity = [turns](const ParameterInfo& info) {
    const Sign sign = !(info.above >= 0) ? Sign::any : info.from ? Sign::not_negative : Sign::positive;
    return Quantity{sign, info.unit == "rad" || (turns && (info.unit == "any" || info.unit == "any/s"))};
  };
  for (std::size_t k = 0; k < type.parameters.size(); ++k)
    if (type.coordinate_uses[k] == CoordinateUse::required) needed.push_back(&type.parameters[k]);
  const auto read = [&](Entry& from, const std::string& name, const ParameterInfo& info) {
    const std::string unit = unit_on(info.unit, coordinate.unit);
    const NumberNeed need{unit, open_end(info), info.below, &scene};
    if (const auto number = read_numbers_in_time(from, name, {}, quantity(info), need))
      effect.parameters.push_back(named_value(std::string(info.name), *number));
  };
  if (needed.size() == 1 && (!entry.is_table(key) || entry.is_function(key))) {
    read(entry, key, *needed[0]);
  } else if (auto table = entry.table(key, fmt::format("{{ {} }}", example_of(type)))) {
    for (std::size_t k = 0; k < type.parameters.size(); ++k) {
      const ParameterInfo& info = type.parameters[k];
      const std::string name(info.name);
      if (type.coordinate_uses[k] == CoordinateUse::none) continue;
      if (type.coordinate_uses[k] == CoordinateUse::required) table->required(name, name + " = 1");
      read(*table, name, info);
    }
    table->close();
  }
  effects.specs.push_back(std::move(effect));
}

// True if a number of the effect follows a function of time: then its spec reads it.
bool follows_time(Entry& entry, const EffectKind& kind, bool turns) {
  const auto number_follows = [&](Entry& of, const char* key, const EffectNumber& number) {
    return of.is_function(key, quantity_of(number.range, turns));
  };
  if (number_follows(entry, kind.key, kind.numbers[0])) return true;
  std::optional<Entry> table = entry.table(kind.key);
  return table && std::ranges::any_of(kind.numbers, [&](const EffectNumber& number) {
           return number.key && number_follows(*table, number.key, number);
         });
}

void read_kind(Entry& entry, const EffectKind& kind, const CoordinateInfo& coordinate, Scene& scene,
               CoordinateEffects& effects) {
  const bool turns = coordinate.unit == "rad";
  const JointType* const spec = find_coordinate_effect(kind.key);
  if (spec && spec->acts_on(coordinate.unit) && follows_time(entry, kind, turns))
    read_spec(entry, kind.key, *spec, coordinate, scene, effects);
  else read_effect(entry, kind, turns, effects);
}

void read_specs(Entry& entry, const CoordinateInfo& coordinate, Scene& scene, CoordinateEffects& effects) {
  for (const JointType& type : coordinate_effects()) {
    const std::string key(type.name);
    if (!is_key_of_kind(key) && entry.has(key)) read_spec(entry, key, type, coordinate, scene, effects);
  }
  for (const std::string& key : entry.unread()) {
    const std::string spec = spec_beside(entry, key, {".effect"});
    const JointType* const own = spec.empty() ? nullptr : own_effect_type(entry, key, spec);
    if (own) read_spec(entry, key, *own, coordinate, scene, effects);
    else if (!spec.empty()) entry.has(key);
  }
}

}  // namespace

void read_bonds(Entry& joint, Scene& scene, std::vector<SpecEffect>& to) {
  CoordinateEffects bonds;
  for (const JointType& type : coordinate_effects()) {
    const std::string key(type.name);
    if (type.acts_on_joint() && joint.has(key)) read_spec(joint, key, type, whole_joint, scene, bonds);
  }
  for (const std::string& key : joint.unread()) {
    const std::string spec = spec_beside(joint, key, {".effect"});
    const JointType* const own = spec.empty() ? nullptr : own_effect_type(joint, key, spec);
    if (own && own->acts_on_joint()) read_spec(joint, key, *own, whole_joint, scene, bonds);
    else if (own)
      joint.error(joint.where(key), fmt::format("{} acts on a coordinate of a joint", spec),
                  fmt::format("angle.{} = …", key));
    if (!spec.empty()) joint.has(key);
  }
  to = std::move(bonds.specs);
}

void read_effects(Entry& joint, const JointType& type, Scene& scene, std::vector<CoordinateEffects>& to) {
  for (const CoordinateInfo& coordinate : type.coordinates) {
    const std::string key(coordinate.name);
    std::optional<Entry> entry = joint.table(key);
    if (!entry) {
      if (joint.has(key)) {
        joint.error(joint.where(key), fmt::format("`{}` is a coordinate: it takes effects", key),
                    fmt::format("{}.limit = [0, 1], {}.motor = {{ speed = 2 }}, …", key, key));
      }
      continue;
    }
    CoordinateEffects effects{key};
    for (const EffectKind* kind : effect_kinds) read_kind(*entry, *kind, coordinate, scene, effects);
    read_specs(*entry, coordinate, scene, effects);
    entry->close();
    to.push_back(std::move(effects));
  }
}

// A spring about C = 0.
std::optional<Softness> read_softness(Entry& joint, const char* key) {
  EffectKind kind = spring_kind;
  kind.key = key;
  for (EffectNumber& number : kind.numbers)
    if (number.key && std::string_view(number.key) == "rest") number = {};
  CoordinateEffects effects;
  read_effect(joint, kind, false, effects);
  return effects.springs.empty() ? std::nullopt : std::optional(effects.springs.front().softness);
}

KeyTable keys_of_effects() {
  KeyTable table{"Effects on a coordinate of a joint: angle.motor = { speed = 2 }", {}};
  for (const EffectKind* kind : effect_kinds) table.rows.push_back({kind->key, kind->meaning, ""});
  for (const JointType& type : coordinate_effects()) {
    const bool any = type.coordinate_unit == "any";
    const std::string on = type.acts_on_joint() ? "the joint itself, without a coordinate"
                           : any                ? "any coordinate"
                                                : fmt::format("a coordinate in {}", type.coordinate_unit);
    if (!is_key_of_kind(type.name))
      table.rows.push_back(
          {std::string(type.name), fmt::format("`{{ {} }}` on {}: {}", example_of(type), on, type.title), ""});
  }
  return table;
}

}  // namespace cdot
