// Opens the accounts of a World, and books what changes it from outside.
#include <algorithm>
#include <tuple>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"

namespace cdot {
namespace {

// Whether energies of these rows may change with K. Of rows that are springs the numbers alone decide, and these only
// follow the time or change from outside; of an effect its C decides as well.
template <class S>
bool stiffens(const Segment<S>& segment) {
  const Batch<S>& batch = *segment.batch;
  if (!batch.law || !batch.law->by_mass || batch.law->is_of_effect() || batch.driven())
    return batch.law && batch.law->by_mass;
  for (int slot = segment.begin; slot < segment.end; ++slot)
    if (batch.law->by_mass(batch, slot)) return true;
  return false;
}

template <class S>
void find_stiffening(Island<S>& island) {
  island.by_mass = std::any_of(island.segments.begin(), island.segments.end(), stiffens<S>);
}

// True if an energy stores all work of these forces: of constant ones, and of effects that nothing damps or drives.
template <class S>
bool stores_all(const Batch<S>& batch) {
  if (!batch.law || !batch.law->force || batch.explicit_time() || batch.driven()) return false;
  const Law<S>& law = *batch.law;
  return law.is_of_effect() ? law.energy && !law.stores_part && !law.by_mass : !law.spring;
}

// Finds segments that may do work: those of exact rows do not.
template <class S>
void list_working(Island<S>& island) {
  island.working.clear();
  for (size_t k = 0; k < island.segments.size(); ++k) {
    const Batch<S>& batch = *island.segments[k].batch;
    if (batch.explicit_time() || (batch.law && !stores_all(batch))) island.working.push_back(k);
  }
}

template <class S>
bool is_driven(const Island<S>& island) {
  for (const Segment<S>& segment : island.segments) {
    const Batch<S>& batch = *segment.batch;
    const bool ends_move = batch.law && batch.law->guard && batch.law->error && batch.driven();
    if (ends_move || (!batch.law && batch.explicit_time())) return true;
  }
  return false;
}

template <class S>
size_t rows_with_bounds(const Island<S>& island) {
  int rows = 0;
  for (const auto& [batch, begin, end, whole] : island.segments)
    if (batch->law && batch->law->guard) rows += (end - begin) * batch->ops->rows;
  return static_cast<size_t>(rows);
}

}  // namespace

template <class S>
void prepare_accounts(WorldData<S>& world) {
  bool works = false;
  Bodies<S> at = world.bodies;
  for (Island<S>& island : world.islands) {
    list_working(island);
    find_stiffening(island);
    island.rows_work = !island.working.empty() || !island.drags.empty();
    island.works = island.rows_work || S::has_gyroscopes;
    island.driven = is_driven(island);
    island.flow.first_kick.assign(rows_with_bounds(island), 0);
    works |= island.works;
    find_free_motions(world, island, at);
    if (island.floats) island.momentum.assign(7, -1.0);
    if (works_on_accelerations(world.settings.integrator) && island.works)
      island.flow.work.assign(work_of_bodies + island.working.size(), 0);
  }
  world.accounts.by_source.append(world.sources.size() - world.accounts.by_source.size(), 0.0);
  world.work_by_source.resize(world.sources.size()), world.kept_by_source.resize(world.sources.size());
  const auto bodies = static_cast<size_t>(works ? world.bodies.count() : 0);
  world.start_of_kick.assign(bodies, {});
  world.mean_of_kick.assign(bodies, {});
  reserve(world, world.one_slot);
  world.few.pose.resize(most_bodies);
  world.few.effective_mass.resize(most_bodies);
}

template <class S>
void put_in(WorldData<S>& world, Source source, double work) {
  world.accounts.put_in += work;
  world.accounts.by_source[static_cast<size_t>(source)] += work;
}

template <class S>
void take(WorldData<S>& world, Source source, double work) {
  world.accounts.taken += work;
  world.accounts.by_source[static_cast<size_t>(source)] -= work;
}

template <class S>
void begin_accounts(WorldData<S>& world) {
  Accounts& accounts = world.accounts;
  if (!accounts.open || accounts.changed) {
    const Energy now = energy_of(world, world.one_slot);
    const double energy = now.kinetic + now.potential;
    if (accounts.open) put_in(world, Source::outside, energy - accounts.before_change);
    else accounts.start = energy;
    accounts.open = true, accounts.changed = false;
    for (Island<S>& island : world.islands) island.levelled = false, find_stiffening(island);
  }
  for (int index : world.awake) {
    Island<S>& island = world.islands[index];
    if (island.floats && island.momentum[6] < 0) measure_momentum(world, island);
  }
}

template <class S>
Balance balance_of(const WorldData<S>& world, const Energy& now, bool with_momenta) {
  const Accounts& accounts = world.accounts;
  const double energy = now.kinetic + now.potential;
  Balance balance;
  balance.time = world.time;
  balance.kinetic = now.kinetic, balance.potential = now.potential, balance.start = energy;
  if (with_momenta) balance.small = small_energy(world);
  if (!accounts.open) return balance;
  balance.start = accounts.start;
  std::tie(balance.put_in, balance.taken) = work_so_far(world);
  if (accounts.changed) balance.put_in += energy - accounts.before_change;
  for (const Island<S>& island : world.islands)
    if (with_momenta) compare_momentum(world, island, balance);
  return balance;
}

// Later changes before the next step join the first.
template <class S>
void note_change(WorldData<S>& world) {
  Accounts& accounts = world.accounts;
  if (!accounts.open || accounts.changed) return;
  const Energy now = energy_of(world, world.one_slot);
  accounts.before_change = now.kinetic + now.potential;
  accounts.changed = true;
}

template <class S>
void book_work(WorldData<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  if (island.flow.work.empty()) return;
  world.accounts.put_in += double(island.flow.work[0]);
  world.accounts.taken += double(island.flow.work[1]);
  each_work(island, [&](size_t source, double work) { world.accounts.by_source[source] += work; });
  std::fill(island.flow.work.begin(), island.flow.work.end(), T(0));
}

#define CDOT_INSTANTIATE(S)                                              \
  template Balance balance_of(const WorldData<S>&, const Energy&, bool); \
  template void prepare_accounts(WorldData<S>&);                         \
  template void begin_accounts(WorldData<S>&);                           \
  template void put_in(WorldData<S>&, Source, double);                   \
  template void take(WorldData<S>&, Source, double);                     \
  template void note_change(WorldData<S>&);                              \
  template void book_work(WorldData<S>&, Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
