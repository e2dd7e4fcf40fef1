// A World inside: its Model, its State and its Workspace, joined so that the stages which step() lists find what they
// work on in one place. Nobody outside runtime/ includes this.
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

// Numbers that an integrator carries from one stage of a step to the next, and from step to step.
template <class S>
struct Flow : FlowState<S>, FlowWorkspace<S> {};

// Bodies that push each other through joints and springs: solved together, and asleep together.
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
  std::vector<std::byte> before;  // the step: of a step that fails
};

// One of a joint's bodies that can move, in whose island it is; -1: none can.
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

// `place` counted from the origin (sign -1), or back in the world (1).
template <class Place>
Place moved_by(Place place, const std::array<double, 3>& origin, double sign) {
  place.x += sign * origin[0];
  place.y += sign * origin[1];
  if constexpr (requires { place.z; }) place.z += sign * origin[2];
  return place;
}

// The ground stands at the origin, whatever that is: its points are counted from there as well.
template <class S>
typename S::Place place_in_world(const WorldData<S>& world, int body) {
  const auto place = S::place_of(world.bodies.pose.at(static_cast<size_t>(body)));
  return body == world.ground ? place : moved_by(place, world.origin, 1);
}

}  // namespace cdot
