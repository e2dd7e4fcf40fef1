#include "runtime/step/rank_loss.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <cdot/spaces.hpp>

#include "runtime/number/zero_of_distances.hpp"
#include "runtime/solve/direct.hpp"
#include "runtime/solve/longest_move.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/step/between.hpp"

namespace cdot {
namespace {

// The square root of a pivot over its diagonal is a distance from the loss of rank, in rad or in arms. A step comes
// near one if the distance of a row is below `near` at a stage, falls to the share `changes` of its largest, and a
// change of the row moves the bodies `far` times as far. (Light bodies and thin rods make pivots small as well, but
// their rows move nothing far.)
constexpr double near = 0.3, changes = 0.9, far = 2.5;
// A row vanishes below this distance. (Stages of very long steps leave the joints, and rows get shorter there.)
constexpr double vanishing = 0.1;
// A stage within the distance `close`, and of the share `dip` of the largest, asks for another length, if that leads at
// least `clearly` times further away.
constexpr double close = 0.02, dip = 0.5, clearly = 1.5;
constexpr int most_passings = 16;  // in one step, of several loops
constexpr double shortest = 0.5, longest_share = 1.3;
constexpr int lengths_tried = 52;
constexpr double infinity = std::numeric_limits<double>::infinity();
// Of branches that cross, as given by rounded numbers. Two leaps find the same misfit but for a factor.
constexpr double most_misfit = 1e-7, same = 5;
// Of a leap. After one whose error is too large, another that has the pose in its middle tells whether errors fall with
// the length. A step that would end shortly before the pose ends where another of the same length has it in its middle.
constexpr double middle = 0.467, shortly_after = 1.3;
// Loads may grow without bound towards the pose: so far before it, a step looks for joints that break. One that starts
// within twice that distance passes the pose.
constexpr double before_pose = 1e-3;
constexpr int most_trials = 3;  // to get there

template <class Real>
auto times_of(const RungeKutta<Real>& method) {
  return [&method](std::size_t stage) { return double(method.c[stage]); };
}

// The smallest distance of the stages of a step of `share` from all passings. A step that ends before a passing leaves
// it to the next, whose length is taken as 1: otherwise ever shorter steps would approach the passing.
template <class Real>
double distance_of(const RungeKutta<Real>& method, const Passing* begin, const Passing* end, double share) {
  double least = infinity;
  for (const Passing* one = begin; one != end; ++one)
    for (int j = 1; j < method.stages; ++j) {
      const double c = double(method.c[j]), after = one->at - share;
      least = std::min(least, one->slope * std::abs(share * c - one->at));
      if (after > 0) least = std::min(least, one->slope * std::abs(c - after));
    }
  return least;
}

// The error of velocities after a step of `share` h: round-off in the accelerations is epsilon / d^3 at the distance d,
// in units of the square of the slope in time. Measured on four-bars: up to 3 times that.
template <class T>
double noise_at(double d, double slope, double h, double share) {
  return 3 * double(std::numeric_limits<T>::epsilon()) * slope * slope / h * share / (d * d * d);
}

// The way by which a change of the row by 1 m or 1 rad moves the bodies: M^-1 J^T K^-1 e, in the pose of the last
// factor.
template <class S>
double way_of_row(WorldData<S>& world, Island<S>& island, int row) {
  System<S>& system = island.system;
  auto& moves = world.bodies.increment;
  std::fill(system.b.begin(), system.b.end(), 0);
  system.b[static_cast<size_t>(row)] = 1;
  system.solve_factored(system.b.data());
  system.each_row([&](int r, Batch<S>& batch, int i) {
    const bool acts = !system.fixed[r] && !system.broken[r] && !system.dependent(r);
    batch.impulse[i] = acts ? typename S::Scalar(system.b[r]) : typename S::Scalar(0);
  });
  exert(world, island, system, &BatchWorkspace<S>::impulse, moves.data());
  const double way = longest_move<S>(island, moves).way;
  for (int i : island.bodies) moves[i] = {};
  return way;
}

// The distance of that pose over the distance at the stage with the pivot `least`, a share of `diagonal`: ways grow by
// it.
template <class S>
double now_over(const Island<S>& island, int row, double least, double diagonal) {
  if (island.system.dependent(row)) return infinity;
  return std::sqrt(double(island.system.pivot(row)) / diagonal / std::max(least, 1e-300));
}

// The squares of a row's distances at the stages, and the diagonal of which they are shares of pivots. A row that
// vanishes, as that of a constant-velocity joint whose shafts point against each other, takes its diagonal along: if
// that falls so far below its largest since the start, all pivots are shares of the largest.
struct Distances {
  std::vector<double>& square;  // [stage]
  double least = 1, most = 0, diagonal = 0;
};
template <class S>
Distances distances_of(Island<S>& island, int row, int stages) {
  const int rows = island.system.rows();
  const auto at = [&](const std::vector<double>& of, int stage) { return of[static_cast<size_t>(stage * rows + row)]; };
  double largest = double(island.flow.largest_diagonals[static_cast<size_t>(row)]), smallest = infinity;
  for (int j = 1; j < stages; ++j) {
    const double diagonal = at(island.flow.diagonals, j);
    largest = std::max(largest, diagonal), smallest = std::min(smallest, diagonal);
  }
  const bool vanishes = smallest < vanishing * vanishing * largest;
  Distances all{island.flow.of_row};
  all.diagonal = vanishes ? largest : double(island.system.diagonal(row));
  for (int j = 1; j < stages; ++j) {
    double& square = all.square[static_cast<size_t>(j)];
    square = at(island.flow.pivots, j) * (vanishes ? at(island.flow.diagonals, j) / largest : 1);
    all.least = std::min(all.least, square), all.most = std::max(all.most, square);
  }
  return all;
}

const std::vector<double>& distance_at_stages(const Distances& all) {
  for (std::size_t j = 1; j < all.square.size(); ++j) all.square[j] = std::sqrt(all.square[j]);
  return all.square;
}

// Of the rows of effects that end by their load, leaps() sees the forces at the stages.
template <class S>
bool may_break(const WorldData<S>& world, const Island<S>& island) {
  return std::ranges::any_of(island.bonds, [&](int k) { return !world.joints[world.bonds[k].joint].broken; });
}

// f(row, its distances) for each row that comes near a loss of rank at the stages that were noted.
template <class S, class F>
void each_row_near(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, F f) {
  for (int r = 0; r < island.system.rows(); ++r) {
    const Distances all = distances_of(island, r, method.stages);
    if (!(all.least < near * near && all.least < changes * changes * all.most)) continue;
    if (way_of_row(world, island, r) * now_over(island, r, all.least, all.diagonal) > far) f(r, all);
  }
}

// The poses that the stages pass or lead to.
struct Passings {
  Passing all[most_passings];
  int count = 0;
  void add(const Passing& one) {
    if (std::isfinite(one.at) && one.slope > 0 && count < most_passings) all[count++] = one;
  }
  // Of the first pose after the start; those before it lie behind the step.
  double first() const {
    double least = infinity;
    for (int k = 0; k < count; ++k)
      if (all[k].at > 0) least = std::min(least, all[k].at);
    return least;
  }
};

// Where two branches cross but for a misfit e of the row, d d' = e for the distances d, d' along both. On the first,
// d'' = 2 e (dd/dt)^2 / d^3: the e that explains the error of a step of h; 0 if it passes no pose.
template <class Real>
double misfit_of(const RungeKutta<Real>& method, const Passings& passings, double h, double error) {
  double slope = 0;
  for (int k = 0; k < passings.count; ++k)
    if (passings.all[k].at > 0 && passings.all[k].at < 1) slope = std::max(slope, passings.all[k].slope);
  const double d = distance_of(method, passings.all, passings.all + passings.count, 1);
  return slope > 0 ? error * h * d * d * d / (2 * slope * slope) : 0;
}

// The share of a step of h from `time` on, at most `longest`, that ends before all poses that it passes, and the
// round-off that it has there; 0 if it passes none. Leaves the island at the start.
struct EndBefore {
  double share = 0, noise = 0;
};
template <class S>
EndBefore end_before_poses(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method,
                           typename S::Scalar time, typename S::Scalar h, double longest) {
  go_back(world, island);
  evaluate_anew(world, island, time);
  island.factored = false;
  accelerate(world, island, time);
  EndBefore end{longest, 0};
  each_row_near(world, island, method, [&](int r, const Distances& all) {
    if (island.system.dependent(r)) return;
    all.square[0] = std::sqrt(double(island.system.pivot(r)) / all.diagonal);
    const Passing one = best_zero(times_of(method), distance_at_stages(all));
    const double before = before_pose / one.slope;
    if (!(one.slope > 0 && one.at > 2 * before && one.at - before < end.share)) return;
    end.share = one.at - before;
    end.noise = noise_at<typename S::Scalar>(before_pose, one.slope, double(h), end.share);
  });
  go_back(world, island);
  return end.share < longest ? end : EndBefore{};
}

// True if an event, as of a joint that breaks, follows within a step of h. Leaves the island at the start.
template <class S>
bool leads_to_event(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                    typename S::Scalar h) {
  const bool found = take_stages(world, island, method, time, h);
  if (found) project_end(world, island, method, time + h);
  const bool any = found && passed_event(island.flow);
  go_back(world, island);
  return any;
}

// end_before_poses() of a step of h, if an event follows within it. Each trial tells more exactly where the poses are.
template <class S>
EndBefore end_at_event(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                       typename S::Scalar h) {
  using T = typename S::Scalar;
  double share = 1;
  for (int trial = 0; trial < most_trials; ++trial) {
    const EndBefore end = end_before_poses(world, island, method, time, T(share) * h, 1 / share);
    if (!(end.share > 0)) return {};
    share *= end.share;
    if (leads_to_event(world, island, method, time, T(share) * h)) return {share, end.noise};
  }
  return {};
}

template <class T>
struct Passage {
  bool near = false;  // the step needs projected stages
  T length = T(0);    // that leads its stages away from the pose; 0: the present one is as good
  double noise = 0;   // [m/s], [rad/s]: magnified round-off that the velocities of such a step have
};

// Of a step of h whose stages were noted; the length is at most `longest`.
template <class S>
Passage<typename S::Scalar> passage_of(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method,
                                       typename S::Scalar h, typename S::Scalar longest) {
  using T = typename S::Scalar;
  // In floats round-off of the projection exceeds what it corrects.
  if (!island.solver->exact || std::is_same_v<T, float>) return {};
  Passings passings;
  Passage<T> passage;
  double steepest = 0;
  each_row_near(world, island, method, [&](int, const Distances& all) {
    passage.near = true;
    const Passing one = zero_beside_least(times_of(method), distance_at_stages(all));
    if (!std::isfinite(one.at) || !(one.slope > 0)) return;
    const bool asks = all.least < close * close && all.least < dip * dip * all.most;
    if (asks) passings.add(one), steepest = std::max(steepest, one.slope);
    else passage.noise = std::max(passage.noise, noise_at<T>(std::sqrt(all.least), one.slope, double(h), 1));
  });
  if (passings.count == 0) return passage;
  double best = clearly * distance_of(method, passings.all, passings.all + passings.count, 1);
  double share = 0;
  for (int k = 0; k <= lengths_tried; ++k) {
    const double other = shortest + (longest_share - shortest) * k / lengths_tried;
    if (!(T(other) * h <= longest)) break;
    const double d = distance_of(method, passings.all, passings.all + passings.count, other);
    if (d > best) best = d, share = other;
  }
  passage.length = T(share) * h;
  passage.noise = std::max(passage.noise, share > 0 ? noise_at<T>(best, steepest, double(h), share)
                                                    : noise_at<T>(best / clearly, steepest, double(h), 1));
  return passage;
}

}  // namespace

template <class S>
void prepare_rank_loss(Island<S>& island, const RungeKuttaOf<S>& method) {
  const auto rows = static_cast<size_t>(island.system.rows());
  island.flow.pivots.assign(rows * static_cast<size_t>(method.stages), 0.0);
  island.flow.diagonals.assign(rows * static_cast<size_t>(method.stages), 0.0);
  island.flow.largest_diagonals.assign(rows, 0);
  island.flow.of_row.assign(static_cast<size_t>(method.stages), 0.0);
}

template <class S>
void note_pivots(Island<S>& island, int stage) {
  const System<S>& system = island.system;
  if (!island.solver->exact) return;
  const int rows = system.rows();
  const size_t first = static_cast<size_t>(stage) * static_cast<size_t>(rows);
  double *const to = island.flow.pivots.data() + first, *const diagonal = island.flow.diagonals.data() + first;
  for (int r = 0; r < rows; ++r) {
    const bool counts = !system.fixed[r] && !system.broken[r];
    to[r] = !counts ? 1.0 : system.dependent(r) ? 0.0 : double(system.pivot(r) / system.diagonal(r));
    diagonal[r] = double(counts ? system.diagonal(r) : island.flow.largest_diagonals[static_cast<size_t>(r)]);
  }
}

template <class S>
void keep_largest_diagonals(Island<S>& island) {
  if (!island.solver->exact) return;
  auto& largest = island.flow.largest_diagonals;
  const size_t rows = largest.size();
  for (size_t k = rows; k < island.flow.diagonals.size(); ++k)
    largest[k % rows] = std::max(largest[k % rows], typename S::Scalar(island.flow.diagonals[k]));
}

template <class S>
bool tries_with_care(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                     typename S::Scalar longest, typename S::Scalar& h, double& noise) {
  using T = typename S::Scalar;
  if (island.flow.projects_stages || world.settings.drift != Drift::projection) return false;
  const Passage<T> passage = passage_of(world, island, method, h, longest);
  if (!passage.near) return false;
  if (method.implicit) {
    // Newton's old df/dy misleads it there. No shorter step would help: fall_back() finishes this one.
    h = T(0);
    island.flow.astray = false;
    go_back(world, island);
    return true;
  }
  island.flow.projects_stages = true;
  ++world.counts->steered;
  // Where nothing breaks, a start so close to the pose would only follow the gap that rounded numbers leave there.
  const EndBefore end = may_break(world, island) ? end_at_event(world, island, method, time, h) : EndBefore{};
  go_back(world, island);
  if (end.share > 0) h *= T(end.share);
  else if (passage.length > T(0)) h = passage.length;
  noise = end.share > 0 ? end.noise : passage.noise;
  return true;
}

// True if the error falls with the length as it should, by half of its power at least.
template <class S>
bool Leap<S>::falls(T h, double error, int order) const {
  const double power = 0.5 * order;
  return h < length_ ? error <= error_ * std::pow(double(h / length_), power)
                     : error_ <= error * std::pow(double(length_ / h), power);
}

template <class S>
typename S::Scalar Leap<S>::after(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, T h,
                                  double error, T next, T longest, double& noise) {
  if (!island.flow.projects_stages) return next;
  Passings passings;
  each_row_near(world, island, method, [&](int, const Distances& all) {
    passings.add(zero_beside_least(times_of(method), distance_at_stages(all)));
  });
  const double misfit = misfit_of(method, passings, double(h), error), at = passings.first();
  const bool passes = misfit > 0, first = passes && length_ == T(0);
  const bool is_gap = (first ? misfit : misfit_) < most_misfit;
  const bool is_same = misfit < same * misfit_ && misfit_ < same * misfit;
  const bool stays = passes && !first && is_same && !falls(h, error, method.error_order);
  if (first || (passes && error < error_)) length_ = h, error_ = error, misfit_ = misfit;
  if (stays && is_gap) {
    noise = std::max(noise, error_ * (1 + 1e-6)), taken_ = true;
    return length_;
  }
  if (const T other = T(at / middle) * h; first && is_gap && other <= longest) return other;
  if (at >= 1 && at < shortly_after && length_ == T(0) && !std::exchange(led_, true)) return T(at / (1 + middle)) * h;
  return next;
}

#define CDOT_INSTANTIATE(S)                                                                                          \
  template void prepare_rank_loss(Island<S>&, const RungeKuttaOf<S>&);                                               \
  template void note_pivots(Island<S>&, int);                                                                        \
  template void keep_largest_diagonals(Island<S>&);                                                                  \
  template class Leap<S>;                                                                                            \
  template bool tries_with_care(WorldData<S>&, Island<S>&, const RungeKuttaOf<S>&, S::Scalar, S::Scalar, S::Scalar&, \
                                double&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
