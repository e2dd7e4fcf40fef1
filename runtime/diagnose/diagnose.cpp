// The state of a World -> rank, condition, redundant rows and stiffness of each island.
#include <algorithm>
#include <cmath>
#include <set>

#include <cdot/diagnose.hpp>
#include <cdot/spaces.hpp>

#include "runtime/diagnose/equations.hpp"
#include "runtime/direct/ldlt.hpp"
#include "runtime/motion/motion.hpp"
#include "runtime/solve/longest_move.hpp"

namespace cdot {
namespace {

// Share above which a row takes part in a redundant one.
constexpr double takes_part = 1e-6;
// [m/s, rad/s], [m/s^2, rad/s^2]: smaller ones count as 0.
template <class T>
constexpr double still = by_precision<T>(1e-3, 1e-6);
constexpr int rounds = 30;

double normalise(std::vector<double>& x) {
  double sum = 0;
  for (double number : x) sum += number * number;
  const double length = std::sqrt(sum);
  if (length > 0)
    for (double& number : x) number /= length;
  return length;
}

template <class S>
std::vector<double> random_impulses(const Equations<S>& equations) {
  std::vector<double> x(equations.size());
  Arbitrary arbitrary;
  for (size_t r = 0; r < x.size(); ++r) x[r] = equations.independent(r) ? 0.5 + arbitrary() : 0.0;
  normalise(x);
  return x;
}

// The largest eigenvalue of S^-1 K S^-1 or, inverse, of S K^-1 S with S^2 = diag K, by power iteration.
template <bool inverse, class S>
double largest_eigenvalue(Equations<S>& equations) {
  std::vector<double> x = random_impulses(equations);
  const auto scale = [&] {
    for (size_t r = 0; r < x.size(); ++r) {
      const double root = std::sqrt(equations.diagonal(r));
      x[r] = !equations.independent(r) ? 0.0 : inverse ? x[r] * root : x[r] / root;
    }
  };
  double value = 1;
  for (int round = 0; round < rounds; ++round) {
    scale();
    x = inverse ? equations.solve(x) : equations.multiply(x);
    scale();
    value = normalise(x);
  }
  return value;
}

// Row d = sum of shares of the independent rows: K_II shares = K_Id. The joints are listed for conflicting rows, and
// for this many others.
constexpr int most_explained = 64;

template <class S>
std::vector<int> joints_of_row(Equations<S>& equations, size_t d) {
  std::vector<double> unit(equations.size(), 0.0);
  unit[d] = 1;
  const std::vector<double> shares = equations.solve(equations.multiply(unit));
  std::set<int> joints{equations.joint(d).joint};
  for (size_t r = 0; r < shares.size(); ++r)
    if (std::abs(shares[r]) * std::sqrt(equations.diagonal(r)) > takes_part * std::sqrt(equations.diagonal(d)))
      joints.insert(equations.joint(r).joint);
  return {joints.begin(), joints.end()};
}

// The residual of C in redundant rows beyond their shares of the others: C_d - K_dI K_II^-1 C_I.
template <class S>
std::vector<double> missed_by_rows(Equations<S>& equations) {
  std::vector<double> C(equations.size());
  for (size_t r = 0; r < C.size(); ++r) C[r] = equations.independent(r) ? equations.C(r) : 0.0;
  std::vector<double> missed = equations.multiply(equations.solve(C));
  for (size_t r = 0; r < C.size(); ++r) missed[r] = equations.C(r) - missed[r];
  return missed;
}

// Accelerations J dv/dt = gamma that redundant rows ask for beyond their shares of the others; 0 where the velocities
// violate a row by more than `still`, since gamma then tells nothing.
template <class S>
std::vector<double> missed_accelerations(WorldData<S>& world, Island<S>& island, Equations<S>& equations) {
  std::vector<double> asked(equations.size()), rest(equations.size());
  double largest = 0, violated = 0;
  free_accelerations(world, island);
  for (const Segment<S>& segment : equations.segments()) {
    Batch<S>& batch = *segment.batch;
    batch.ops->velocity(batch, segment.begin, segment.end, world.bodies.velocity.data(), batch.rate.data());
    for (int i = segment.begin * batch.ops->rows; i < segment.end * batch.ops->rows; ++i)
      violated = std::max(violated, std::abs(double(batch.rate[i]) + double(batch.bias[i])));
    batch.ops->velocity(batch, segment.begin, segment.end, world.bodies.velocity_rate.data(), batch.rate.data());
    batch.ops->gamma(batch, segment.begin, segment.end, world.bodies, typename S::Scalar(world.time),
                     batch.bias.data());
  }
  equations.each_row(
      [&](int row, Batch<S>& batch, int i) { asked[row] = double(batch.bias[i]) - double(batch.rate[i]); });
  equations.evaluate();
  const std::vector<double> kept = equations.multiply(equations.solve(asked));
  for (size_t r = 0; r < asked.size(); ++r) {
    if (!equations.dependent(r)) continue;
    rest[r] = asked[r] - kept[r];
    largest = std::max(largest, std::abs(asked[r]));
  }
  constexpr double slight = still<typename S::Scalar>;
  if (violated > slight) return std::vector<double>(equations.size());
  for (double& one : rest)
    if (!(std::abs(one) > slight * (1 + largest))) one = 0;
  return rest;
}

template <class S>
void find_redundant_rows(WorldData<S>& world, Island<S>& island, Equations<S>& equations,
                         std::vector<Diagnosis::Redundant>& redundant) {
  if (equations.rank() == equations.rows()) return;
  const std::vector<double> undecided = missed_accelerations(world, island, equations);
  const std::vector<double> missed = missed_by_rows(equations);
  double largest = 0;
  for (size_t r = 0; r < equations.size(); ++r) largest = std::max(largest, std::abs(equations.C(r)));
  const double least = std::max(double(Equations<S>::resolution), 1e-9 * largest);
  for (size_t r = 0; r < equations.size(); ++r) {
    if (!equations.dependent(r)) continue;
    const bool conflicting = !(std::abs(missed[r]) <= least);
    const bool explained = conflicting || redundant.size() < most_explained;
    redundant.push_back({equations.joint(r),
                         explained ? joints_of_row(equations, r) : std::vector{equations.joint(r).joint}, missed[r],
                         conflicting, conflicting ? 0.0 : undecided[r]});
  }
}

// The motion by which one row changes and the other independent rows do not: M^-1 J^T K^-1 e.
template <class S>
LongestMove way_of_row(WorldData<S>& world, Island<S>& island, Equations<S>& equations, size_t row) {
  std::vector<double> unit(equations.size(), 0.0);
  unit[row] = 1;
  const std::vector<double> shares = equations.solve(unit);
  equations.each_row([&](int r, Batch<S>& batch, int i) { batch.impulse[i] = typename S::Scalar(shares[r]); });
  std::vector<typename S::Velocity> moves(world.bodies.pose.size());
  for (const Segment<S>& segment : equations.segments())
    segment.batch->ops->apply(*segment.batch, segment.begin, segment.end, world.bodies, segment.batch->impulse.data(),
                              moves.data());
  return longest_move<S>(island, moves);
}

template <class S>
void find_nearly_redundant_rows(WorldData<S>& world, Island<S>& island, Equations<S>& equations,
                                Diagnosis::Island& found) {
  for (size_t r = 0; r < equations.size(); ++r) {
    if (!equations.independent(r) || !(equations.pivot(r) < dense::lasting_share * equations.diagonal(r))) continue;
    const LongestMove move = way_of_row(world, island, equations, r);
    if (move.way > farthest_reach * std::max(1.0, found.size))
      found.nearly_redundant.push_back({equations.joint(r), 1 / move.way, move.body});
  }
}

// Components of velocity that the masses allow.
template <class S>
int freedom_of(const WorldData<S>& world, const Island<S>& island) {
  int freedom = 0;
  for (int body : island.bodies) {
    for (int k = 0; k < S::freedom; ++k) {
      typename S::Scalar numbers[S::freedom] = {};
      numbers[k] = 1;
      S::write(S::weighted(world.bodies.inverse_mass[body], S::read_velocity(numbers)), numbers);
      freedom += std::any_of(numbers, numbers + S::freedom, [](auto number) { return number != 0; });
    }
  }
  return freedom;
}

template <class S>
void measure_rows(WorldData<S>& world, Island<S>& island, Equations<S>& equations, Diagnosis::Island& found) {
  found.rows = equations.rows();
  found.rank = equations.rank();
  find_redundant_rows(world, island, equations, found.redundant);
  for (size_t r = 0; r < equations.size(); ++r) {
    if (!equations.independent(r)) continue;
    const double share = equations.pivot(r) / equations.diagonal(r);
    if (found.weakest.joint >= 0 && share >= found.smallest_pivot) continue;
    found.smallest_pivot = share;
    found.weakest = equations.joint(r);
  }
  if (found.rank > 0) found.condition = largest_eigenvalue<false>(equations) * largest_eigenvalue<true>(equations);
}

template <class S>
void measure_bodies(const WorldData<S>& world, const Island<S>& island, Diagnosis::Island& found) {
  found.bodies = island.bodies;
  found.size = double(island.size);
  for (int body : island.bodies) {
    const double inverse = double(world.bodies.inverse_mass[body].m);
    if (inverse > 0) {
      found.heaviest = std::max(found.heaviest, 1 / inverse);
      found.lightest = found.lightest > 0 ? std::min(found.lightest, 1 / inverse) : 1 / inverse;
    }
    typename S::Scalar numbers[S::pose_numbers];
    S::write(world.bodies.pose[body], numbers);
    for (int k = 0; k < S::lengths; ++k) found.farthest = std::max(found.farthest, std::abs(double(numbers[k])));
    const double spin = spin_of<S>(world.bodies.velocity[body]);
    if (spin > found.fastest_spin) found.fastest_spin = spin, found.spinning = body;
  }
}

}  // namespace

template <class S>
Diagnosis diagnose(BasicWorld<S>& world, double h) {
  world.prepare();
  const Snapshot before = world.snapshot();
  Diagnosis diagnosis;
  diagnosis.islands.reserve(world.data().islands.size());
  for (Island<S>& island : world.data().islands) {
    Equations<S> equations(world.data(), island);
    Diagnosis::Island& found = diagnosis.islands.emplace_back();
    measure_bodies(world.data(), island, found);
    measure_rows(world.data(), island, equations, found);
    found.mobility = freedom_of(world.data(), island) - found.rank;
    find_nearly_redundant_rows(world.data(), island, equations, found);
    found.limited = stiffest_limited_force(world.data(), island, typename S::Scalar(h));
    found.stiffest = stiffest_motion(world.data(), island, equations, typename S::Scalar(h));
    found.fastest_decay = fastest_decay(world.data(), island, equations);
  }
  world.restore(before);
  return diagnosis;
}

#define CDOT_INSTANTIATE(S) template Diagnosis diagnose(BasicWorld<S>&, double);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
