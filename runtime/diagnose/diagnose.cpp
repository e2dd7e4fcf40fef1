// The state of a World -> rank, condition, redundant rows and stiffness of each island.
#include <algorithm>
#include <cmath>
#include <set>

#include <cdot/diagnose.hpp>
#include <cdot/spaces.hpp>

#include "runtime/diagnose/equations.hpp"

namespace cdot {
namespace {

// Share above which a row takes part in a redundant one.
constexpr double takes_part = 1e-6;
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

template <class S>
void find_redundant_rows(Equations<S>& equations, std::vector<Diagnosis::Redundant>& redundant) {
  if (equations.rank() == equations.rows()) return;
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
                         conflicting});
  }
}

template <class S>
void measure_rows(Equations<S>& equations, Diagnosis::Island& found) {
  found.rows = equations.rows();
  found.rank = equations.rank();
  find_redundant_rows(equations, found.redundant);
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
double spin_of(const typename S::Velocity& velocity) {
  typename S::Scalar numbers[S::freedom];
  S::write(velocity, numbers);
  double square = 0;
  for (int k = S::lengths; k < S::freedom; ++k) square += double(numbers[k]) * double(numbers[k]);
  return std::sqrt(square);
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
  for (Island<S>& island : world.data().islands) {
    Equations<S> equations(world.data(), island);
    Diagnosis::Island& found = diagnosis.islands.emplace_back();
    measure_bodies(world.data(), island, found);
    measure_rows(equations, found);
    found.stiffest = stiffest_motion(world.data(), island, equations, typename S::Scalar(h));
  }
  world.restore(before);
  return diagnosis;
}

#define CDOT_INSTANTIATE(S) template Diagnosis diagnose(BasicWorld<S>&, double);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
