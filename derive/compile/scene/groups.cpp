#include "derive/compile/scene/groups.hpp"

namespace cdot::compile {

std::vector<int> groups_of(const Mechanism& mechanism) {
  std::vector<int> group(mechanism.bodies.size(), -1);
  for (std::size_t b = 0; b < group.size(); ++b)
    if (mechanism.bodies[b].moves) group[b] = static_cast<int>(b);
  const auto connect = [&](const std::vector<int>& bodies) {
    int first = -1;
    for (const int b : bodies) {
      const int with = group[static_cast<std::size_t>(b)];
      if (with < 0) continue;
      if (first < 0) first = with;
      std::ranges::replace(group, with, first);
    }
  };
  for (const Joint& joint : mechanism.joints) connect(joint.bodies);
  for (const std::vector<Effect>* effects : {&mechanism.effects, &mechanism.bounded})
    for (const Effect& effect : *effects) connect(effect.bodies);
  int count = 0;
  for (int b = 0; b < static_cast<int>(group.size()); ++b) {
    if (std::ranges::find(group, b) == group.end()) continue;
    std::ranges::replace(group, b, -2 - count++);
  }
  for (int& of_body : group)
    if (of_body < -1) of_body = -2 - of_body;
  return group;
}

int group_of(const std::vector<int>& groups, const std::vector<int>& bodies) {
  int group = 0;
  for (const int body : bodies) group = std::max(group, groups[static_cast<std::size_t>(body)]);
  return group;
}

std::vector<int> groups_of_bounds(const Mechanism& mechanism) {
  const std::vector<int> groups = groups_of(mechanism);
  std::vector<int> of;
  for (const Effect& bounded : mechanism.bounded) of.push_back(group_of(groups, bounded.bodies));
  return of;
}

}  // namespace cdot::compile
