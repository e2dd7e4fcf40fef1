// Saves, restores and compares the State of a World: its bytes and their Origin.
#include <algorithm>
#include <array>
#include <cstring>
#include <fmt/format.h>
#include <type_traits>

#include <cdot/methods.hpp>
#include <cdot/snapshot.hpp>
#include <cdot/world.hpp>

#include "runtime/state/world_data.hpp"
#include "runtime/world/islands.hpp"
#include "runtime/world/rollback.hpp"

namespace cdot {
namespace {

// FNV-1a by words of eight bytes in place of bytes: a run that estimates its error takes and restores snapshots, and
// most of their price was the fingerprint. The shift brings the high bits down, which products never reach.
struct WordHash {
  std::uint64_t value = 14695981039346656037ull;
  void bytes(const void* from, std::size_t count) {
    const auto* at = static_cast<const std::byte*>(from);
    for (; count > 0;) {
      std::uint64_t word = 0;
      const std::size_t size = std::min(count, sizeof word);
      std::memcpy(&word, at, size);
      value = (value ^ word) * 1099511628211ull;
      value ^= value >> 32;
      at += size, count -= size;
    }
  }
  template <class Number>
  void add(const Number& number) {
    bytes(&number, sizeof number);
  }
  template <class Number>
  void add(const std::vector<Number>& numbers) {
    add(numbers.size());
    bytes(numbers.data(), numbers.size() * sizeof(Number));
  }
};

// Hashes masses, and inertias in the bodies' frames: inertias in world axes are state.
template <class S>
std::uint64_t hash_of_bodies(const WorldData<S>& world) {
  WordHash hash;
  for (const auto& m : world.bodies.inverse_mass) hash.add(m.m), hash.add(S::immovable(m));
  if constexpr (S::has_gyroscopes)
    for (size_t k = 0; k < world.turning.size(); ++k) hash.add(world.turning[k]), hash.add(world.gyroscopes[k].inertia);
  else hash.bytes(world.bodies.inverse_mass.data(), world.bodies.inverse_mass.size() * sizeof(typename S::InverseMass));
  return hash.value;
}

// Hashes joints and effects as they were added, springs, drags and gravity. Later changes are state.
template <class S>
std::uint64_t hash_of_joints(const WorldData<S>& world) {
  WordHash hash;
  for (const JointRecord& joint : world.joints) hash.add(joint.added);
  for (const Drag<S>& drag : world.drags) hash.add(drag.body), hash.add(drag.linear), hash.add(drag.angular);
  for (const Bond& bond : world.bonds) {
    hash.add(bond.joint), hash.bytes(bond.type.data(), bond.type.size());
    for (const double number : bond.parameters) hash.add(number);
  }
  hash.add(S::gravity(world.settings)), hash.add(world.origin);
  return hash.value;
}

// Hashes the method and the order of rows. Rows of broken joints have changed slots, so it hashes the joint of each
// block: of the direct solver's, or of each slot's home.
template <class S>
std::uint64_t hash_of_order(WorldData<S>& world) {
  WordHash hash;
  hash.add(S::dimension), hash.add(sizeof(typename S::Scalar));
  hash.add(world.settings.solver), hash.add(world.settings.integrator), hash.add(world.settings.kernels);
  hash.add(world.island_of);
  for (Island<S>& island : world.islands) {
    for (const auto& [batch, begin, end, whole_end] : island.segments) {
      hash.add(begin);
      for (int home = begin; sweeps(world.settings.solver) && home < whole_end; ++home)
        hash.add(std::array{batch->ops->rows, batch->joint[batch->slot_of[home]]});
    }
    if (sweeps(world.settings.solver)) continue;
    for (const auto& block : island.system.blocks) hash.add(std::array{block.batch->joint[block.slot], block.first});
  }
  return hash.value;
}

template <class S>
std::string method_of(const Settings& settings) {
  return fmt::format("{} {}, {}, {}, {} kernels", S::dimension == Dimension::planar ? "planar" : "spatial",
                     std::is_same_v<typename S::Scalar, double> ? "double" : "float", name_of(solvers, settings.solver),
                     name_of(integrators, settings.integrator), name_of(kernel_forms, settings.kernels));
}

// Leaves Origin::method empty.
template <class S>
Snapshot::Origin origin_of(WorldData<S>& world) {
  return {{},
          world.bodies.count(),
          static_cast<int>(world.joints.size()),
          hash_of_bodies(world),
          hash_of_joints(world),
          hash_of_order(world)};
}

// Then methods and numbers of bodies and joints are the same as well.
bool same_hashes(const Snapshot::Origin& a, const Snapshot::Origin& b) {
  return a.bodies == b.bodies && a.joints == b.joints && a.order == b.order;
}

void check_origin(const Snapshot::Origin& state, const Snapshot::Origin& world) {
  if (state.method != world.method)
    throw Error(fmt::format("this is a state of {}, the World is {}", state.method, world.method));
  if (state.body_count != world.body_count || state.joint_count != world.joint_count)
    throw Error(fmt::format("this is a state of another mechanism: {} bodies and {} joints, the World has {} and {}",
                            state.body_count, state.joint_count, world.body_count, world.joint_count));
  if (state.bodies != world.bodies)
    throw Error(
        "this is a state of another mechanism: the masses or inertias of its bodies are not those of the World");
  if (state.joints != world.joints)
    throw Error(
        "this is a state of another mechanism: its joints, their parameters, effects, springs or gravity are not those "
        "of the World");
}

}  // namespace

struct SnapshotAccess {
  template <class S>
  static void save(WorldData<S>& world, Snapshot& to) {
    Snapshot::Origin origin = origin_of(world);
    if (!same_hashes(origin, to.origin_) || to.items_ != world.block.items) {
      to.origin_ = origin;
      to.origin_.method = method_of<S>(world.settings);
      to.items_ = world.block.items;
    }
    to.bytes_ = world.block.bytes;
  }

