// Saving, restoring and comparing a World's state: three visitors of the one list in state/snapshot_list.hpp.
#include <cstring>
#include <fmt/format.h>
#include <type_traits>

#include <cdot/methods.hpp>
#include <cdot/snapshot.hpp>
#include <cdot/world.hpp>

#include "runtime/number/hash.hpp"
#include "runtime/state/snapshot_list.hpp"
#include "runtime/world/islands.hpp"

namespace cdot {
namespace {

// The letter of Snapshot::Item::type; what is a struct consists of numbers of type T.
template <class Number, class T>
constexpr char type_of() {
  if constexpr (std::is_same_v<Number, double>) return 'd';
  if constexpr (std::is_same_v<Number, float>) return 'f';
  if constexpr (std::is_same_v<Number, int>) return 'i';
  if constexpr (std::is_same_v<Number, long long>) return 'l';
  if constexpr (std::is_class_v<Number>) return type_of<T, T>();
  static_assert(std::is_class_v<Number> || std::is_arithmetic_v<Number> || sizeof(Number) == 1);
  return 'c';
}

// What visitors have in common: a vector is its numbers. Own::numbers(type, address, count) does the rest.
template <class T, class Own>
struct Visitor {
  template <class Number>
  void operator()(std::vector<Number>& array) {
    add(array.data(), array.size());
  }
  template <class Number>
  void operator()(Number& number) {
    add(&number, 1);
  }

 private:
  template <class Number>
  static constexpr std::size_t size_of_one() {
    constexpr std::size_t size = std::is_class_v<Number> ? sizeof(T) : sizeof(Number);
    static_assert(sizeof(Number) % size == 0);
    return size;
  }
  template <class Number>
  void add(Number* first, std::size_t count) {
    static_cast<Own&>(*this).numbers(type_of<Number, T>(), first, count * sizeof(Number) / size_of_one<Number>());
  }
};

// The names and sizes of all arrays.
template <class T>
struct Layout : Visitor<T, Layout<T>> {
  std::vector<Snapshot::Item> items;
  std::size_t bytes = 0;
  void item(const char* name, int index) {
    items.push_back({index < 0 ? std::string(name) : fmt::format("{}[{}]", name, index), 'c', 0});
  }
  void numbers(char type, const void*, std::size_t count) {
    items.back().type = type;
    items.back().count += count;
    bytes += count * Snapshot::size_of(type);
  }
};

// Copies between the World and the bytes of a snapshot, as long as its items are those of the World: `fits` says.
template <class T, bool save>
struct Copy : Visitor<T, Copy<T, save>> {
  using Byte = std::conditional_t<save, std::byte, const std::byte>;
  const std::vector<Snapshot::Item>& items;
  Byte* at;
  std::size_t next = 0, left = 0;
  bool fits = true;

  Copy(const std::vector<Snapshot::Item>& items, Byte* bytes) : items(items), at(bytes) {}
  void item(const char*, int) {
    fits &= left == 0 && next < items.size();
    if (fits) left = items[next++].count;
  }
  void numbers(char type, void* here, std::size_t count) {
    fits &= count <= left && (count == 0 || type == items[next - 1].type);
    if (!fits || count == 0) return;
    left -= count;
    const std::size_t bytes = count * Snapshot::size_of(type);
    if constexpr (save) std::memcpy(at, here, bytes);
    else std::memcpy(here, at, bytes);
    at += bytes;
  }
  bool all() const { return fits && left == 0 && next == items.size(); }
};

// Masses, and inertias in the bodies' frames: where those turn with the bodies, the ones in world axes are state.
template <class S>
std::uint64_t hash_of_bodies(const WorldState<S>& world) {
  Hash hash;
  for (const auto& m : world.bodies.inverse_mass) hash.add(m.m), hash.add(S::immovable(m));
  if constexpr (S::has_gyroscopes)
    for (const auto& gyroscope : world.gyroscopes) hash.add(gyroscope.body), hash.add(gyroscope.inertia);
  else hash.add(world.bodies.inverse_mass);
  return hash.value;
}

// Joints and effects as they were added, springs, drags, gravity. What they have been changed to since is state.
template <class S>
std::uint64_t hash_of_joints(const WorldState<S>& world) {
  Hash hash;
  for (const JointRecord& joint : world.joints) hash.add(joint.added);
  hash.add(world.springs);
  for (const Drag<S>& drag : world.drags) hash.add(drag.body), hash.add(drag.linear), hash.add(drag.angular);
  for (const auto& [joint, load] : world.breaking_loads) hash.add(joint), hash.add(load);
  hash.add(S::gravity(world.settings)), hash.add(world.origin);
  return hash.value;
}

// Where prepare_topology() put what. A broken joint's rows have changed places since, and their slots with them.
template <class S>
std::uint64_t hash_of_order(WorldState<S>& world) {
  Hash hash;
  hash.add(world.settings.solver), hash.add(world.settings.integrator), hash.add(world.settings.kernels);
  hash.add(world.island_of);
  for (Island<S>& island : world.islands) {
    for (const Segment<S>& segment : island.segments) hash.add(segment.begin);
    if (sweeps(world.settings.solver)) continue;
    for (const auto& block : island.system.blocks) hash.add(block.batch->joint[block.slot]), hash.add(block.first);
  }
  return hash.value;
}

template <class S>
std::string method_of(const Settings& settings) {
  return fmt::format("{} {}, {}, {}, {} kernels", S::dimension == Dimension::planar ? "planar" : "spatial",
                     std::is_same_v<typename S::Scalar, double> ? "double" : "float", name_of(solvers, settings.solver),
                     name_of(integrators, settings.integrator), name_of(kernel_forms, settings.kernels));
}

// Its method is left empty.
template <class S>
Snapshot::Origin origin_of(WorldState<S>& world) {
  return {{},
          world.bodies.count(),
          static_cast<int>(world.joints.size()),
          hash_of_bodies(world),
          hash_of_joints(world),
          hash_of_order(world)};
}

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

// Islands asleep are not on the list that step() walks.
template <class S>
void list_awake(WorldState<S>& world) {
  world.awake.clear();
  for (size_t k = 0; k < world.islands.size(); ++k)
    if (!world.islands[k].asleep) world.awake.push_back(static_cast<int>(k));
}

}  // namespace

struct SnapshotAccess {
  template <class S>
  static void save(WorldState<S>& world, Snapshot& to) {
    using T = typename S::Scalar;
    Snapshot::Origin origin = origin_of(world);
    if (same_hashes(origin, to.origin_)) {
      Copy<T, true> copy(to.items_, to.bytes_.data());
      StateList::each(world, copy);
      if (copy.all()) return;
    }
    to.origin_ = origin;
    to.origin_.method = method_of<S>(world.settings);
    Layout<T> layout;
    StateList::each(world, layout);
    to.items_ = layout.items;
    to.bytes_.resize(layout.bytes);
    Copy<T, true> copy(to.items_, to.bytes_.data());
    StateList::each(world, copy);
  }

