// A joint as rows of impulses, for an engine of your own. Per step: prepare() each joint, warm_start() each joint,
// solve() all joints a few times, move() the bodies, project() all joints once or twice.
#pragma once

#include <cdot/kernel.hpp>

namespace cdot::plain {

// How rows answer to C != 0. With `hertz` above 0 the joint is a damped spring of that frequency, whatever the masses.
template <class T>
struct Stiffness {
  T hertz = T(0), damping_ratio = T(1);
  T error_reduction = T(0.2);  // part of C that a rigid row takes back in a step; 0 where project() does it
};

// J v + C_t + reduction C / h + softness K_ii lambda = 0 is a step of length h of m x" + d x' + k x = 0, m = 1/K_ii,
// k = m w^2, d = 2 zeta m w. Erin Catto, Soft Constraints, 2011.
template <class T>
struct RowStep {
  T reduction, softness;
};
template <class T>
RowStep<T> row_step(const Stiffness<T>& s, T h) {
  if (!(s.hertz > T(0))) return {s.error_reduction, T(0)};
  const T hw = h * T(6.28318530717958648) * s.hertz, damping = T(2) * s.damping_ratio + hw;
  return {hw / damping, T(1) / (hw * damping)};
}

// A motor and limits on a coordinate of a joint. Whole turns of an angle count from the first step.
template <class T>
struct Drive {
  T speed = T(0), most = T(0);  // rate = speed, by a force or torque of at most `most`; 0: no motor
  T lower = T(-HUGE_VAL), upper = T(HUGE_VAL);
  T error_reduction = T(0.2);  // part that a step takes back where the coordinate lies beyond a limit
  bool has_motor() const { return most > T(0); }
};

// The bias of a row C >= 0: it may close a gap within the step, but not pass it.
template <class T>
T bias_of_bound(T C, T reduction, T h) {
  return C * (C > T(0) ? T(1) : reduction) / h;
}

// The whole turns that bring an angle C within (-pi, pi] nearest to `last`.
template <class Coordinate, class T>
T whole_turns(T C, T last) {
  constexpr T turn = T(6.28318530717958648);
  return Coordinate::wraps ? turn * std::round((last - C) / turn) : T(0);
}

// Rows that read an angle beyond half a turn have a parameter for its whole turns. The two together never jump: the
// angle turns by less than half a turn from one count to the next. The first count keeps the turns that it finds.
template <class T, class... Coordinates>
class Turns {
 public:
  template <class Poses, class Parameters>
  void count([[maybe_unused]] const Poses& q, [[maybe_unused]] Parameters& p, [[maybe_unused]] T time) {
    [[maybe_unused]] int i = 0;
    (count_one<Coordinates>(q, p, time, last_[i++]), ...);
    started_ = true;
  }

 private:
  template <class Coordinate, class Poses, class Parameters>
  void count_one(const Poses& q, Parameters& p, T time, T& last) {
    T* turns = Coordinate::turns(p);
    if (turns == nullptr) return;
    T C[1];
    Coordinate::position(q, p, time, C);
    if (started_) *turns = whole_turns<Coordinate>(C[0], last);
    last = C[0] + *turns;
  }

  bool started_ = false;
  T last_[sizeof...(Coordinates) + 1] = {};
};

template <class T>
T larger(T a, T b) {
  return a < b ? b : a;
}

constexpr int diagonal(int i) { return i * (i + 3) / 2; }  // of a lower triangle, row by row

template <class Block>
constexpr bool has_inequalities() {
  for (const RowKind kind : Block::row_kinds)
    if (kind == RowKind::inequality) return true;
  return false;
}

// The rows of a joint, between two steps and within one.
template <class Block, class T>
class Rows {
 public:
  static constexpr int rows = Block::rows, bodies = Block::bodies;

  T impulse[rows] = {};  // of the last step, where the next one starts

