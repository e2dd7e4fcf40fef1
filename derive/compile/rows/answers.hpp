// How joints and effects answer to changes of the velocities, and rows with bounds among them.
#pragma once

#include <deque>

#include "derive/compile/rows/bounds.hpp"
#include "derive/compile/rows/row_system.hpp"

namespace cdot::compile {

// K lambda = -J u, u + M^-1 J^T lambda. Rows of effects are J times their share.
class Answers {
 public:
  Answers(const RowBlocks& blocks, Algebra& algebra, const RowSystem& system, RowSystem::Read factor)
      : blocks_(blocks), algebra_(algebra), system_(system), factor_(std::move(factor)) {}

  // Call for each block of the system, in order; share: by row, empty for joints.
  void add(Values inputs, std::vector<int> share) {
    inputs_.push_back(std::move(inputs));
    share_.push_back(std::move(share));
  }

  struct Answer {
    std::vector<int> lambda;
    Values velocities, by_joints;  // by_joints: what their impulses change
  };
  // drift(row): what J u misses of the rate, dC/dt.
  Answer to(const Values& u, const std::function<int(std::size_t row)>& drift) const;
  Answer to(const Values& u) const {
    return to(u, [&](std::size_t) { return algebra_.value(0); });
  }

 private:
  int shared(std::size_t block, std::size_t row, int op) const {
    return share_[block].empty() ? op : algebra_.times(share_[block][row], op);
  }
  void add_changes(Answer& answer, const Values& u) const;

  const RowBlocks& blocks_;
  Algebra& algebra_;
  const RowSystem& system_;
  RowSystem::Read factor_;
  std::vector<Values> inputs_;
  std::vector<std::vector<int>> share_;
};

// The rows with bounds: g answers to a unit impulse on each, S = J g, and S mu = c makes J v' + bias = 0.
class BoundedSystem {
 public:
  BoundedSystem(const RowBlocks& blocks, Algebra& algebra);

  // Beside g and S: B.l, the impulses of the joints; by RATTLE B.p and B.u.
  enum class Outputs { velocities, impulses, pulls };
  // `takes_part(row)`; others get neither g nor S.
  void answer(const Answers& answers, std::size_t joint_rows, const std::function<bool(std::size_t)>& takes_part,
              Outputs outputs);
  void output_S(const std::vector<int>& softness);
  // Of a step of h; halved: the other half acts at the start of the next step.
  void output_bounds(const Values& next, int h, bool halved);
  // Of the impulses mu of a step of h, half of the change that answers to a change w of its mean velocities v. A row of
  // a rate misses it in the middle.
  void output_changes(const Values& w, const Values& v, int h);
  // forces += J^T mu / 2
  void add_half_impulses(Forces& forces) const;
  // The forces that hold rows, from accelerations a: J a + J g mu = gamma + the derivative of the prescribed rate.
  void output_accelerations(const Values& a);
  // Forces by which rates become those prescribed in the time h/2, from accelerations a:
  //   J a - gamma + (J v + dC/dt - rate) / (h/2) = 0
  // Ends that are met carry loads.
  void output_forces(const Values& a, int h);

 private:
  void output_row(std::size_t b, int c, const BoundWriter::Kick& kick);
  void output_pulls(std::size_t b, const Values& unit, const Values& by_joints);
  BoundWriter::Kick half_of(BoundWriter::Kick kick);

  const RowBlocks& blocks_;
  Algebra& algebra_;
  std::deque<BoundWriter> rows_;                          // which refer to their own members
  std::map<std::pair<std::size_t, std::size_t>, int> S_;  // lower triangle
  std::vector<int> K_;                                    // J M^-1 J^T of each row alone
};

}  // namespace cdot::compile
