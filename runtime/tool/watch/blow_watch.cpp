#include "runtime/tool/watch/blow_watch.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/events/bonds.hpp"
#include "runtime/events/impacts.hpp"
#include "runtime/events/latch.hpp"
#include "runtime/solve/direct.hpp"
#include "runtime/tool/watch/near_break.hpp"
#include "runtime/tool/watch/watched_ends.hpp"

namespace cdot {
namespace {

// Without the blow a load grows by at most so many times as much as in the step before.
constexpr double usual_growth = 2;

// A joint holds a blow for sure that is less than this share of its strength: how hard it is depends on when an end is
// met, which equal steps know less well than forces.
constexpr double surely_held = 0.5;

constexpr double broken = std::numeric_limits<double>::infinity();

// The mean over the last step.
template <class S>
double force_of(const WorldData<S>& world, const Batch<S>& batch, int i) {
  return (double(batch.lambda[i]) + double(batch.correction[i])) / world.last_step;
}

}  // namespace

template <class S>
void BlowWatch::look(BasicWorld<S>& world, double time) {
  const WorldData<S>& data = world.data();
  const auto torn = [](const auto& batch) { return tears(*batch); };
  if (found_.joint >= 0 || (data.bonds.empty() && std::ranges::none_of(data.batches, torn))) return;
  struck_.look(data);
  look_at_bonds(data, time);
  look_at_rows(data, time);
}

template <class S>
void BlowWatch::look_at_bonds(const WorldData<S>& world, double time) {
  of_bonds_.resize(world.bonds.size());
  for (std::size_t k = 0; k < world.bonds.size(); ++k) {
    const Bond& bond = world.bonds[k];
    const int island = island_of_joint(world, bond.joint);
    if (world.islands[island].flow.locates) continue;
    const double share = share_of_strength(distance_from_break(world, bond, time));
    const bool struck = struck_[island];
    if (share == broken && struck) note_break(bond.joint, of_bonds_[k], time);
    Forces forces{};
    const Place& place = world.joints[bond.joint].places[0];
    const Batch<S>& batch = *world.batches[place.batch];
    for (int r = 0; r < batch.ops->rows; ++r)
      forces[static_cast<std::size_t>(r)] = force_of(world, batch, slot_of(world, place) * batch.ops->rows + r);
    of_bonds_[k].add(forces, share, struck);
    if (const double load = of_bonds_[k].of_blow(world.last_step); load > 0)
      note_hold(bond.joint, share_of_strength(bond.distance(bond.parameters.data(), time, load)), time);
  }
}

template <class S>
void BlowWatch::look_at_rows(const WorldData<S>& world, double time) {
  using T = typename S::Scalar;
  of_rows_.resize(world.batches.size());
  for (std::size_t k = 0; k < world.batches.size(); ++k) {
    const Batch<S>& batch = *world.batches[k];
    if (!tears(batch)) continue;
    each_kept<S, Loads>(batch, of_rows_[k], 1, {}, [&](int slot, Loads* loads) {
      const int island = island_of_joint(world, batch.joint[slot]);
      const bool struck = struck_[island];
      const auto share_of = [&](double load) { return share_of_end(batch, slot, T(load)); };
      if (world.islands[island].flow.locates || !ends_by_load(batch, slot)) return;
      const bool torn = has_ended(batch, slot);
      if (torn && struck) note_break(batch.joint[slot], *loads, time);
      const double force = force_of(world, batch, slot);
      loads->add({force}, torn ? broken : share_of(force), struck);
      if (const double load = loads->of_blow(world.last_step); load > 0)
        note_hold(batch.joint[slot], share_of(load), time);
    });
  }
}

void BlowWatch::note_break(int joint, const Loads& loads, double time) {
  if (found_.joint < 0 && loads.without_blow() < 1) found_ = {joint, false, loads.share[0], time};
}

void BlowWatch::note_hold(int joint, double share, double time) {
  if (found_.joint < 0 && share >= surely_held) found_ = {joint, true, share, time};
}

void BlowWatch::Loads::add(const Forces& now, double share_now, bool struck) {
  forces[++newest % forces.size()] = now, share = {share_now, share[0]};
  since_blow = struck ? 0 : since_blow + 1;
}

// Infinite or unknown once it is broken, and in the first two steps.
double BlowWatch::Loads::without_blow() const { return share[0] + usual_growth * std::abs(share[0] - share[1]); }

// By the impulses of two steps beyond the forces before and afterwards.
double BlowWatch::Loads::of_blow(double h) const {
  if (since_blow != 2 || !std::isfinite(share[0])) return 0;
  double square = 0;
  for (std::size_t r = 0; r < most_rows; ++r) {
    const auto [least, most] = std::minmax(ago(0)[r], ago(3)[r]);
    double impulse = 0;
    for (const unsigned steps : {1, 2}) impulse += h * (ago(steps)[r] - std::clamp(ago(steps)[r], least, most));
    square += impulse * impulse;
  }
  return std::sqrt(square) / impact_time;
}

#define CDOT_INSTANTIATE(S) template void BlowWatch::look(BasicWorld<S>&, double);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
