// The middle of a step by the implicit midpoint rule, as functions of the header. As the World does it:
// runtime/step/find_middle.cpp.
#pragma once

#include "derive/compile/borne/borne.hpp"
#include "derive/compile/midpoint/tensions.hpp"
#include "derive/compile/rows/joint_rows.hpp"

namespace cdot::compile {

class Middle {
 public:
  Middle(const RowBlocks& blocks, const JointRows& joints, Constants& constants);

  // q, time -> K: J M^-1 J^T of each row of an effect, at the start of a step.
  Program weigh() const;
  // q, time, h, lambda, mu -> W: inverse inertias with the stiffness of tension, (I + h G / 4)^-1. In space W is G
  // itself: -d(J^T lambda)/dq of each body's own rotation. N: rows of the part between
  // bodies.
  Program stiffen() const;
  // q, time, v, before, mean, W, N, h, lambda, C, K -> d, y, power: one round of Newton for the mean velocities v of a
  // step from `before`, and for lambda, which changes by 2 y. q are the poses of the middle, C is that of the end.
  // `power` is the work of the joints, lambda (J v + dC/dt); `mean` is v with the mean spins of the drift, where
  // inertias turn. With rows that have bounds, and mu, missed, side -> B: these are without the change of mu, and B
  // gives half of it.
  Program improve() const;

  // q, v, time, d, h, K -> borne: mean forces of effects that may break in a step of h, with a change d of its mean
  // velocities v from that of the poses.
  Program bear(const Borne& borne) const;

  const Tensions& tensions() const { return tensions_; }

 private:
  std::vector<std::vector<int>> stiffness_of(Algebra& algebra, const RowBlock& block, const char* impulses,
                                             std::size_t first, bool whole) const;
  int stiffened(Algebra& algebra, int body, int G) const;

  const RowBlocks& blocks_;
  const RowBlocks stiff_;
  const JointRows& joints_;
  const Tensions tensions_;
  Constants& constants_;
};

}  // namespace cdot::compile
