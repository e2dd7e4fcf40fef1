// Energy, work and momentum of a World, for <cdot/balance.hpp>. Steps tell what does work; the energy itself is a
// function of the state, so only work needs accounts.
//
// An impulse p of a kick from v0 to v1 changes the kinetic energy by p (v0 + v1) / 2 exactly, whatever else acts in the
// kick. Integrators at acceleration level integrate the power p' v as two more numbers of their state.
#pragma once

#include <algorithm>
#include <utility>

#include <cdot/balance.hpp>

#include "runtime/state/world_data.hpp"

namespace cdot {

struct Energy {
  double kinetic = 0;
  double potential = 0;   // of gravity, constant forces, springs and rows that are springs
  double of_torques = 0;  // in space: of constant torques along the shortest rotation, which is no potential
  double sum() const { return kinetic + potential + of_torques; }
};
// `one_slot` is scratch.
template <class S>
Energy energy_of(const WorldData<S>& world, Batch<S>& one_slot);
// Balance::small.
template <class S>
double small_energy(const WorldData<S>& world);
template <class S>
double kinetic_energy(const WorldData<S>& world, const Island<S>& island);
// Of the rows of a slot, or of one joint, that are springs, at the present poses and at `time` [s].
template <class S>
double potential_of(const WorldData<S>& world, const Batch<S>& batch, int slot, double time, Batch<S>& one_slot);
template <class S>
double potential_of(const WorldData<S>& world, const JointRecord& joint, double time, Batch<S>& one_slot);
// Where, and along which motion, a rate of change is found by the difference over 2 `epsilon` seconds.
template <class S>
struct Along {
  typename S::Scalar time, epsilon;
  const typename S::Velocity* v;
};
// dk/dt C^2 / 2 of the rows of a slot: a spring given by its frequency has k = (2 pi f)^2 / K, and K changes with the
// pose. The spring's force does not do this work. `few` is scratch.
template <class S>
double power_of_stiffness(const WorldData<S>& world, const Batch<S>& batch, int slot, const Along<S>& motion,
                          Batch<S>& one_slot, Bodies<S>& few);
// Allocates what an evaluation in `one_slot` needs.
template <class S>
void reserve(const WorldData<S>& world, Batch<S>& one_slot);

// --- accounts ---

// Finds out what may do work in an island, and allocates for it.
template <class S>
void prepare_accounts(WorldData<S>& world);

// Call at the start of each attempt of a step: opens the accounts at the first step, books what changed from outside,
// and measures the momentum of islands that changed.
template <class S>
void begin_accounts(WorldData<S>& world);
// True if forces without a potential act: without torques, most mechanisms in space have nothing to book.
template <class S>
bool works_now(const WorldData<S>& world, const Island<S>& island) {
  if constexpr (S::has_gyroscopes)
    if (!island.rows_work)
      return std::any_of(island.bodies.begin(), island.bodies.end(), [&](int i) {
        const auto& force = world.bodies.force[i];
        return force.wx != 0 || force.wy != 0 || force.wz != 0;
      });
  return island.works;
}
// The balance with this energy. Its momenta and Balance::small cost more than all accounts, and change slowly: a run
// that looks after each step leaves them out of most.
template <class S>
Balance balance_of(const WorldData<S>& world, const Energy& now, bool with_momenta);
// Put in, and taken.
template <class S>
std::pair<double, double> work_so_far(const WorldData<S>& world) {
  double put_in = world.accounts.put_in, taken = world.accounts.taken;
  for (const Island<S>& island : world.islands)
    if (!island.flow.work.empty()) put_in += double(island.flow.work[0]), taken += double(island.flow.work[1]);
  return {put_in, taken};
}
// Books work that is done at once.
template <class S>
void put_in(WorldData<S>& world, Source source, double work);
template <class S>
void take(WorldData<S>& world, Source source, double work);
// Put in if the energy has risen by this, else taken.
template <class S>
void book_change(WorldData<S>& world, Source source, double risen) {
  if (risen > 0) put_in(world, source, risen);
  else take(world, source, -risen);
}
// Call before a change from outside.
template <class S>
void note_change(WorldData<S>& world);
// FlowState::work, and its rates: put in, taken, then by source: damping, torque, and each of IslandWorkspace::working.
inline constexpr size_t sums_of_work = 2, work_of_bodies = sums_of_work + 2;
// f(source, work) of each of them.
template <class S, class F>
void each_work(const Island<S>& island, F f) {
  const auto& work = island.flow.work;
  if (work.empty()) return;
  f(static_cast<size_t>(Source::damping), double(work[sums_of_work]));
  f(static_cast<size_t>(Source::torque), double(work[sums_of_work + 1]));
  for (size_t k = 0; k < island.working.size(); ++k)
    f(island.segments[island.working[k]].batch->source, double(work[work_of_bodies + k]));
}
// Adds the work of the Runge-Kutta steps so far to the accounts.
template <class S>
void book_work(WorldData<S>& world, Island<S>& island);

// --- velocity level ---

enum class Impulses : char {
  euler,         // `lambda` over h; springs and dampers act with the rate at the end of the kick
  dampers,       // `lambda` of springs, which holds their dampers alone
  rattle_start,  // `correction` over h, without dampers, and Batch::at_rest; forces act at Flow::velocity, as the
                 // dampers have left it
  rattle_end,    // `lambda` over h but that of springs, from Flow::velocity on; drag with the rate at begin_kick()
  middle,        // `correction` over h, without dampers and drag; the velocities are the mean of the kick
  end,           // `lambda` of a projection; that of springs holds their dampers
  // `correction` of joints that depend on time. With J0 v1 = -c1 before displacements d / h, which are added to the
  // velocities, and J1 v2 = -c2 after the change e by the projection, all joints do the work
  //   -(mu / h) c1 + |d / h|^2 / 2 - lambda c2 - |e|^2 / 2;
  // the squares are the method's error, so the velocities are those of the end.
  drift,
  soft,     // as euler, the first of two kicks
  relaxed,  // `correction` of rows but springs, the second of these kicks, without other forces
};

// Call at the start and at the end of a kick of h. C and J are those of the kick.
template <class S>
void begin_kick(WorldData<S>& world, const Island<S>& island);
template <class S>
void book_kick(WorldData<S>& world, Island<S>& island, Impulses impulses, typename S::Scalar h);
// Call at the end of a step of Euler's method: a spring given by its frequency changes its stiffness with the pose.
template <class S>
void book_stiffness(WorldData<S>& world, Island<S>& island);

// --- acceleration level ---

// The power of forces without a potential, laid out like FlowState::work. The rows' lambda are forces, C and J those of
// the present poses.
template <class S>
void find_power(WorldData<S>& world, Island<S>& island, typename S::Scalar time, typename S::Scalar* power);

// --- momentum ---

// Whether the island's momentum is conserved. `at` is a copy of the bodies to move, and is restored.
template <class S>
void find_free_motions(const WorldData<S>& world, Island<S>& island, Bodies<S>& at);
template <class S>
void measure_momentum(const WorldData<S>& world, Island<S>& island);
// Adds the errors of an island to the worst ones.
template <class S>
void compare_momentum(const WorldData<S>& world, const Island<S>& island, Balance& balance);

}  // namespace cdot
