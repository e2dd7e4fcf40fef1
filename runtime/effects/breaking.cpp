// Joints that break by effects of specs: after each substep, by the impulses of the joint's own rows. Methods that
// locate events in time have found them within it (runtime/events).
#include <cdot/coordinate/breaking.hpp>
#include <cdot/detail/coordinate_effects.hpp>

#include "runtime/effects/effect.hpp"
#include "runtime/events/bonds.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/state/add_rows.hpp"
#include "runtime/world/rollback.hpp"

namespace cdot {
namespace {

// Where several joints of an island carry too much, only the most overloaded one breaks: without it the others may
// carry less, as two pins that work against each other. The next substep shows whether they still carry too much. So it
// does where a row has ended by its load, as a shear pin.
template <class S>
void break_overloaded(WorldData<S>& world, typename S::Scalar h) {
  const double time = double(world.time) + double(h);
  for (std::size_t k = 0; k < world.bonds.size(); ++k) {
    Island<S>& island = world.islands[world.island_of[movable_body(world, world.joints[world.bonds[k].joint])]];
    if (island.asleep || island.flow.locates || island.bonds.front() != static_cast<int>(k)) continue;  // once each
    if (island.latched || overloaded_joint(world, island, time, double(h)) < 0) continue;
    island.solver->share(world, island);
    const int joint = overloaded_joint(world, island, time, double(h));
    if (joint < 0) continue;
    break_joint(world, island, joint, time);
    compute_again(world, island);
  }
}

}  // namespace

template <class S>
void add_bond(BasicWorld<S>& world, const Bond& bond) {
  auto& data = world.data();
  if (data.joints[bond.joint].places.empty()) return;
  if (data.bonds.empty()) data.after_substep.push_back(break_overloaded<S>);
  data.bonds.push_back(bond);
  data.prepared = false;
}

template <class S>
void set_breaking_load(BasicWorld<S>& world, int joint, double load) {
  check_joint(world.data(), joint);
  if (!(load > 0)) throw Error("a breaking load must be > 0");
  using Effect = coordinate::breaking;
  add_bond(world, {joint, std::string(Effect::name), distance_from_breaking<Effect>, {load}, Effect::in_time});
}

#define CDOT_INSTANTIATE(S)                            \
  template void add_bond(BasicWorld<S>&, const Bond&); \
  template void set_breaking_load(BasicWorld<S>&, int, double);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
