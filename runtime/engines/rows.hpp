// A joint as rows, for an engine of bodies in space that solves rows itself: J, the velocity J v that each row asks
// for, the bounds of its impulse, and its softness.
#pragma once

#include <cdot/kernel.hpp>

#include "runtime/engines/plain.hpp"

namespace cdot::rows {

// J v = aim - softness K_ii impulse, with least <= impulse <= most.
template <class T, int bodies>
struct Row {
  T J[6 * bodies];  // by v and w of each body, in world axes
  T aim, least, most, softness;
};

template <class T, class Block, class... Coordinates>
class Joint {
 public:
  static constexpr int bodies = Block::bodies, rows = Block::rows, coordinates = sizeof...(Coordinates);
  using Parameters = typename Block::template Parameters<T>;
  using Pose = spatial::Pose<T>;

  Parameters parameters{};
  plain::Stiffness<T> stiffness;  // hertz: above 0 instead of ERP and CFM
  T time = T(0);                  // yours to set before a step, where C depends on time
  plain::Drive<T> drives[coordinates + 1];

  explicit Joint(const Parameters& p) : parameters(p) {}

 protected:
  static constexpr int most_rows = rows + 3 * coordinates;

  void by_default(int first, const Pose (&q)[bodies]) {
    for (int i = first; i < Block::index_end; ++i) Block::default_value(i, q, parameters, time);
  }

  int drive_count(int i) const {
    const plain::Drive<T>& d = drives[i];
    return d.has_motor() + is_limit(d.lower) + is_limit(d.upper);
  }
  int count() const {
    int all = rows;
    for (int i = 0; i < coordinates; ++i) all += drive_count(i);
    return all;
  }

  // Once a step, before its rows are written.
  void count_turns(const Pose (&q)[bodies]) { turns_.count(q, parameters, time); }

  // Calls write(row) for each row of the joint itself, for a step of length h. A rigid row takes back `erp` of C.
  template <class F>
  void write_rows(const Pose (&q)[bodies], T h, T erp, F write) const {
    typename Block::template Jacobian<T> J;
    T C[rows], C_t[rows], D[rows][6 * bodies];
    Block::jacobian(q, parameters, time, C, J);
    Block::time_derivative(q, parameters, time, C_t);
    Block::dense(J, D);
    plain::RowStep<T> step = plain::row_step(stiffness, h);
    if (!is_soft()) step = {erp, T(0)};
    for (int i = 0; i < rows; ++i) {
      const bool bound = Block::row_kinds[i] == RowKind::inequality;
      const T bias = C_t[i] + (bound ? plain::bias_of_bound(C[i], step.reduction, h) : C[i] * step.reduction / h);
      write(row_of(D[i], -bias, bound ? T(0) : T(-HUGE_VAL), T(HUGE_VAL), step.softness));
    }
  }

  // The same for the motor and the limits of coordinate i.
  template <class F>
  void write_drive([[maybe_unused]] int i, [[maybe_unused]] const Pose (&q)[bodies], [[maybe_unused]] T h,
                   [[maybe_unused]] T erp, [[maybe_unused]] F write) {
    [[maybe_unused]] int k = 0;
    ((k++ == i ? write_drive_of<Coordinates>(i, q, h, erp, write) : void()), ...);
  }

  bool is_soft() const { return stiffness.hertz > T(0); }

 private:
  static bool is_limit(T bound) { return abs(bound) < T(HUGE_VAL); }

  static Row<T, bodies> row_of(const T (&D)[6 * bodies], T aim, T least, T most, T softness = T(0), T sign = T(1)) {
    Row<T, bodies> row{{}, aim, least, most, softness};
    for (int k = 0; k < 6 * bodies; ++k) row.J[k] = sign * D[k];
    return row;
  }

  template <class Coordinate, class F>
  void write_drive_of(int i, const Pose (&q)[bodies], T h, T erp, F& write) {
    const plain::Drive<T>& drive = drives[i];
    typename Coordinate::template Jacobian<T> J;
    T C[1], rate[1], D[1][6 * bodies];
    Coordinate::jacobian(q, parameters, time, C, J);
    Coordinate::time_derivative(q, parameters, time, rate);
    Coordinate::dense(J, D);
    values_[i] = C[0] + plain::whole_turns<Coordinate>(C[0], values_[i]);
    const T most = drive.most * h, lower_gap = values_[i] - drive.lower, upper_gap = drive.upper - values_[i];
    if (drive.has_motor()) write(row_of(D[0], drive.speed - rate[0], -most, most));
    if (is_limit(drive.lower))
      write(row_of(D[0], -rate[0] - plain::bias_of_bound(lower_gap, erp, h), T(0), T(HUGE_VAL)));
    if (is_limit(drive.upper))
      write(row_of(D[0], rate[0] - plain::bias_of_bound(upper_gap, erp, h), T(0), T(HUGE_VAL), T(0), T(-1)));
  }

  T values_[coordinates + 1] = {};  // of the coordinates in the last step
  plain::Turns<T, Coordinates...> turns_;
};

}  // namespace cdot::rows
