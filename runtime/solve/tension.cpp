#include "runtime/solve/tension.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/number/arbitrary.hpp"
#include "runtime/solve/solver.hpp"

namespace cdot {
namespace {

// A pivot below this share of the largest entry is round-off.
template <class T>
constexpr double slight = by_precision<T>(1e-4, 1e-9);

// The symmetric part of -d(J^T lambda)/dq of one slot over its movable bodies, reduced by elimination.
template <class S>
class Stiffness {
 public:
  using T = typename S::Scalar;
  static constexpr int widest = S::freedom * most_bodies;
  using Row = std::array<double, widest>;

  // Evaluates at the poses of `at`; `all` tells which bodies are movable.
  Stiffness(const Batch<S>& batch, int slot, const Bodies<S>& all, const Bodies<S>& at, double time, const T* lambda)
      : bodies_(batch.ops->bodies), width_(S::freedom * bodies_) {
    T H[widest * widest];
    batch.ops->stiffness(batch, slot, at, T(time), lambda, H);
    bool moves[most_bodies];
    for (int k = 0; k < bodies_; ++k) moves[k] = !all.immovable(batch.body[slot * bodies_ + k]);
    for (int r = 0; r < width_; ++r) {
      for (int k = 0; k <= r / S::freedom; ++k) {
        const bool both = moves[k] && moves[r / S::freedom];
        for (int c = S::freedom * k; c < S::freedom * (k + 1); ++c) {
          const double entry = both ? -0.5 * (double(H[r * width_ + c]) + double(H[c * width_ + r])) : 0.0;
          of_[r][c] = entry;
          largest_ = std::max(largest_, std::abs(entry));
        }
      }
    }
  }

  // The row of the displacement with the largest stiffness, divided by its pivot. False if no stiff displacement is
  // left.
  bool find_row(Row& w, double& pivot, bool any_sign) const {
    int held = -1;
    double most = slight<T> * largest_;
    for (int k = 0; k < bodies_; ++k) {
      for (int c = S::freedom * k; c < S::freedom * k + S::lengths; ++c) {
        const double size = any_sign ? std::abs(of_[c][c]) : of_[c][c];
        if (size > most) most = size, held = c;
      }
    }
    if (held < 0) return false;
    pivot = of_[held][held];
    const double scale = 1 / pivot;
    for (int c = 0; c < width_; ++c) w[c] = (c <= held ? of_[held][c] : of_[c][held]) * scale;
    return true;
  }
  void eliminate(const Row& w, double pivot) {
    for (int r = 0; r < width_; ++r) {
      const double share = pivot * w[r];
      for (int c = 0; c <= r; ++c) of_[r][c] -= share * w[c];
    }
  }

  // True if only the stiffness of the bodies' own rotations is left.
  bool only_turns() const {
    double left = 0;
    for (int r = 0; r < width_; ++r)
      for (int c = 0; c <= r; ++c)
        if (r / S::freedom != c / S::freedom || r % S::freedom < S::lengths || c % S::freedom < S::lengths)
          left = std::max(left, std::abs(of_[r][c]));
    return left <= slight<T> * largest_;
  }

