#include "runtime/state/add_rows.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

#include <cdot/detail/joint_table.hpp>
#include <cdot/spaces.hpp>

#include "runtime/state/checks.hpp"

namespace cdot {
namespace {

template <class S>
size_t source_named(WorldData<S>& world, std::string_view type) {
  const auto found = std::find(world.sources.begin(), world.sources.end(), type);
  if (found != world.sources.end()) return static_cast<size_t>(found - world.sources.begin());
  world.sources.push_back(type);
  return world.sources.size() - 1;
}

template <class S>
int find_batch(WorldData<S>& world, const BlockOps<S>* ops, const Law<S>* law, const std::vector<RowKind>& kinds,
               std::string_view source, bool own) {
  for (size_t i = 0; i < world.batches.size(); ++i)
    if (world.batches[i]->ops == ops && world.batches[i]->law == law) return static_cast<int>(i);
  world.batches.push_back(std::make_unique<Batch<S>>());
  world.batches.back()->ops = ops;
  world.batches.back()->law = law;
  world.batches.back()->kinds = kinds;
  world.batches.back()->source = source_named(world, source);
  world.batches.back()->own = own;
  return static_cast<int>(world.batches.size()) - 1;
}

template <class Item>
void grow(std::vector<Item>& array, int by, Item value = Item{}) {
  array.insert(array.end(), static_cast<size_t>(by), value);
}
template <class Item>
void grow(StateArray<Item>& column, int by, Item value = Item{}) {
  column.append(static_cast<size_t>(by), value);
}

}  // namespace

template <class S>
void add_rows(WorldData<S>& world, int joint, const BlockOps<S>* ops, const Law<S>* law, std::vector<RowKind> kinds,
              std::span<const double> constants, std::string_view source) {
  using T = typename S::Scalar;
  ops = ops->with(world.settings.kernels);
  JointRecord& record = world.joints[joint];
  const std::string_view type = joint_types(S::dimension)[static_cast<size_t>(record.type)].name;
  const int index = find_batch(world, ops, law, kinds, source.empty() ? type : source, record.places.empty());
  Batch<S>& batch = *world.batches[index];
  record.added.add(index), record.added.add(ops->rows), record.added.add(ops->bodies);
  record.added.bytes(constants.data(), constants.size_bytes());
  record.places.push_back({index, batch.count()});
  batch.home.push_back(batch.count());
  batch.slot_of.push_back(batch.count());
  batch.joint.push_back(joint);
  batch.body.append(record.bodies.begin(), record.bodies.end());
  for (int k = 0; k < ops->parameter_size; ++k) batch.parameters.push_back(T(record.parameters[k]));
  grow(batch.jacobian, ops->jacobian_size);
  grow(batch.factor, batch.triangle());
  grow(batch.lambda, ops->rows);
  grow(batch.correction, ops->rows);
  for (auto* array : {&batch.C, &batch.bias, &batch.rate, &batch.error, &batch.impulse}) grow(*array, ops->rows);
  if (law) {
    grow(batch.softness, ops->rows);
    grow(batch.lower, ops->rows, -std::numeric_limits<T>::infinity());
    grow(batch.upper, ops->rows, std::numeric_limits<T>::infinity());
    grow(batch.mode, ops->rows, Mode::bounded);
    grow(batch.load, 1);
    if (law->force) grow(batch.at_rest, ops->rows), grow(batch.acted, ops->rows);
    if (law->stores_part) grow(batch.unstored_at_rest, ops->rows);
    if (law->distance) grow(batch.happened, 1);
    for (double constant : constants) batch.constants.push_back(T(constant));
    if (!batch.spans.empty()) batch.spans.push_back(-unbounded), batch.spans.push_back(unbounded);
  }
  if (ops->start_counting) {
    grow(batch.counters, ops->counters);
    ops->start_counting(batch, batch.count() - 1, world.bodies, T(world.time));
  }
  world.prepared = false;
}

template <class S>
void check_joint(const WorldData<S>& world, int joint) {
  if (joint < 0 || joint >= static_cast<int>(world.joints.size()))
    throw Error(fmt::format("there is no joint number {}", joint));
}

template <class S>
int coordinate_index(int type, std::string_view name) {
  const JointType& joint = joint_types(S::dimension)[static_cast<size_t>(type)];
  std::string known;
  for (size_t k = 0; k < joint.coordinates.size(); ++k) {
    if (joint.coordinates[k].name == name) return static_cast<int>(k);
    known += fmt::format("{}`{}`", known.empty() ? "" : ", ", joint.coordinates[k].name);
  }
  throw Error(fmt::format("joint `{}` has no free coordinate `{}`; it has {}", joint.name, name,
                          known.empty() ? "none" : known));
}

namespace {

template <class S>
void note_once(WorldData<S>& world, int joint, std::string_view coordinate) {
  const std::string text = fmt::format("has effects on `{}`, which cannot change: they do nothing", coordinate);
  const bool known =
      std::ranges::any_of(world.notes, [&](const Note& note) { return note.joint == joint && note.text == text; });
  if (!known) world.notes.push_back({joint, text});
}

}  // namespace

template <class S>
int add_coordinate_row(WorldData<S>& world, int joint, std::string_view coordinate, const Law<S>* law,
                       std::span<const double> constants, std::string_view source) {
  check_joint(world, joint);
  JointRecord& record = world.joints[joint];
  const int index = coordinate_index<S>(record.type, coordinate);
  if (record.places.empty()) return -1;
  check_value(world, record, index);
  if (moves_nothing(world, record, index)) note_once(world, joint, coordinate);
  const auto& variants = joint_entries<S>()[record.type].coordinates[index];
  add_rows(world, joint, variants.choose(world.bodies, record.bodies), law, {RowKind::equality}, constants, source);
  return static_cast<int>(record.places.size()) - 1;
}

template <class S>
void add_bounded_rows(WorldData<S>& world, int joint) {
  const JointRecord& record = world.joints[joint];
  const JointEntry<S>& entry = joint_entries<S>()[record.type];
  constexpr double no_direction[1] = {};
  for (const BoundedEntry<S>& row : entry.bounded)
    add_rows(world, joint, entry.coordinates[row.coordinate].choose(world.bodies, record.bodies), row.law,
             {RowKind::equality}, {no_direction, static_cast<size_t>(row.law->constants)});
}

#define CDOT_INSTANTIATE(S)                                                                                     \
  template void add_rows(WorldData<S>&, int, const BlockOps<S>*, const Law<S>*, std::vector<RowKind>,           \
                         std::span<const double>, std::string_view);                                            \
  template int add_coordinate_row(WorldData<S>&, int, std::string_view, const Law<S>*, std::span<const double>, \
                                  std::string_view);                                                            \
  template void add_bounded_rows(WorldData<S>&, int);                                                           \
  template void check_joint(const WorldData<S>&, int);                                                          \
  template int coordinate_index<S>(int, std::string_view);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
