#include "runtime/tool/watch/turn_watch.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/direct/weakest_row.hpp"
#include "runtime/state/world_data.hpp"
#include "runtime/tool/watch/rank_watch.hpp"

namespace cdot {
namespace {

// A turn changes a velocity by this share of the largest, and so many times as quickly as in the last step before.
constexpr double least_share = 0.02, times_as_quick = 10;
// Ends that are met and rows that slip change velocities as well. So many steps after them tell nothing.
constexpr int settled = 2;

// Velocities and spins alike: a spin counts times the size of the island.
template <class S>
double speed(const Island<S>& island, const typename S::Velocity& velocity) {
  typename S::Scalar v[S::freedom];
  S::write(velocity, v);
  double linear = 0, angular = 0;
  for (int i = 0; i < S::freedom; ++i) (i < S::lengths ? linear : angular) += double(v[i]) * double(v[i]);
  return std::sqrt(linear + double(island.size) * double(island.size) * angular);
}

struct Change {
  int body = -1;
  double amount = 0;
};

// Of the island's body whose velocity has changed most.
template <class S>
Change largest_change(const WorldData<S>& world, const Island<S>& island,
                      const std::vector<typename S::Velocity>& before) {
  Change largest;
  for (const int body : island.bodies) {
    const auto change =
        S::sum(world.bodies.velocity[body], before[static_cast<std::size_t>(body)], typename S::Scalar(-1));
    if (const double amount = speed(island, change); amount > largest.amount) largest = {body, amount};
  }
  return largest;
}

}  // namespace

template <class S>
void TurnWatch<S>::look(BasicWorld<S>& world, double h, double time) {
  WorldData<S>& data = world.data();
  const bool first = before_.size() != data.bodies.velocity.size() || courses_.size() != data.islands.size();
  if (first) courses_.assign(data.islands.size(), {});
  const long long events = world.step_counts().events;
  for (std::size_t k = 0; !first && k < data.islands.size(); ++k) {
    Island<S>& island = data.islands[k];
    Course& course = courses_[k];
    if (!island.solver || !island.solver->exact || !island.system.built()) continue;
    const Change change = largest_change(data, island, before_);
    for (const int body : island.bodies) course.most = std::max(course.most, speed(island, data.bodies.velocity[body]));
    course.steps = events == events_ ? course.steps + 1 : 0;
    // In the pose itself the row is redundant, and another one is the weakest.
    const bool redundant = island.redundant_rows > course.redundant, was_near = course.near;
    const WeakestRow before = course.row;
    if (!redundant) course.row = weakest_row(island.system);
    course.near = redundant || is_near_loss(course.row);
    const double share = change.amount / course.most;
    const bool turns = share > least_share && change.amount > times_as_quick * course.usual * h;
    const bool passes = (course.near || was_near) && course.usual >= 0 && course.steps > settled;
    if (passes && turns && share > found_.share) found_ = {was_near ? before : course.row, change.body, share, time};
    if (!course.near && !was_near) course.usual = change.amount / h, course.redundant = island.redundant_rows;
  }
  events_ = events;
  before_.assign(data.bodies.velocity.begin(), data.bodies.velocity.end());
}

#define CDOT_INSTANTIATE(S) template class TurnWatch<S>;
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
