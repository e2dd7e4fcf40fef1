// The effects of a scene, read by the table of their kinds (<cdot/effects.hpp>).
#include <fmt/format.h>

#include "runtime/tool/scene/keys.hpp"
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

}  // namespace

void read_effects(Entry& joint, const JointType& type, std::vector<CoordinateEffects>& to) {
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
    for (const EffectKind* kind : effect_kinds) read_effect(*entry, *kind, coordinate.unit == "rad", effects);
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
  return table;
}

}  // namespace cdot
