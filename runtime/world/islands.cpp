// Joints and springs -> islands: union-find over movable bodies, then the slots of every batch sorted by island and
// within an island by sweep order.
#include "runtime/world/islands.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

#include <cdot/joints.hpp>
#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/events/latch.hpp"
#include "runtime/solve/loads.hpp"
#include "runtime/solve/misfits.hpp"
#include "runtime/solve/rivals.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/solve/tension.hpp"
#include "runtime/state/state_list.hpp"
#include "runtime/step/integrators.hpp"
#include "runtime/world/sweep_order.hpp"

namespace cdot {
namespace {

// The representative of a set is its smallest body, so the numbers of islands do not depend on the joints' order.
struct Sets {
  explicit Sets(int n) : parent(static_cast<size_t>(n)) { std::iota(parent.begin(), parent.end(), 0); }
  int find(int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  }
  void unite(int i, int j) {
    i = find(i);
    j = find(j);
    parent[std::max(i, j)] = std::min(i, j);
  }
  std::vector<int> parent;
};

template <class S>
void unite_bodies(const WorldData<S>& world, Sets& sets) {
  const auto unite = [&](const std::vector<int>& bodies) {
    int first = -1;
    for (int body : bodies) {
      if (world.bodies.immovable(body)) continue;
      if (first >= 0) sets.unite(first, body);
      first = body;
    }
  };
  for (const JointRecord& joint : world.joints)
    if (!joint.broken) unite(joint.bodies);
}

template <class S>
void number_islands(WorldData<S>& world) {
  const int n = world.bodies.count();
  Sets sets(n);
  unite_bodies(world, sets);
  world.islands.clear();
  world.island_of.assign(static_cast<size_t>(n), -1);
  for (int body = 0; body < n; ++body) {
    if (world.bodies.immovable(body)) continue;
    const int root = sets.find(body);
    if (root == body) {
      world.island_of[body] = static_cast<int>(world.islands.size());
      world.islands.emplace_back();
    }
    world.island_of[body] = world.island_of[root];
    world.islands[world.island_of[body]].bodies.push_back(body);
  }
}

// Permutes StateArrays by slot. The Workspace needs no permutation: a step recomputes it.
struct Permute {
  const std::vector<int>& order;
  void item(const char*, int, bool) {}
  template <class Number>
  void operator()(StateArray<Number>& column) {
    if (column.empty()) return;
    const size_t width = column.size() / order.size();
    const std::vector<Number> before(column.begin(), column.end());
    auto to = column.begin();
    for (int from : order) to = std::copy_n(before.begin() + static_cast<std::ptrdiff_t>(from * width), width, to);
  }
};

template <class S>
int island_of_slot(const WorldData<S>& world, const Batch<S>& batch, int slot) {
  for (int k = 0; k < batch.ops->bodies; ++k) {
    const int island = world.island_of[batch.body[slot * batch.ops->bodies + k]];
    if (island >= 0) return island;
  }
  return -1;  // unreachable: blocks between immovable bodies are never added
}

// Sorts slots by island and then by `places` of their joints, with broken joints last.
template <class S>
void sort_slots(WorldData<S>& world, int index, const std::vector<int>& places) {
  Batch<S>& batch = *world.batches[index];
  std::vector<std::tuple<int, bool, int>> key;
  for (int slot = 0; slot < batch.count(); ++slot) {
    const int joint = batch.joint[slot];
    key.emplace_back(island_of_slot(world, batch, slot), world.joints[joint].broken, places[joint]);
  }
  std::vector<int> order(key.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return key[i] < key[j]; });
  Permute permute{order};
  StateList::each_slot(batch, index, true, permute);

