// A World inside: its Model, State and Workspace in one struct, on which all stages of step() work. Private to
// runtime/.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include <cdot/detail/bodies.hpp>
#include <cdot/gyroscope.hpp>

#include "runtime/state/block.hpp"
#include "runtime/state/model.hpp"
#include "runtime/state/state.hpp"
#include "runtime/state/workspace.hpp"

namespace cdot {

struct JointRecord : JointModel, JointState {};

// State and Workspace of an integrator.
template <class S>
struct Flow : FlowState<S>, FlowWorkspace<S> {};

// Bodies that are connected by joints and springs. They are solved together and sleep together.
template <class S>
struct Island : IslandModel<S>, IslandState<S>, IslandWorkspace<S> {
  Flow<S> flow;
};

template <class S>
struct WorldData : Model<S>, State<S>, Workspace {
  using T = typename S::Scalar;
  Bodies<S> bodies;
  std::vector<JointRecord> joints;
  std::vector<std::unique_ptr<Batch<S>>> batches;
  std::vector<Island<S>> islands;
  Block block;
  std::vector<std::byte> before;  // the State before the step, for roll_back()
  // For the accounts (runtime/balance), by body: velocities at the start of a kick, and their mean over it.
  std::vector<typename S::Velocity> start_of_kick, mean_of_kick;
  std::vector<double> work_by_source, kept_by_source;  // scratch
  Batch<S> one_slot;                                   // in which the potential of rows is evaluated
  Bodies<S> few;                                       // those of one slot
};

// The joint's first movable body, which determines its island; -1: none.
template <class S>
int movable_body(const WorldData<S>& world, const JointRecord& record) {
  const auto body = std::find_if_not(record.bodies.begin(), record.bodies.end(),
                                     [&](int body) { return world.bodies.immovable(body); });
  return body == record.bodies.end() ? -1 : *body;
}

template <class S>
int slot_of(const WorldData<S>& world, const Place& place) {
  return world.batches[place.batch]->slot_of[place.home];
}

// `place` relative to the origin (sign -1), or back in world coordinates (1).
template <class Place>
Place moved_by(Place place, const std::array<double, 3>& origin, double sign) {
  place.x += sign * origin[0];
  place.y += sign * origin[1];
  if constexpr (requires { place.z; }) place.z += sign * origin[2];
  return place;
}

// The ground stands at the origin of poses, because its points are relative to that origin.
template <class S>
typename S::Place place_in_world(const WorldData<S>& world, int body) {
  const auto place = S::place_of(world.bodies.pose.at(static_cast<size_t>(body)));
  return body == world.ground ? place : moved_by(place, world.origin, 1);
}

}  // namespace cdot