  // `ratio` is that of this step's length to the last one's.
  template <class Pose, class Mass, class Parameters>
  void prepare(const Pose (&q)[bodies], const Mass (&m)[bodies], const Parameters& p, T time, T h, T ratio,
               const Stiffness<T>& stiffness) {
    T C[rows];
    Block::jacobian(q, p, time, C, J_);
    Block::time_derivative(q, p, time, bias_);
    Block::effective_mass(J_, m, K_);
    const RowStep<T> step = row_step(stiffness, h);
    for (int i = 0; i < rows; ++i) {
      const bool bound = Block::row_kinds[i] == RowKind::inequality;
      bias_[i] += bound ? bias_of_bound(C[i], step.reduction, h) : C[i] * step.reduction / h;
      impulse[i] *= ratio;
      softness_[i] = step.softness * K_[diagonal(i)];
      K_[diagonal(i)] += softness_[i];
    }
    Block::factor(K_, F_);
  }

  void forget() {
    for (T& x : impulse) x = T(0);
  }

  template <class Mass, class Velocity>
  void warm_start(const Mass (&m)[bodies], Velocity (&v)[bodies]) const {
    Block::apply(J_, m, impulse, v);
  }

  // K lambda = b, b = -(J v + bias + softness lambda), added to the impulse so far.
  template <class Mass, class Velocity>
  void solve(const Mass (&m)[bodies], Velocity (&v)[bodies]) {
    T b[rows], change[rows];
    Block::velocity(J_, v, b);
    for (int i = 0; i < rows; ++i) b[i] = -(b[i] + bias_[i] + softness_[i] * impulse[i]);
    solve_within_bounds(b, impulse, change);
    for (int i = 0; i < rows; ++i) impulse[i] += change[i];
    Block::apply(J_, m, change, v);
  }

  // A step of Newton's method towards C = 0, or a share of it: the bodies are to move by M^-1 J^T lambda, K lambda =
  // -C. Returns the largest |C|.
  template <class Pose, class Mass, class Velocity, class Parameters>
  T project(const Pose (&q)[bodies], const Mass (&m)[bodies], const Parameters& p, T time, T share,
            Velocity (&shift)[bodies]) {
    T C[rows], change[rows], worst = T(0);
    const T none[rows] = {};
    Block::jacobian(q, p, time, C, J_);
    Block::effective_mass(J_, m, K_);
    Block::factor(K_, F_);
    for (int i = 0; i < rows; ++i) {
      const bool holds = Block::row_kinds[i] == RowKind::inequality && C[i] > T(0);
      worst = larger(worst, holds ? T(0) : abs(C[i]));
      C[i] *= -share;
    }
    solve_within_bounds(C, none, change);
    Block::apply(J_, m, change, shift);
    return worst;
  }

 private:
  // Rows with bounds are solved one after the other, others all at once.
  void solve_within_bounds(const T (&b)[rows], const T (&so_far)[rows], T (&change)[rows]) const {
    if constexpr (!has_inequalities<Block>()) {
      Block::solve(F_, b, change);
    } else {
      for (int i = 0, k = 0; i < rows; ++i) {
        T rest = b[i];
        for (int j = 0; j < i; ++j) rest -= K_[k++] * change[j];
        change[i] = rest * pivot(K_[k], K_[k]);
        ++k;
        if (Block::row_kinds[i] == RowKind::inequality) change[i] = larger(change[i], -so_far[i]);
      }
    }
  }

  typename Block::template Jacobian<T> J_;
  T K_[rows * (rows + 1) / 2] = {}, F_[rows * (rows + 1) / 2] = {}, bias_[rows] = {}, softness_[rows] = {};
};

// The motor and the limits of one coordinate: three rows with the same J.
template <class Block, class T>
class DriveRows {
 public:
  static constexpr int bodies = Block::bodies;

  T motor = T(0), lower = T(0), upper = T(0);  // impulses of the last step

  template <class Pose, class Mass, class Parameters>
  void prepare(const Pose (&q)[bodies], const Mass (&m)[bodies], const Parameters& p, T time, T h, T ratio,
               const Drive<T>& drive) {
    T C[1], K[1];
    Block::jacobian(q, p, time, C, J_);
    Block::time_derivative(q, p, time, rate_);
    Block::effective_mass(J_, m, K);
    value_ = C[0] + whole_turns<Block>(C[0], value_);
    inverse_K_ = pivot(K[0], K[0]);
    motor *= ratio, lower *= ratio, upper *= ratio;
    speed_ = drive.speed;
    most_ = drive.most * h;
    lower_bias_ = bias_of_bound(value_ - drive.lower, drive.error_reduction, h);
    upper_bias_ = bias_of_bound(drive.upper - value_, drive.error_reduction, h);
  }

