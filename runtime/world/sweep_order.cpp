#include "runtime/world/sweep_order.hpp"

#include <algorithm>
#include <numeric>

#include <cdot/spaces.hpp>

namespace cdot {
namespace {

template <class S>
std::vector<std::vector<int>> joints_by_body(const WorldData<S>& world) {
  std::vector<std::vector<int>> joints(static_cast<size_t>(world.bodies.count()));
  for (size_t joint = 0; joint < world.joints.size(); ++joint)
    if (!world.joints[joint].broken)
      for (int body : world.joints[joint].bodies) joints[body].push_back(static_cast<int>(joint));
  return joints;
}

// Roots of the sweep: immovable bodies first, then the heaviest.
template <class S>
std::vector<int> roots(const WorldData<S>& world) {
  std::vector<int> bodies(static_cast<size_t>(world.bodies.count()));
  std::iota(bodies.begin(), bodies.end(), 0);
  const auto& m = world.bodies.inverse_mass;
  std::stable_sort(bodies.begin(), bodies.end(), [&](int i, int j) { return m[i].m < m[j].m; });
  return bodies;
}

}  // namespace

// Depth first, each chain to its end; the reverse order runs from the tips to the roots.
template <class S>
std::vector<int> sweep_places(const WorldData<S>& world) {
  struct Visit {
    int body;
    size_t next;  // index of its next joint
  };
  const auto joints = joints_by_body(world);
  int place = static_cast<int>(world.joints.size());
  std::vector<int> places(world.joints.size(), -1);
  std::vector<char> seen(joints.size(), 0);
  std::vector<Visit> path;
  const auto enter = [&](int body) {
    if (!seen[body]) path.push_back({body, 0});
    seen[body] = 1;
  };
  for (int root : roots(world)) {
    enter(root);
    while (!path.empty()) {
      const int body = path.back().body;
      const size_t next = path.back().next++;
      if (next == joints[body].size()) {
        path.pop_back();
        continue;
      }
      const int joint = joints[body][next];
      if (places[joint] >= 0) continue;
      places[joint] = --place;
      for (int other : world.joints[joint].bodies)
        if (!world.bodies.immovable(other)) enter(other);
    }
  }
  return places;
}

#define CDOT_INSTANTIATE(S) template std::vector<int> sweep_places(const WorldData<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
