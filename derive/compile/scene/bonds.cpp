#include "derive/compile/scene/bonds.hpp"

#include <algorithm>

#include "runtime/state/world_data.hpp"

namespace cdot::compile {
namespace {

// The first one of that name, with is(it); -1: there is none.
template <class List, class F>
int named(const List& list, const std::string& name, F is) {
  const auto found = std::ranges::find_if(list, [&](const auto& one) { return one.name == name && is(one); });
  return found == list.end() ? -1 : static_cast<int>(found - list.begin());
}

// Joints carry loads by their own rows. Those of an effect are forces.
void find_carrier(const Mechanism& mechanism, const std::string& joint, bool is_effect, Bond& bond) {
  const auto any = [](const auto&) { return true; };
  bond.joint = named(mechanism.joints, joint, any);
  bond.effect = named(mechanism.effects, joint, any);
  if (bond.joint >= 0 || bond.effect >= 0) return;
  bond.bounded = named(mechanism.bounded, joint, [=](const Effect& of) { return !is_effect || of.acts_by_force(); });
  bond.carries = bond.bounded >= 0;
  if (!bond.carries) bond.bounded = named(mechanism.bounded, joint, any);
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
    Bond& one = mechanism.bonds.emplace_back();
    one.name = joint + "." + bond.type, one.type = bond.type, one.numbers = bond.parameters;
    one.holds = number_among_breakable(world, bond.joint);
    find_carrier(mechanism, joint, world.joint_type(bond.joint).is_effect, one);
  }
}

#define CDOT_INSTANTIATE(S)                                 \
  template int number_among_breakable(BasicWorld<S>&, int); \
  template void read_bonds(const Scene&, BasicWorld<S>&, Mechanism&);
CDOT_INSTANTIATE(Planar<double>)
CDOT_INSTANTIATE(Spatial<double>)
#undef CDOT_INSTANTIATE

}  // namespace cdot::compile