  // Joints that broke before the state's World was prepared have no place in its order of rows.
  template <class S>
  static void prepare_with_broken_joints(WorldState<S>& world, const Snapshot& from) {
    const Snapshot::Item& item = from.items_[1];  // joints.broken
    const std::byte* broken = from.bytes_.data() + from.items_[0].count * Snapshot::size_of(from.items_[0].type);
    for (size_t k = 0; k < world.joints.size() && k < item.count; ++k)
      world.joints[k].broken = broken[k] != std::byte{0};
    world.prepared = false;
    prepare_topology(world);
  }

  template <class S>
  static bool load(WorldState<S>& world, const Snapshot& from) {
    using T = typename S::Scalar;
    Layout<T> layout;
    StateList::each(world, layout);
    if (origin_of(world).order != from.origin_.order || layout.items != from.items_) return false;
    Copy<T, false> copy(from.items_, from.bytes_.data());
    StateList::each(world, copy);
    list_awake(world);
    return true;
  }

  template <class S>
  static void restore(WorldState<S>& world, const Snapshot& from) {
    if (from.items_.size() < 2) throw Error("an empty snapshot is no state of a World");
    Snapshot::Origin origin = origin_of(world);
    origin.method = method_of<S>(world.settings);
    check_origin(from.origin_, origin);
    if (load(world, from)) return;
    Snapshot before;
    save(world, before);
    prepare_with_broken_joints(world, from);
    if (load(world, from)) return;
    prepare_with_broken_joints(world, before);
    load(world, before);
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
  for (std::size_t k = 0; k < std::max(items_.size(), other.items_.size()); ++k) {
    const bool both = k < items_.size() && k < other.items_.size() && items_[k] == other.items_[k];
    if (!both) {
      names.push_back(k < items_.size() ? items_[k].name : other.items_[k].name);
      return names;  // what follows cannot be paired
    }
    const std::size_t bytes = items_[k].count * Snapshot::size_of(items_[k].type);
    if (std::memcmp(bytes_.data() + here, other.bytes_.data() + there, bytes) != 0) names.push_back(items_[k].name);
    here += bytes, there += bytes;
  }
  return names;
}

template <class S>
void BasicWorld<S>::snapshot_into(Snapshot& snapshot) const {
  prepare_topology(*state_);
  SnapshotAccess::save(*state_, snapshot);
}

template <class S>
Snapshot BasicWorld<S>::snapshot() const {
  Snapshot snapshot;
  snapshot_into(snapshot);
  return snapshot;
}

template <class S>
void BasicWorld<S>::restore(const Snapshot& snapshot) {
  prepare_topology(*state_);
  SnapshotAccess::restore(*state_, snapshot);
}

#define CDOT_INSTANTIATE(S)                                    \
  template void BasicWorld<S>::snapshot_into(Snapshot&) const; \
  template Snapshot BasicWorld<S>::snapshot() const;           \
  template void BasicWorld<S>::restore(const Snapshot&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