  // Analyses the islands without the joints that the snapshot's World left out. Joints that broke later are in its
  // order of rows.
  template <class S>
  static void prepare_as(WorldData<S>& world, const Snapshot& from) {
    const std::byte* at = from.bytes_.data();
    for (const Snapshot::Item& item : from.items()) {
      if (item.name == "joints.left_out")
        for (size_t k = 0; k < world.joints.size() && k < item.count; ++k)
          world.joints[k].broken = at[k] != std::byte{0};
      at += Snapshot::aligned(item.count * Snapshot::size_of(item.type));
    }
    world.prepared = false;
    prepare_topology(world);
  }

  template <class S>
  static bool load(WorldData<S>& world, const Snapshot& from, std::uint64_t order) {
    if (order != from.origin_.order || !from.has(*world.block.items)) return false;
    adopt_state(world, from.bytes_);
    return true;
  }

  template <class S>
  static void restore(WorldData<S>& world, const Snapshot& from) {
    if (from.empty()) throw Error("the snapshot is empty");
    Snapshot::Origin origin = origin_of(world);
    if (!same_hashes(origin, from.origin_)) {
      origin.method = method_of<S>(world.settings);
      check_origin(from.origin_, origin);
    }
    if (load(world, from, origin.order)) return;
    Snapshot before;
    save(world, before);
    prepare_as(world, from);
    if (load(world, from, hash_of_order(world))) return;
    prepare_as(world, before);
    load(world, before, hash_of_order(world));
    throw Error("this is a state of a World whose bodies and joints were added in another order");
  }
};

double Snapshot::time() const {
  double time = 0;
  if (bytes_.size() >= sizeof time) std::memcpy(&time, bytes_.data(), sizeof time);
  return time;
}

std::vector<std::string> Snapshot::differences(const Snapshot& other) const {
  std::vector<std::string> names;
  std::size_t here = 0, there = 0;
  const Items &mine = items(), &others = other.items();
  for (std::size_t k = 0; k < std::max(mine.size(), others.size()); ++k) {
    const bool both = k < mine.size() && k < others.size() && mine[k] == others[k];
    if (!both) {
      names.push_back(k < mine.size() ? mine[k].name : others[k].name);
      return names;  // later items have no counterpart
    }
    const std::size_t bytes = mine[k].count * Snapshot::size_of(mine[k].type);
    if (std::memcmp(bytes_.data() + here, other.bytes_.data() + there, bytes) != 0) names.push_back(mine[k].name);
    here = Snapshot::aligned(here + bytes), there = Snapshot::aligned(there + bytes);
  }
  return names;
}

template <class S>
void BasicWorld<S>::snapshot_into(Snapshot& snapshot) const {
  prepare_topology(*data_);
  SnapshotAccess::save(*data_, snapshot);
}

template <class S>
Snapshot BasicWorld<S>::snapshot() const {
  Snapshot snapshot;
  snapshot_into(snapshot);
  return snapshot;
}

template <class S>
void BasicWorld<S>::restore(const Snapshot& snapshot) {
  prepare_topology(*data_);
  SnapshotAccess::restore(*data_, snapshot);
}

#define CDOT_INSTANTIATE(S)                                    \
  template void BasicWorld<S>::snapshot_into(Snapshot&) const; \
  template Snapshot BasicWorld<S>::snapshot() const;           \
  template void BasicWorld<S>::restore(const Snapshot&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
