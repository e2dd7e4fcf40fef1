// Tables of the keys of a scene, a row each. Reading, "did you mean" and `cdot-run list --keys` use the same rows.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <cdot/methods.hpp>

#include "runtime/tool/scene/entry.hpp"

namespace cdot {

enum class Where : char { everywhere, in_space };

// One key of a table that is read into a To.
template <class To>
struct Key {
  const char *name, *meaning;  // with its unit, as specs/scenes/README.md has it
  const char* otherwise;       // if the key is not given
  void (*read)(Entry& entry, const char* key, To& to);
  Where where = Where::everywhere;
  std::vector<std::string> (*choices)() = nullptr;  // the texts that it may be
};

template <const auto& table>
std::vector<std::string> choices_of() {
  return names_of(table);
}

// Keys of space stay unread in the plane, so that the entry reports them as unknown.
template <class To, std::size_t count>
void read_keys(Entry& entry, const Key<To> (&keys)[count], Dimension dimension, To& to) {
  for (const Key<To>& key : keys)
    if (key.where == Where::everywhere || dimension == Dimension::spatial) key.read(entry, key.name, to);
}

// --- Readers of a member, or of a member of a member. A key that is not given changes nothing.

template <Sign sign, auto... path, class To>
void read_number(Entry& entry, const char* key, To& to) {
  if (const auto number = entry.number(key, {sign})) (to.*....*path) = *number;
}
template <auto... path, class To>
void read_count(Entry& entry, const char* key, To& to) {
  if (const auto number = entry.whole(key, 1)) (to.*....*path) = *number;
}
template <auto... path, class To>
void read_flag(Entry& entry, const char* key, To& to) {
  if (const auto flag = entry.flag(key)) (to.*....*path) = *flag;
}
// Looks the name up in a table of <cdot/methods.hpp>.
template <const auto& table, auto... path, class To>
void read_choice(Entry& entry, const char* key, To& to) {
  if (const auto name = entry.choice(key, names_of(table))) (to.*....*path) = method_called(table, *name);
}

// "auto", or by name.
std::vector<std::string> integrator_choices();  // tool/scene/settings.cpp
void name_integrator(Scene& scene, const std::string& name);

// --- The same rows for people.

struct KeyTable {
  struct Row {
    std::string name, meaning, otherwise;
  };
  std::string title;
  std::vector<Row> rows;
};

// "direct or iterative", "a, b or c"
std::string listed(const std::vector<std::string>& choices);  // tool/scene/settings.cpp

template <class... Keys>
KeyTable table_of(std::string title, const Keys&... parts) {
  KeyTable table{std::move(title), {}};
  const auto add = [&](const auto& keys) {
    for (const auto& key : keys)
      table.rows.push_back({key.name,
                            (key.where == Where::in_space ? "in space: " : "") + std::string(key.meaning) +
                                (key.choices ? ": " + listed(key.choices()) : ""),
                            key.otherwise});
  };
  (add(parts), ...);
  return table;
}

KeyTable keys_of_the_top();   // tool/scene/settings.cpp
KeyTable keys_of_copies();    // tool/scene/entry.cpp
KeyTable keys_of_a_body();    // tool/scene/bodies.cpp
KeyTable keys_of_a_shape();   // tool/scene/bodies.cpp
KeyTable keys_of_a_joint();   // tool/scene/joints.cpp
KeyTable keys_of_a_spring();  // tool/scene/joints.cpp
KeyTable keys_of_a_sensor();  // tool/scene/sensors.cpp
KeyTable keys_of_effects();   // tool/scene/effects.cpp

}  // namespace cdot