  void forget() { motor = lower = upper = T(0); }

  template <class Mass, class Velocity>
  void warm_start(const Mass (&m)[bodies], Velocity (&v)[bodies]) const {
    const T all[1] = {motor + lower - upper};
    Block::apply(J_, m, all, v);
  }

  template <class Mass, class Velocity>
  void solve(const Mass (&m)[bodies], Velocity (&v)[bodies]) {
    add(m, v, motor, speed_ - rate(v), -most_, most_, T(1));
    add(m, v, lower, -rate(v) - lower_bias_, T(0), T(HUGE_VAL), T(1));
    add(m, v, upper, rate(v) - upper_bias_, T(0), T(HUGE_VAL), T(-1));
  }

 private:
  template <class Velocity>
  T rate(const Velocity (&v)[bodies]) const {
    T Jv[1];
    Block::velocity(J_, v, Jv);
    return Jv[0] + rate_[0];
  }

  // The sum is clamped, not the change: an impulse of an earlier sweep can be taken back.
  template <class Mass, class Velocity>
  void add(const Mass (&m)[bodies], Velocity (&v)[bodies], T& impulse, T b, T least, T most, T direction) const {
    const T wanted = impulse + b * inverse_K_, before = impulse;
    impulse = wanted < least ? least : most < wanted ? most : wanted;
    const T change[1] = {direction * (impulse - before)};
    Block::apply(J_, m, change, v);
  }

  typename Block::template Jacobian<T> J_;
  T rate_[1] = {}, value_ = T(0), inverse_K_ = T(0), speed_ = T(0), most_ = T(0), lower_bias_ = T(0),
    upper_bias_ = T(0);
};

// One DriveRows for each coordinate.
template <class T, class... Coordinates>
struct AllDriveRows {
  template <class F>
  void each(F) {}
};
template <class T, class First, class... Rest>
struct AllDriveRows<T, First, Rest...> {
  DriveRows<First, T> first;
  AllDriveRows<T, Rest...> rest;
  template <class F>
  void each(F f) {
    f(first);
    rest.each(f);
  }
};

// A pose of a body from its centre of mass and its angle.
template <class T>
planar::Pose<T> pose(T x, T y, T angle) {
  using std::cos, std::sin;
  return {x, y, cos(angle), sin(angle), angle};
}

// A pose of a body from its centre of mass and a quaternion e0 + e1 i + e2 j + e3 k of any length.
template <class T>
spatial::Pose<T> pose(T x, T y, T z, T e0, T e1, T e2, T e3) {
  using std::sqrt;
  const T n = inverse(sqrt(e0 * e0 + e1 * e1 + e2 * e2 + e3 * e3));
  e0 *= n, e1 *= n, e2 *= n, e3 *= n;
  const T one = T(1), two = T(2);
  return {x,
          y,
          z,
          e0,
          e1,
          e2,
          e3,
          one - two * (e2 * e2 + e3 * e3),
          two * (e1 * e2 - e0 * e3),
          two * (e1 * e3 + e0 * e2),
          two * (e1 * e2 + e0 * e3),
          one - two * (e1 * e1 + e3 * e3),
          two * (e2 * e3 - e0 * e1),
          two * (e1 * e3 - e0 * e2),
          two * (e2 * e3 + e0 * e1),
          one - two * (e1 * e1 + e2 * e2)};
}

// x += h v, and the rotation by h w.
template <class T>
void move(planar::Pose<T>& q, const planar::Velocity<T>& v, T h) {
  q = pose(q.x + h * v.x, q.y + h * v.y, q.angle + h * v.w);
}
template <class T>
void move(spatial::Pose<T>& q, const spatial::Velocity<T>& v, T h) {
  const T g = h / T(2), x = g * v.wx, y = g * v.wy, z = g * v.wz;
  q = pose(q.x + h * v.x, q.y + h * v.y, q.z + h * v.z, q.e0 - x * q.e1 - y * q.e2 - z * q.e3,
           q.e1 + x * q.e0 + y * q.e3 - z * q.e2, q.e2 + y * q.e0 + z * q.e1 - x * q.e3,
           q.e3 + z * q.e0 + x * q.e2 - y * q.e1);
}

// A joint: its rows, and a motor and limits on each of its coordinates.
template <class T, class Block, class... Coordinates>
class Joint {
 public:
  static constexpr int bodies = Block::bodies, rows = Block::rows, coordinates = sizeof...(Coordinates);

