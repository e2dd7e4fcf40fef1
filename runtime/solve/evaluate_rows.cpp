// Evaluates the rows of an island once per step, before the solver.
#include <algorithm>

#include <cdot/spaces.hpp>

#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/solve/tension.hpp"

namespace cdot {
namespace {

// f(counters, size) of every segment that counts whole turns.
template <class S, class F>
void each_counters(const Island<S>& island, F f) {
  for (const Segment<S>& segment : island.segments)
    if (const int width = segment.batch->ops->counters; width > 0)
      f(segment.batch->counters.data() + segment.begin * width, (segment.whole_end - segment.begin) * width);
}

}  // namespace

template <class S>
void prepare_turns(Island<S>& island) {
  size_t counters = 0;
  each_counters(island, [&](const auto*, int size) { counters += static_cast<size_t>(size); });
  for (auto* turns : {&island.flow.start_turns, &island.flow.end_turns}) turns->assign(counters, 0);
}

template <class S>
void keep_turns(Island<S>& island) {
  auto* to = island.flow.start_turns.data();
  each_counters(island, [&](const auto* counters, int size) { to = std::copy_n(counters, size, to); });
}

template <class S>
void restore_turns(const Island<S>& island) {
  const auto* from = island.flow.start_turns.data();
  each_counters(island, [&](auto* counters, int size) {
    std::copy_n(from, size, counters);
    from += size;
  });
}

template <class S>
void stiffen_masses(WorldData<S>& world, Island<S>& island, typename S::Scalar share) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  for (int i : island.bodies) all.stiffness[i] = {};
  for (const Segment<S>& segment : island.segments)
    segment.batch->ops->add_stiffness(*segment.batch, segment.begin, segment.end, all, T(world.time),
                                      all.stiffness.data());
  tighten_tensions(world, island, share);
  for (int i : island.bodies) all.effective_mass[i] = S::stiffened(all.inverse_mass[i], all.stiffness[i], share);
  island.factored = false;
}

template <class S>
void restore_masses(WorldData<S>& world, const Island<S>& island) {
  for (int i : island.bodies) world.bodies.effective_mass[i] = world.bodies.inverse_mass[i];
}

// (M + h G) v' = M v + h f + J^T lambda with G = -d(J^T lambda)/dq: implicit Euler for the change of the joints'
// forces.
template <class S>
void hold_back(WorldData<S>& world, const Island<S>& island) {
  Bodies<S>& all = world.bodies;
  for (int i : island.bodies)
    all.velocity[i] = S::weighted(all.effective_mass[i], S::force(all.inverse_mass[i], all.velocity[i]));
}

template <class S>
void stiffen_bodies(WorldData<S>& world, Island<S>& island, typename S::Scalar h, double last_step) {
  using T = typename S::Scalar;
  stiffen_masses(world, island, last_step > 0 ? h * (h / T(last_step)) : h);
  hold_back(world, island);
}

template <class S>
void factorize_rows(WorldData<S>& world, Island<S>& island) {
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    // The direct solver builds its own K, but a law needs K's diagonal with every solver. Soft rows add to it.
    if (!batch.law && island.solver->exact) continue;
    const bool whole = batch.law || world.settings.drift == Drift::soft;
    (whole ? batch.ops->effective_mass : batch.ops->factorize)(batch, segment.begin, segment.end, world.bodies);
  }
}

template <class S>
void evaluate_present(WorldData<S>& world, Island<S>& island) {
  if (island.evaluated) return;
  island.evaluated_at = typename S::Scalar(world.time);
  for (const Segment<S>& segment : island.segments)
    segment.batch->ops->evaluate(*segment.batch, segment.begin, segment.end, world.bodies, island.evaluated_at);
  island.evaluated = true;
}

template <class S>
void evaluate_rows(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  evaluate_present(world, island);
  factorize_rows(world, island);
  const T share = T(world.settings.baumgarte) / h;
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    if (batch.law) {
      if (batch.law->is_of_effect())
        batch.ops->velocity(batch, segment.begin, segment.end, world.bodies.velocity.data(), batch.rate.data());
      batch.law->fill(batch, segment.begin, segment.end, h, world.settings);
    } else if (world.settings.drift == Drift::baumgarte) {
      const int rows = batch.ops->rows;
      const T* const C = batch.C.data();
      T* const bias = batch.bias.data();
      for (int i = segment.begin * rows; i < segment.end * rows; ++i) bias[i] += share * C[i];
    }
  }
}

#define CDOT_INSTANTIATE(S)                                                   \
  template void prepare_turns(Island<S>&);                                    \
  template void keep_turns(Island<S>&);                                       \
  template void restore_turns(const Island<S>&);                              \
  template void stiffen_masses(WorldData<S>&, Island<S>&, S::Scalar);         \
  template void restore_masses(WorldData<S>&, const Island<S>&);              \
  template void hold_back(WorldData<S>&, const Island<S>&);                   \
  template void stiffen_bodies(WorldData<S>&, Island<S>&, S::Scalar, double); \
  template void factorize_rows(WorldData<S>&, Island<S>&);                    \
  template void evaluate_present(WorldData<S>&, Island<S>&);                  \
  template void evaluate_rows(WorldData<S>&, Island<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
