#include "derive/compile/scene/bonds.hpp"

#include <algorithm>

#include "runtime/state/world_data.hpp"

namespace cdot::compile {
namespace {

// The first one of that name; -1: there is none.
template <class List>
int named(const List& list, const std::string& name) {
  const auto found = std::ranges::find_if(list, [&](const auto& one) { return one.name == name; });
  return found == list.end() ? -1 : static_cast<int>(found - list.begin());
}

}  // namespace

template <class S>
int number_among_breakable(BasicWorld<S>& world, int joint) {
  int number = -1, last = -1;
  for (const cdot::Bond& bond : world.data().bonds) {
    number += bond.joint != last, last = bond.joint;
    if (bond.joint == joint) return number;
  }
  return -1;
}

template <class S>
void read_bonds(const Scene& scene, BasicWorld<S>& world, Mechanism& mechanism) {
  for (const cdot::Bond& bond : world.data().bonds) {
    const std::string& joint = scene.joints[static_cast<std::size_t>(bond.joint)].name;
    mechanism.bonds.push_back({joint + "." + bond.type, bond.type, number_among_breakable(world, bond.joint),
                               named(mechanism.joints, joint), named(mechanism.bounded, joint), bond.parameters});
  }
}

#define CDOT_INSTANTIATE(S)                                 \
  template int number_among_breakable(BasicWorld<S>&, int); \
  template void read_bonds(const Scene&, BasicWorld<S>&, Mechanism&);
CDOT_INSTANTIATE(Planar<double>)
CDOT_INSTANTIATE(Spatial<double>)
#undef CDOT_INSTANTIATE

}  // namespace cdot::compile
