#include "runtime/tool/watch/parted_blows.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/events/guarded.hpp"

namespace cdot {
namespace {

// Friction that a blow loads exceeds that of forces by this factor at least; else it hardly counts.
constexpr double of_blow = 10;

// RATTLE takes such a blow in one step, and others locate it.
template <class S>
bool parts_blows(const WorldData<S>& world, const Island<S>& island) {
  const bool whole = world.settings.integrator == Integrator::rattle && island.solver->exact;
  return !island.loads.empty() && !island.asleep && !island.flow.locates && !whole;
}

// Of the largest speed, or of the motor's: less is an error of steps.
constexpr double slight_speed = 1e-3;

// The largest speed of a body and of its turns, in either unit: a coordinate has one of both.
template <class S>
double largest_speed(const WorldData<S>& world, const Island<S>& island) {
  double most = 0;
  for (int i : island.bodies) {
    typename S::Scalar v[S::freedom];
    S::write(world.bodies.velocity[i], v);
    const auto size = static_cast<double>(island.size);
    for (int k = 0; k < S::freedom; ++k)
      most = std::max({most, std::abs(double(v[k])), std::abs(double(v[k])) * (k < S::lengths ? 1 / size : size)});
  }
  return most;
}

// True if ends may stop a motor of unlimited force, and nothing that moves in time may push it back.
template <class S>
bool motor_may_press(const Island<S>& island) {
  const auto moves = [](const Segment<S>& segment) {
    return segment.batch->driven() && (!segment.batch->law || segment.batch->law->error);
  };
  return has_unlimited_motor_beside_ends(island) && std::ranges::none_of(island.segments, moves);
}

}  // namespace

template <class S>
void SlipWatch::look(BasicWorld<S>& world, double time) {
  const WorldData<S>& data = world.data();
  const auto parts = [&](const auto& island) { return parts_blows(data, island); };
  if (found_.joint >= 0 || std::ranges::none_of(data.islands, parts)) return;
  struck_.look(data);
  since_.resize(data.islands.size(), 0);
  ++newest_;
  std::size_t k = 0;
  for (std::size_t n = 0; n < data.islands.size(); ++n) {
    const Island<S>& island = data.islands[n];
    since_[n] = struck_[static_cast<int>(n)] ? 0 : since_[n] + 1;
    if (of_rows_.size() < k + island.loads.size()) of_rows_.resize(k + island.loads.size());
    for (const LoadedRow<S>& row : island.loads) {
      const Batch<S>& batch = *row.batch;
      Impulses& impulses = of_rows_[k++];
      const int i = row.place();
      impulses[newest_ % impulses.size()] = double(batch.lambda[i]) + double(batch.correction[i]);
      if (parts(island) && since_[n] == 2 && found_.joint < 0 && turns_round(impulses, newest_))
        found_ = {static_cast<int>(batch.joint[i / batch.ops->rows]), time};
    }
  }
}

bool SlipWatch::turns_round(const Impulses& impulses, std::size_t newest) {
  const auto ago = [&](std::size_t steps) { return impulses[(newest - steps) % impulses.size()]; };
  const auto larger = [&](std::size_t a, std::size_t b) { return std::max(std::abs(ago(a)), std::abs(ago(b))); };
  return ago(0) * ago(3) < 0 && larger(1, 2) > of_blow * larger(0, 3);
}

template <class S>
void YieldWatch<S>::look(BasicWorld<S>& world, double time) {
  const WorldData<S>& data = world.data();
  if (works_on_accelerations(data.settings.integrator) || !(data.last_step > 0)) return;
  for (const Island<S>& island : data.islands)
    if (found_.joint < 0 && !island.asleep && motor_may_press(island)) look_at(data, island, time);
}

template <class S>
void YieldWatch<S>::look_at(const WorldData<S>& world, const Island<S>& island, double time) {
  using T = typename S::Scalar;
  const double largest = largest_speed(world, island);
  each_guarded_slot(island, [&](Batch<S>& batch, int slot) {
    if (batch.law->error || batch.ops->rows > 1 || found_.joint >= 0) return;
    Guard<T> guard;
    batch.law->guard(batch, slot, &guard);
    if (!guard.bilateral() || !guard.of_rate) return;
    rates_.resize(batch.rate.size());
    batch.ops->velocity(batch, slot, slot + 1, world.bodies.velocity.data(), rates_.data());
    const double rate = double(rates_[static_cast<std::size_t>(slot)]), wanted = double(guard.rate);
    const double back = wanted > 0 ? -rate : wanted < 0 ? rate : 0;
    if (back > slight_speed * std::max(largest, std::abs(wanted)))
      found_ = {static_cast<int>(batch.joint[slot]), back, time};
  });
}

#define CDOT_INSTANTIATE(S)                              \
  template void SlipWatch::look(BasicWorld<S>&, double); \
  template class YieldWatch<S>;
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
