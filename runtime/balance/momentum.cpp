// The momentum of islands that nothing holds.
#include "runtime/motion/momentum.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/number/arbitrary.hpp"
#include "runtime/rows/laws.hpp"

namespace cdot {
namespace {

using Vector = spatial::Vector<double>;
template <class R>
Vector doubles(const spatial::Vector<R>& a) {
  return {double(a.x), double(a.y), double(a.z)};
}

// A rigid motion of all bodies: along or about the axis `c`.
template <class S>
typename S::Velocity rigid_motion(const typename S::Pose& pose, int c) {
  typename S::Scalar v[S::freedom] = {};
  v[c] = 1;
  Twist<double> motion = twist<double>(S::read_velocity(v));
  motion.linear = motion.linear + spatial::cross(motion.angular, position<double>(pose));
  return velocity<S>(motion);
}

// By which a rigid motion along, or about, the axis `c` changes a row with this J, and the sum of its parts' sizes.
template <class S, class Real>
std::pair<double, double> change_of_row(const Real* J, const Batch<S>& one, const Bodies<S>& at, int c) {
  double sum = 0, size = 0;
  for (const int body : one.body) {
    typename S::Scalar v[S::freedom];
    S::write(rigid_motion<S>(at.pose[body], c), v);
    for (int i = 0; i < S::freedom; ++i, ++J) {
      const double term = double(*J) * double(v[i]);
      sum += term, size += std::abs(term);
    }
  }
  return {sum, size};
}

enum class Rows : char { each, together };

// True if no row of the slot resists rigid motions along, or about, the axes [first, last). Displacements are tried at
// generic poses, where no direction vanishes by chance. The effect of one body that has no force there acts elsewhere,
// as a liquid on a ball in the air. Together: the equations may change, but the sum of the squares of C does not.
template <class S>
bool lets_move(const Batch<S>& batch, int slot, const Bodies<S>& at, typename S::Scalar time, int first, int last,
               Rows which) {
  using Real = ExactNumber<typename S::Scalar>;
  const int rows = batch.ops->rows, bodies = batch.ops->bodies, width = S::freedom * bodies;
  Batch<S> one;
  one.ops = batch.ops;
  one.parameters.assign(batch.parameters.begin() + slot * batch.ops->parameter_size,
                        batch.parameters.begin() + (slot + 1) * batch.ops->parameter_size);
  one.counters.assign(static_cast<size_t>(batch.ops->counters), 0);
  one.body.assign(batch.body.begin() + slot * bodies, batch.body.begin() + (slot + 1) * bodies);
  one.jacobian.resize(static_cast<size_t>(batch.ops->jacobian_size));
  one.C.resize(static_cast<size_t>(rows)), one.bias.resize(static_cast<size_t>(rows));
  batch.ops->evaluate(one, 0, 1, at, time);
  std::vector<Real> J(static_cast<size_t>(rows * width)), weighted(J);
  Real K[most_rows * most_rows];
  batch.ops->dense(one, 0, at, J.data(), weighted.data(), K, most_rows);
  constexpr double slight = by_precision<typename S::Scalar>(1e-3, 1e-7);
  double change[S::freedom] = {}, most[S::freedom] = {};
  for (int r = 0; r < rows; ++r) {
    const auto row = J.begin() + r * width;
    if (bodies == 1 && std::all_of(row, row + width, [](Real entry) { return entry == Real(0); })) return false;
    for (int c = first; c < last; ++c) {
      const auto [sum, size] = change_of_row<S>(&*row, one, at, c);
      const bool alone = which == Rows::each || batch.kinds[static_cast<size_t>(r)] != RowKind::equality;
      const double C = alone ? 1 : double(one.C[r]);
      if (alone && std::abs(sum) > slight * size) return false;
      change[c] += C * sum, most[c] += std::abs(C) * size;
    }
  }
  for (int c = first; c < last; ++c)
    if (std::abs(change[c]) > slight * most[c]) return false;
  return true;
}

// True if the slot lets the bodies turn as one. The vectors of a joint turn with them, so C = 0 stays: by each row
// where it holds, or by the sum of squares, whatever gaps sweeps or springs leave. The poses of the moment must not
// decide. Springs on the rows of one vector pull along it if they are equally stiff. Those by frequency are not.
template <class S>
bool lets_turn(const Batch<S>& batch, int slot, const Bodies<S>& now, const Bodies<S>& generic,
               typename S::Scalar time) {
  const auto turns = [&](const Bodies<S>& at, Rows rows) {
    return lets_move(batch, slot, at, time, S::lengths, S::freedom, rows);
  };
  if (batch.law && batch.law->by_mass && batch.law->by_mass(batch, slot)) return turns(generic, Rows::each);
  const bool of_joint = !batch.law || batch.law->reported || batch.law == &soft_law<S>();
  return turns(now, Rows::each) || (of_joint && turns(generic, Rows::together));
}

// Every body of the island at another pose; the bodies keep their masses.
template <class S>
void scatter(const Island<S>& island, Bodies<S>& at) {
  using T = typename S::Scalar;
  Arbitrary arbitrary;
  for (int i : island.bodies) {
    T numbers[S::freedom];
    for (int k = 0; k < S::freedom; ++k) numbers[k] = T(4 * arbitrary() - 2) * (k < S::lengths ? T(island.size) : T(1));
    at.pose[i] = S::moved(at.pose[i], S::read_velocity(numbers));
  }
}

template <class S>
bool touches_the_world(const WorldData<S>& world, const Island<S>& island) {
  const auto immovable = [&](int body) { return world.bodies.immovable(body); };
  if (!island.drags.empty()) return true;
  for (const Segment<S>& segment : island.segments) {
    const auto body = segment.batch->body.begin();
    const int bodies = segment.batch->ops->bodies;
    if (std::any_of(body + segment.begin * bodies, body + segment.end * bodies, immovable)) return true;
  }
  return false;
}

}  // namespace

template <class S>
void find_free_motions(const WorldData<S>& world, Island<S>& island, Bodies<S>& at) {
  using T = typename S::Scalar;
  island.floats = island.spins_freely = !touches_the_world(world, island);
  for (int i : island.bodies) {
    // A body that cannot turn absorbs torques.
    const auto turned = S::weighted(world.bodies.inverse_mass[i], rigid_motion<S>(typename S::Pose{}, S::freedom - 1));
    island.spins_freely = island.spins_freely && norm(twist<double>(turned).angular) > 0;
  }
  if (!island.floats) return;
  scatter(island, at);
  for (const Segment<S>& segment : island.segments) {
    for (int slot = segment.begin; segment.batch->ops->rows > 0 && slot < segment.end; ++slot) {
      const Batch<S>& batch = *segment.batch;
      island.floats = island.floats && lets_move(batch, slot, at, T(world.time), 0, S::lengths, Rows::each);
      island.spins_freely = island.spins_freely && lets_turn(batch, slot, world.bodies, at, T(world.time));
    }
  }
  for (int i : island.bodies) at.pose[i] = world.bodies.pose[i];
  island.spins_freely = island.spins_freely && island.floats;
}

template <class S>
void measure_momentum(const WorldData<S>& world, Island<S>& island) {
  const auto now = momentum_of(world, island);
  const Vector p = doubles(now.linear), L = doubles(now.spin);
  const double numbers[] = {p.x, p.y, p.z, L.x, L.y, L.z, world.time};
  std::copy(std::begin(numbers), std::end(numbers), island.momentum.begin());
}

template <class S>
void compare_momentum(const WorldData<S>& world, const Island<S>& island, Balance& balance) {
  if (island.momentum.empty() || island.momentum[6] < 0) return;
  const auto now = momentum_of(world, island);
  const double time = world.time - island.momentum[6];
  // Slower motions are rest: the momentum of round-off alone would have no scale.
  const auto slow = by_precision<typename S::Scalar>(1e-3, 1e-6);
  const auto least = slow * now.mass * island.size,
             least_spin = slow * (now.inertia.xx + now.inertia.yy + now.inertia.zz);
  const auto compare = [&](const double* start, const auto& sum, const auto& given, auto size,
                           Balance::Momentum& worst) {
    const Vector change = doubles(sum) - Vector{start[0], start[1], start[2]} - time * doubles(given);
    const Balance::Momentum mine{norm(change), double(size), island.bodies.front()};
    // By share; 0 / 0 is no error.
    if (worst.body < 0 || !(mine.error * worst.scale <= worst.error * mine.scale)) worst = mine;
  };
  compare(island.momentum.data(), now.linear, now.force, now.linear_size + least, balance.linear);
  if (island.spins_freely && !pushed(world, island))
    compare(island.momentum.data() + 3, now.spin, now.torque, now.spin_size + least_spin, balance.angular);
}

#define CDOT_INSTANTIATE(S)                                                     \
  template void find_free_motions(const WorldData<S>&, Island<S>&, Bodies<S>&); \
  template void measure_momentum(const WorldData<S>&, Island<S>&);              \
  template void compare_momentum(const WorldData<S>&, const Island<S>&, Balance&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