 private:
  int bodies_, width_;
  double of_[widest][widest];  // the lower triangle counts
  double largest_ = 0;
};

// Moves the island's bodies to generic poses `far` sizes away, at which no direction is singular.
template <class S>
void move_elsewhere(const Island<S>& island, const Bodies<S>& from, double far, Bodies<S>& at) {
  using T = typename S::Scalar;
  Arbitrary arbitrary;
  for (int body : island.bodies) {
    T numbers[S::freedom];
    for (int k = 0; k < S::freedom; ++k)
      numbers[k] = T(4 * arbitrary() - 2) * (k < S::lengths ? T(far * double(island.size)) : T(1));
    at.pose[body] = S::moved(from.pose[body], S::read_velocity(numbers));
  }
}

// The number of tension rows of a slot that couples displacements and, apart from these, own rotations only. Other
// joints (a slide along a turning axis) use the own rotations only.
template <class S>
int rows_of(const WorldData<S>& world, const Batch<S>& batch, int slot, const Bodies<S>& at) {
  using T = typename S::Scalar;
  T lambda[most_rows];
  std::fill_n(lambda, most_rows, T(1));
  Stiffness<S> stiffness(batch, slot, world.bodies, at, world.time, lambda);
  typename Stiffness<S>::Row w;
  double pivot;
  int rows = 0;
  for (; stiffness.find_row(w, pivot, true); ++rows) stiffness.eliminate(w, pivot);
  return stiffness.only_turns() ? rows : 0;
}

// Where a track hardly bends, elimination takes the radius of the bend for an arm: the row holds rotations, and what is
// left for them is negative, which no step takes. Such rows are left out, as those of straight tracks are. In units of
// Island::size.
constexpr double longest_arm = 2;

// True if a turn of 1 rad of a body moves the row by more than a length [m].
template <class S>
bool turns_by_more(const double* w, int bodies, double length) {
  for (int k = 0; k < bodies; ++k)
    for (int c = S::lengths; c < S::freedom; ++c)
      if (std::abs(w[S::freedom * k + c]) > length) return true;
  return false;
}

// Subtracts the stiffness of the row from the body's own rotation.
template <class S>
void leave_to_row(typename S::Stiffness& own, const double* w, double pivot) {
  typename S::Scalar taken[S::freedom][S::freedom] = {};
  for (int r = S::lengths; r < S::freedom; ++r)
    for (int c = S::lengths; c < S::freedom; ++c) taken[r][c] = typename S::Scalar(pivot * w[r] * w[c]);
  S::subtract(own, taken, 0);
}

// Of every slot with rows, in the order of the segments. Where a slot has none close by, it may have some further away,
// as a slack cord has: without them the start would decide how a taut one is solved.
template <class S>
std::vector<int> count_rows(const WorldData<S>& world, const Island<S>& island, Bodies<S>& at) {
  std::vector<int> rows;
  for (const double far : {1.0, 30.0, 1000.0}) {
    move_elsewhere(island, world.bodies, far, at);
    size_t k = 0;
    for (const Segment<S>& segment : island.segments)
      for (int slot = segment.begin; segment.batch->ops->rows > 0 && slot < segment.end; ++slot, ++k) {
        if (rows.size() == k) rows.push_back(0);
        if (rows[k] == 0) rows[k] = rows_of(world, *segment.batch, slot, at);
      }
  }
  return rows;
}

}  // namespace

template <class S>
std::vector<int> tension_rows(const WorldData<S>& world, const Island<S>& island, Bodies<S>& at) {
  const IntegratorRow& method = row_of(world.settings.integrator);
  if (!method.stiffens && method.level != Level::acceleration) return {};
  const std::vector<int> rows = count_rows(world, island, at);
  return std::count(rows.begin(), rows.end(), 0) == std::ssize(rows) ? std::vector<int>{} : rows;
}

template <class S>
void tighten_tensions(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  System<S>& system = island.at_work();
  system.slacken();
  if (!island.solver->exact) return;
  for (const auto& tension : system.tensions) {
    const Batch<S>& batch = *tension.batch;
    if (world.joints[batch.joint[tension.slot]].broken) continue;
    T lambda[most_rows];
    for (int r = 0, i = tension.slot * batch.ops->rows; r < batch.ops->rows; ++r, ++i)
      lambda[r] = batch.lambda[i] + batch.correction[i];
    Stiffness<S> stiffness(batch, tension.slot, world.bodies, world.bodies, world.time, lambda);
    typename Stiffness<S>::Row w;
    double pivot;
    const int bodies = batch.ops->bodies;
    for (int r = 0; r < tension.rows && stiffness.find_row(w, pivot, false); ++r) {
      if (turns_by_more<S>(w.data(), bodies, longest_arm * double(island.size))) break;
      if (r + 1 < tension.rows) stiffness.eliminate(w, pivot);
      system.tighten(tension, r, w.data(), pivot * double(h));
      for (int k = 0; k < bodies; ++k)
        leave_to_row<S>(world.bodies.stiffness[batch.body[tension.slot * bodies + k]], w.data() + S::freedom * k,
                        pivot);
    }
  }
}

#define CDOT_INSTANTIATE(S)                                                                  \
  template std::vector<int> tension_rows(const WorldData<S>&, const Island<S>&, Bodies<S>&); \
  template void tighten_tensions(WorldData<S>&, Island<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
