// A number of a scene: a constant, an expression of the time, or a column of a table.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <cdot/profile.hpp>

#include "runtime/tool/scene/entry.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {

// Unit and range of a number of a scene.
struct NumberNeed {
  std::string_view unit;  // "N*m"
  double above = -std::numeric_limits<double>::infinity(), below = std::numeric_limits<double>::infinity();
  Scene* scene = nullptr;  // takes a function, which must keep within these over its duration
};

struct SceneNumber {
  double value = 0;  // of a constant
  std::optional<Profile> profile{};
};

// `size` numbers of a list, or the only number of a key. Nothing if there are none, or if one is a mistake.
std::optional<std::vector<SceneNumber>> read_numbers_in_time(Entry& entry, const std::string& key,
                                                             std::optional<std::size_t> size, Quantity quantity,
                                                             const NumberNeed& need);

// As a parameter of a joint or an effect.
NamedValue named_value(std::string name, const std::vector<SceneNumber>& numbers);

}  // namespace cdot
