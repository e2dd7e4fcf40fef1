// The queries of a World. They do not influence the next step.
#include <cmath>
#include <cstring>

#include <cdot/world.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/direct/weakest_row.hpp"
#include "runtime/rows/parameters.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/state/add_rows.hpp"
#include "runtime/state/one_slot.hpp"
#include "runtime/state/probe.hpp"

namespace cdot {
namespace {

// A NaN exceeds every number: an error measure that ignored NaN would pass a World that exploded.
bool beats(double value, double worst) { return !std::isnan(worst) && !(value <= worst); }

// A thread's scratch for queries: they are asked after every step, and allocating takes longer than their answers.
template <class S>
Probe<S>& probe_of(const WorldData<S>& world) {
  thread_local Probe<S> probe(world);
  probe.move_to(world);
  return probe;
}
template <class S>
Batch<S>& scratch_slot() {
  thread_local Batch<S> one_slot;
  return one_slot;
}

// The largest value(probe, row, kind) over all joints that are neither soft nor broken, after look(probe, joint).
template <class S, class L, class F>
WorstError worst_of(const WorldData<S>& world, L look, F value) {
  WorstError worst;
  Probe<S>& probe = probe_of(world);
  for (size_t j = 0; j < world.joints.size(); ++j) {
    const JointRecord& joint = world.joints[j];
    if (joint.broken || is_soft(world, joint)) continue;
    look(probe, joint);
    const auto& kinds = joint_types(S::dimension)[joint.type].row_kinds;
    for (int r = 0; r < probe.rows(); ++r) {
      const double size = std::abs(value(probe, r, kinds[r]));
      if (worst.joint < 0 || beats(size, worst.value)) worst = {size, static_cast<int>(j), r};
    }
  }
  return worst;
}

// f(passed), a PassedEnd, for each row of an effect that is beyond its end.
template <class S, class F>
void for_each_passed_end(const WorldData<S>& world, F f) {
  Batch<S>& one_slot = scratch_slot<S>();
  for (const auto& batch : world.batches) {
    if (!batch->law || batch->law->reported || !batch->law->error) continue;
    for (int slot = 0; slot < batch->count(); ++slot) {
      if (world.joints[batch->joint[slot]].broken) continue;
      copy_slot(*batch, slot, one_slot);
      batch->ops->position(one_slot, 0, 1, world.bodies, typename S::Scalar(world.time));
      typename S::Scalar error[most_rows];
      batch->law->error(one_slot, 0, error);
      for (int r = 0; r < batch->ops->rows; ++r)
        if (error[r] != 0) f(PassedEnd{std::abs(double(error[r])), batch->joint[slot], world.sources[batch->source]});
    }
  }
}

template <class S>
double position_violation(const Probe<S>& probe, int row, RowKind kind) {
  const double C = probe.C(row);
  return kind == RowKind::inequality && C > 0 ? 0.0 : C;
}

template <class T>
std::vector<double> in_doubles(const std::vector<T>& numbers) {
  return {numbers.begin(), numbers.end()};
}

}  // namespace

template <class S>
double BasicWorld<S>::time() const {
  return data_->time;
}
template <class S>
const Settings& BasicWorld<S>::settings() const {
  return data_->settings;
}
template <class S>
const std::vector<Note>& BasicWorld<S>::notes() const {
  return data_->notes;
}
template <class S>
int BasicWorld<S>::body_count() const {
  return data_->bodies.count();
}
template <class S>
typename S::Pose BasicWorld<S>::pose(int body) const {
  return data_->bodies.pose.at(body);
}
template <class S>
typename S::Place BasicWorld<S>::place(int body) const {
  return place_in_world(*data_, body);
}

template <class S>
typename S::Velocity BasicWorld<S>::velocity(int body) const {
  return data_->bodies.velocity.at(body);
}
template <class S>
typename S::InverseMass BasicWorld<S>::inverse_mass(int body) const {
  return data_->bodies.inverse_mass.at(body);
}
template <class S>
bool BasicWorld<S>::is_static(int body) const {
  return S::immovable(inverse_mass(body));
}
template <class S>
bool BasicWorld<S>::asleep(int body) const {
  if (!data_->prepared) return false;
  const int island = data_->island_of.at(body);
  return island >= 0 && data_->islands[island].asleep;
}
template <class S>
int BasicWorld<S>::joint_count() const {
  return static_cast<int>(data_->joints.size());
}
template <class S>
const JointType& BasicWorld<S>::joint_type(int joint) const {
  return joint_types(S::dimension)[data_->joints.at(joint).type];
}
template <class S>
std::vector<int> BasicWorld<S>::joint_bodies(int joint) const {
  return data_->joints.at(joint).bodies;
}
template <class S>
std::vector<double> BasicWorld<S>::joint_parameters(int joint) const {
  const JointRecord& record = data_->joints.at(joint);
  std::vector<double> numbers = record.parameters;
  for (const auto& [place, drive] : record.drives)
    if (place < 0) numbers[static_cast<size_t>(drive.number)] = drive.profile.at(data_->time).value + drive.offset;
  move_world_points(
      joint_types(S::dimension)[record.type], record.bodies, [&](int body) { return body == data_->ground; },
      data_->origin, 1, numbers);
  return numbers;
}
template <class S>
bool BasicWorld<S>::broken(int joint) const {
  return data_->joints.at(joint).broken;
}

template <class S>
std::vector<double> BasicWorld<S>::position_error(int joint) const {
  Probe<S>& probe = probe_of(*data_);
  probe.look_at_C(data_->joints.at(joint));
  std::vector<double> C;
  for (int r = 0; r < probe.rows(); ++r) C.push_back(probe.C(r));
  return C;
}

template <class S>
std::vector<double> BasicWorld<S>::velocity_error(int joint) const {
  Probe<S>& probe = probe_of(*data_);
  probe.look_at(data_->joints.at(joint));
  return in_doubles(probe.Cdot());
}

template <class S>
std::vector<double> BasicWorld<S>::impulse(int joint) const {
  return in_doubles(total_impulse(*data_, data_->joints.at(joint)));
}

template <class S>
typename S::Wrench BasicWorld<S>::reaction(int joint, int body) const {
  const JointRecord& record = data_->joints.at(joint);
  Wrench sum;
  if (data_->last_step <= 0) return sum;
  Probe<S>& probe = probe_of(*data_);
  probe.look_at(record);
  const auto lambda = total_impulse(*data_, record);
  for (size_t k = 0; k < record.bodies.size(); ++k) {
    if (record.bodies[k] != body) continue;
    S::add(sum, probe.impulse_on(static_cast<int>(k), lambda), data_->last_step);
  }
  return sum;
}

template <class S>
double BasicWorld<S>::coordinate(int joint, std::string_view name) const {
  const JointRecord& record = data_->joints.at(joint);
  Probe<S>& probe = probe_of(*data_);
  probe.look_at(record, coordinate_index<S>(record.type, name));
  return probe.C(0);
}

template <class S>
double BasicWorld<S>::coordinate_rate(int joint, std::string_view name) const {
  const JointRecord& record = data_->joints.at(joint);
  Probe<S>& probe = probe_of(*data_);
  probe.look_at(record, coordinate_index<S>(record.type, name));
  return probe.Cdot()[0];
}

template <class S>
WorstError BasicWorld<S>::worst_position_error() const {
  return worst_of(
      *data_, [](Probe<S>& probe, const JointRecord& joint) { probe.look_at_C(joint); }, position_violation<S>);
}

template <class S>
PassedEnd BasicWorld<S>::worst_passed_end() const {
  PassedEnd worst;
  for_each_passed_end(*data_, [&](const PassedEnd& end) {
    if (beats(end.by, worst.by)) worst = end;
  });
  return worst;
}

template <class S>
std::vector<PassedEnd> BasicWorld<S>::passed_ends(double tolerance) const {
  std::vector<PassedEnd> found;
  for_each_passed_end(*data_, [&](const PassedEnd& end) {
    if (!(end.by <= tolerance)) found.push_back(end);
  });
  return found;
}

template <class S>
WorstError BasicWorld<S>::worst_velocity_error() const {
  return worst_of(
      *data_, [](Probe<S>& probe, const JointRecord& joint) { probe.look_at(joint); },
      [](Probe<S>& probe, int row, RowKind kind) {
        return kind == RowKind::inequality ? 0.0 : double(probe.Cdot()[row]);
      });
}

template <class S>
std::vector<Inconsistency> BasicWorld<S>::inconsistencies(double tolerance) const {
  std::vector<Inconsistency> found;
  Probe<S>& probe = probe_of(*data_);
  for (int j = 0; j < joint_count(); ++j) {
    const JointRecord& joint = data_->joints[j];
    if (joint.broken || is_soft(*data_, joint)) continue;
    probe.look_at(joint);
    const auto& kinds = joint_type(j).row_kinds;
    const auto& Cdot = probe.Cdot();
    for (int r = 0; r < probe.rows(); ++r) {
      const double C = position_violation(probe, r, kinds[r]), rate = Cdot[r];
      // An inequality with C > 0 may close; one at C = 0 may only open.
      const bool held = kinds[r] != RowKind::inequality || (probe.C(r) <= tolerance && rate < 0);
      if (!(std::abs(C) <= tolerance)) found.push_back({j, r, false, C});
      if (held && !(std::abs(rate) <= tolerance)) found.push_back({j, r, true, rate});
    }
  }
  return found;
}

template <class S>
double BasicWorld<S>::energy() const {
  return energy_of(*data_, scratch_slot<S>()).sum();
}

template <class S>
Balance BasicWorld<S>::balance() const {
  return balance_of(*data_, energy_of(*data_, scratch_slot<S>()), true);
}

template <class S>
std::vector<WorkOfSource> BasicWorld<S>::work_by_source() const {
  const WorldData<S>& world = *data_;
  const Accounts& accounts = world.accounts;
  std::vector<WorkOfSource> sources;
  for (size_t k = 0; k < accounts.by_source.size(); ++k) {
    double work = accounts.by_source[k];
    if (k == static_cast<size_t>(Source::outside) && accounts.changed) {
      const Energy now = energy_of(world, scratch_slot<S>());
      work += now.kinetic + now.potential - accounts.before_change;
    }
    for (const Island<S>& island : world.islands)
      each_work(island, [&](size_t source, double done) { work += source == k ? done : 0; });
    if (work != 0) sources.push_back({world.sources[k], work});
  }
  return sources;
}

template <class S>
int BasicWorld<S>::redundant_rows() const {
  int sum = 0;
  for (const auto& island : data_->islands) sum += island.redundant_rows;
  return sum;
}
template <class S>
const StepCounts& BasicWorld<S>::step_counts() const {
  return data_->counts;
}
template <class S>
int BasicWorld<S>::island_count() const {
  return static_cast<int>(data_->islands.size());
}
template <class S>
WeakestRow BasicWorld<S>::weakest_row() const {
  WeakestRow weakest;
  for (auto& island : data_->islands) {
    if (!island.solver || !island.solver->exact || !island.system.built()) continue;
    if (const WeakestRow row = cdot::weakest_row(island.system); row.share < weakest.share) weakest = row;
  }
  return weakest;
}

template <class S>
int BasicWorld<S>::sleeping_islands() const {
  return island_count() - static_cast<int>(data_->awake.size());
}

// FNV-1a over the bytes of poses and velocities.
template <class S>
std::uint64_t BasicWorld<S>::hash() const {
  std::uint64_t hash = 14695981039346656037ull;
  const auto add = [&](const auto& items) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(items.data());
    for (size_t i = 0; i < items.size() * sizeof(items[0]); ++i) hash = (hash ^ bytes[i]) * 1099511628211ull;
  };
  add(data_->bodies.pose);
  add(data_->bodies.velocity);
  return hash;
}

#define CDOT_INSTANTIATE(S) template class BasicWorld<S>;
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