  std::vector<int> now(order.size());  // by home before
  for (size_t slot = 0; slot < order.size(); ++slot) {
    now[batch.home[slot]] = static_cast<int>(slot);
    batch.home[slot] = batch.slot_of[slot] = static_cast<int>(slot);
  }
  for (JointRecord& joint : world.joints)
    for (Place& place : joint.places)
      if (place.batch == index) place.home = now[place.home];
}

// The numbers in time of each slot, from the joints.
template <class S>
void hand_out_drives(WorldData<S>& world) {
  std::vector<std::vector<std::vector<Drive>>> by_home;  // by batch
  for (const auto& batch : world.batches) by_home.emplace_back(static_cast<size_t>(batch->count()));
  for (const JointRecord& joint : world.joints)
    for (const JointDrive& drive : joint.drives)
      for (size_t k = 0; k < joint.places.size(); ++k)
        if (drive.place < 0 || static_cast<size_t>(drive.place) == k)
          by_home[joint.places[k].batch][joint.places[k].home].push_back(drive.drive);
  for (size_t i = 0; i < world.batches.size(); ++i) {
    Batch<S>& batch = *world.batches[i];
    batch.drives.clear(), batch.first_drive.assign(1, 0);
    for (const std::vector<Drive>& drives : by_home[i]) {
      batch.drives.insert(batch.drives.end(), drives.begin(), drives.end());
      batch.first_drive.push_back(static_cast<int>(batch.drives.size()));
    }
    for (Drive& drive : batch.drives) drive.now = drive.profile.at(world.time);
    constexpr ProfileSpan always;
    while (batch.driven() && batch.spans.size() < 2 * by_home[i].size())
      batch.spans.push_back(always.from), batch.spans.push_back(always.until);
  }
}

// Lists runs of slots of one batch that are consecutive in the sweep. Rows under a law come first: the rows solved last
// have the smallest error, and these should be the joints.
template <class S>
void list_segments(WorldData<S>& world, const std::vector<int>& places) {
  struct Run {
    bool joint;  // no law
    int place, batch, slot;
    bool operator<(const Run& other) const {
      return std::tie(joint, place, batch, slot) < std::tie(other.joint, other.place, other.batch, other.slot);
    }
  };
  std::vector<Run> runs;
  for (size_t i = 0; i < world.batches.size(); ++i) {
    const Batch<S>& batch = *world.batches[i];
    for (int slot = 0; slot < batch.count(); ++slot)
      if (!world.joints[batch.joint[slot]].broken)
        runs.push_back({batch.law == nullptr, places[batch.joint[slot]], static_cast<int>(i), slot});
  }
  std::sort(runs.begin(), runs.end());
  for (const Run& run : runs) {
    Batch<S>& batch = *world.batches[run.batch];
    Island<S>& island = world.islands[island_of_slot(world, batch, run.slot)];
    auto& segments = island.segments;
    if (!segments.empty() && segments.back().batch == &batch && segments.back().end == run.slot)
      segments.back().whole_end = ++segments.back().end;
    else segments.push_back({&batch, run.slot, run.slot + 1, run.slot + 1});
    island.restless |= batch.ops->explicit_time || (batch.law && batch.law->in_time) ||
                       (batch.driven() && !batch.drives_of(run.slot).empty());
  }
}

template <class S>
void give_out_forces(WorldData<S>& world) {
  for (const auto& drag : world.drags) world.islands[world.island_of[drag.body]].drags.push_back(drag);
  if constexpr (S::has_gyroscopes)
    for (size_t i = 0; i < world.turning.size(); ++i)
      world.islands[world.island_of[world.turning[i]]].gyroscopes.push_back(static_cast<int>(i));
}

// `at`: scratch for poses, those of the World until the island is built.
template <class S>
void build_systems(const WorldData<S>& world, Island<S>& island, Bodies<S>& at) {
  const std::vector<int> tensions = tension_rows(world, island, at);
  island.system.build(island.segments, world.bodies, island.stiffened ? tensions : std::vector<int>{});
  if (!island.stiffened && !tensions.empty()) island.rescue.build(island.segments, world.bodies, tensions);
}

template <class S>
void list_bonds(WorldData<S>& world) {
  for (std::size_t k = 0; k < world.bonds.size(); ++k) {
    const JointRecord& record = world.joints[world.bonds[k].joint];
    Island<S>& island = world.islands[world.island_of[movable_body(world, record)]];
    island.bonds.push_back(static_cast<int>(k));
    island.restless |= world.bonds[k].in_time && !record.broken;
  }
}

}  // namespace

template <class S>
void prepare_topology(WorldData<S>& world) {
  if (world.prepared) return;
  for (JointRecord& joint : world.joints) joint.left_out = bool(joint.broken);
  for (Island<S>& island : world.islands) book_work(world, island);
  number_islands(world);
  list_bonds(world);
  // The direct solver has its own order, so each type of joint is one run, in the order of add_joint().
  const std::vector<int> places =
      sweeps(world.settings.solver) ? sweep_places(world) : std::vector<int>(world.joints.size(), 0);
  for (int i = 0; i < static_cast<int>(world.batches.size()); ++i) sort_slots(world, i, places);
  hand_out_drives(world);
  list_segments(world, places);
  give_out_forces(world);
  for (Island<S>& island : world.islands) measure_size(world, island);
  prepare_accounts(world);
  world.awake.clear();
  Bodies<S> at;
  at.pose = world.bodies.pose;
  for (int i = 0; i < static_cast<int>(world.islands.size()); ++i) {
    Island<S>& island = world.islands[i];
    island.solver = &solver_of<S>(world.settings.solver);
    island.stiffened = row_of(world.settings.integrator).stiffens;
    if (world.needs_systems()) build_systems(world, island, at);
    if (!island.bonds.empty() || ends_by_load(island))  // among redundant joints
      for (System<S>* system : {&island.system, &island.rescue}) system->share_loads();
    if (world.needs_systems() && world.settings.drift == Drift::projection) reserve_errors(island);
    list_loads(world, island);
    if (sweeps(world.settings.solver)) list_rivals(island);
    stepper_of<S>(world.settings.integrator).prepare(island);
    world.awake.push_back(i);
  }
  watch_events(world);
  settle_state(world);
  world.prepared = true;
}

#define CDOT_INSTANTIATE(S) template void prepare_topology(WorldData<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
