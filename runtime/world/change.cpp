// Removes joints and changes their parameters in a running World. effects/ changes effects.
#include <algorithm>

#include <cdot/world.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/rows/parameters.hpp"
#include "runtime/state/add_rows.hpp"
#include "runtime/state/checks.hpp"
#include "runtime/state/drives.hpp"
#include "runtime/state/probe.hpp"
#include "runtime/world/islands.hpp"

namespace cdot {
namespace {

// Writes the changed parameters to all rows of a joint. The other numbers stay, because a slot's parameters may include
// counted turns.
template <class S>
void hand_out(WorldData<S>& world, const JointRecord& record, const std::vector<const ParameterInfo*>& changed) {
  for (const Place& place : record.places) {
    Batch<S>& batch = *world.batches[place.batch];
    for (const ParameterInfo* info : changed)
      for (int k = info->offset; k < info->offset + info->size; ++k)
        batch.parameters[slot_of(world, place) * batch.ops->parameter_size + k] =
            typename S::Scalar(record.parameters[k]);
  }
}

// Throws Error if a coordinate with effects jumps at the new parameters.
template <class S>
void check_effects(const WorldData<S>& world, const JointRecord& record) {
  const auto& coordinates = joint_entries<S>()[record.type].coordinates;
  for (size_t k = 0; k < coordinates.size(); ++k)
    if (std::any_of(record.places.begin(), record.places.end(),
                    [&](const Place& place) { return coordinates[k].has(world.batches[place.batch]->ops); }))
      check_value(world, record, static_cast<int>(k));
}

}  // namespace

template <class S>
void BasicWorld<S>::remove_joint(int joint) {
  check_joint(*data_, joint);
  JointRecord& record = data_->joints[joint];
  if (record.broken) return;
  note_change(*data_);
  record.broken = true;
  if (record.companion >= 0) data_->joints[record.companion].broken = true;
  data_->prepared = false;  // its island may have split
}

template <class S>
void BasicWorld<S>::set_parameters(int joint, const std::vector<NamedValue>& parameters) {
  check_joint(*data_, joint);
  JointRecord& record = data_->joints[joint];
  const JointType& type = joint_types(S::dimension)[record.type];
  refuse_functions(parameters, "set_parameters()");
  refuse_driven(record, type, -1, parameters);
  std::vector<double> numbers = record.parameters;
  const auto changed = change_parameters(type, parameters, numbers);
  std::vector<double> moved = numbers;
  move_world_points(
      type, record.bodies, [&](int body) { return body == data_->ground; }, data_->origin, -1, moved);
  JointRecord next = record;
  for (const ParameterInfo* info : changed)
    std::copy_n(moved.begin() + info->offset, info->size, next.parameters.begin() + info->offset);
  check_rows(*data_, next, is_soft(*data_, record));
  check_effects(*data_, next);

  note_change(*data_);
  record.parameters = next.parameters;
  hand_out(*data_, record, changed);
  const int body = movable_body(*data_, record);
  if (!data_->prepared || body < 0) return;
  wake(*data_, body);
  measure_size(*data_, data_->islands[data_->island_of[body]]);
}

#define CDOT_INSTANTIATE(S)                       \
  template void BasicWorld<S>::remove_joint(int); \
  template void BasicWorld<S>::set_parameters(int, const std::vector<NamedValue>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