  typename Block::template Parameters<T> parameters{};
  Stiffness<T> stiffness;
  Drive<T> drives[coordinates + 1];  // by coordinate; the last one is of none

  // Sets parameter number `first` (Block::index_of_pb) and those after it to their defaults at these poses.
  template <class Pose>
  void by_default(int first, const Pose (&q)[bodies], T time) {
    for (int i = first; i < Block::index_end; ++i) Block::default_value(i, q, parameters, time);
  }

  // Before the velocities are solved, at the poses of the beginning of the step.
  template <class Pose, class Mass>
  void prepare(const Pose (&q)[bodies], const Mass (&m)[bodies], T time, T h) {
    const T ratio = h * inverse(h_ > T(0) ? h_ : h);
    h_ = h;
    turns_.count(q, parameters, time);
    rows_.prepare(q, m, parameters, time, h, ratio, stiffness);
    int i = 0;
    drive_rows_.each([&](auto& row) { row.prepare(q, m, parameters, time, h, ratio, drives[i++]); });
  }
  // Once for all joints, before the first solve(). Of bodies at rest with inverse masses 1 it makes J^T lambda: the
  // impulses that the joint exerts, with those of its drives.
  template <class Mass, class Velocity>
  void warm_start(const Mass (&m)[bodies], Velocity (&v)[bodies]) {
    drive_rows_.each([&](auto& row) { row.warm_start(m, v); });
    rows_.warm_start(m, v);
  }
  // The drives first: the joint itself has the last word.
  template <class Mass, class Velocity>
  void solve(const Mass (&m)[bodies], Velocity (&v)[bodies]) {
    drive_rows_.each([&](auto& row) { row.solve(m, v); });
    rows_.solve(m, v);
  }
  // After the bodies moved: takes them to C = 0, unless the joint is soft. Returns the largest |C| found.
  template <class Pose, class Mass>
  T project(Pose (&q)[bodies], const Mass (&m)[bodies], T time) {
    auto shift = still(q[0]);
    const T worst = correct(q, m, time, T(1), shift.of);
    for (int i = 0; i < bodies; ++i) move(q[i], shift.of[i], T(1));
    return worst;
  }
  // The same as displacements and small rotations, for an engine that moves its bodies itself; `share` of the whole
  // way.
  template <class Pose, class Mass, class Velocity>
  T correct(const Pose (&q)[bodies], const Mass (&m)[bodies], T time, T share, Velocity (&shift)[bodies]) {
    if (stiffness.hertz > T(0)) return T(0);
    turns_.count(q, parameters, time);
    return rows_.project(q, m, parameters, time, share, shift);
  }

  const T (&impulses() const)[rows] { return rows_.impulse; }  // of the last step: h times force or torque
  void forget() {                                              // after a jump of a body, no impulse is a good guess
    rows_.forget();
    drive_rows_.each([](auto& row) { row.forget(); });
  }

 private:
  template <class Velocity>
  struct Shift {
    Velocity of[bodies] = {};
  };
  static Shift<planar::Velocity<T>> still(const planar::Pose<T>&) { return {}; }
  static Shift<spatial::Velocity<T>> still(const spatial::Pose<T>&) { return {}; }

  T h_ = T(0);  // of the last step
  Rows<Block, T> rows_;
  AllDriveRows<T, Coordinates...> drive_rows_;
  Turns<T, Coordinates...> turns_;
};

}  // namespace cdot::plain
