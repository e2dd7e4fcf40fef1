#include "derive/compile/rows/kick.hpp"

#include <deque>

#include "derive/compile/rows/bounds.hpp"
#include "derive/compile/rows/components.hpp"
#include "derive/compile/rows/motion.hpp"
#include "derive/kernel/factor.hpp"

namespace cdot::compile {
namespace {

using derive::element;
using derive::triangle_element;

// Velocities as inputs, by the names of components.
Values velocities_in(const RowBlocks& blocks, Algebra& algebra, const std::string& array) {
  Values velocities;
  each_component(blocks, [&](const Component& c, double, double) { velocities[c.name] = algebra.input(c.in(array)); });
  return velocities;
}

// How joints and effects answer to a change of the velocities: K lambda = -J u, u + M^-1 J^T lambda. Rows of effects
// are J times their share.
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
    Values velocities;
  };
  // drift(row): what J u misses of the rate, dC/dt.
  Answer to(const Values& u, const std::function<int(std::size_t row)>& drift) const {
    std::vector<int> b;
    for (std::size_t k = 0; k < inputs_.size(); ++k) {
      const RowBlock& block = system_.blocks()[k];
      Values in = inputs_[k];
      blocks_.replace_velocities(in, block, u);
      const Values Jv = blocks_.call(algebra_, block, "velocity", in);
      for (std::size_t r = 0; r < block.rows->count(); ++r)
        b.push_back(
            algebra_.sum({{shared(k, r, algebra_.sum({{Jv.at(element("Jv", r)), drift(b.size())}, {1, 1}}))}, {-1}}));
    }
    Answer answer{system_.solve(algebra_, b, factor_), {}};
    Forces forces;
    for (std::size_t k = 0; k < inputs_.size(); ++k) {
      std::vector<int> of_block;
      for (std::size_t r = 0; r < system_.blocks()[k].rows->count(); ++r) {
        int& lambda = answer.lambda[system_.first_row(k) + r];
        lambda = shared(k, r, lambda);
        of_block.push_back(lambda);
      }
      blocks_.add_forces(algebra_, system_.blocks()[k], inputs_[k], of_block, forces);
    }
    each_component(blocks_, [&](const Component& component, double, double) {
      const int change = change_of(blocks_, algebra_, component, forces);
      answer.velocities[component.name] = algebra_.sum({{u.at(component.name), change}, {1, 1}});
    });
    return answer;
  }
  Answer to(const Values& u) const {
    return to(u, [&](std::size_t) { return algebra_.value(0); });
  }

 private:
  int shared(std::size_t block, std::size_t row, int op) const {
    return share_[block].empty() ? op : algebra_.times(share_[block][row], op);
  }

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
  BoundedSystem(const RowBlocks& blocks, Algebra& algebra) : blocks_(blocks), algebra_(algebra) {
    for (std::size_t b = 0; b < blocks.mechanism().bounded.size(); ++b) rows_.emplace_back(blocks, algebra, b);
  }
  // `takes_part(row)`; others get neither g nor S. `lambda`: also outputs B.l, the impulses of the joints.
  void answer(const Answers& answers, std::size_t joint_rows, const std::function<bool(std::size_t)>& takes_part,
              bool lambda) {
    for (std::size_t b = 0; b < rows_.size(); ++b) {
      Values unit;
      Forces forces;
      const bool takes = takes_part(b);
      if (takes) blocks_.add_forces(algebra_, rows_[b].block(), rows_[b].inputs(), {algebra_.value(1)}, forces);
      each_component(
          blocks_, [&](const Component& c, double, double) { unit[c.name] = change_of(blocks_, algebra_, c, forces); });
      const Answers::Answer answer = answers.to(unit);
      each_component(blocks_, [&](const Component& c, double, double) {
        algebra_.output(c.in("B." + element("g", b)), answer.velocities.at(c.name));
      });
      for (std::size_t row = 0; lambda && row < joint_rows; ++row)
        algebra_.output(element("B." + element("l", b), row), answer.lambda[row]);
      for (std::size_t a = 0; a < rows_.size(); ++a)
        if (a >= b) S_[{a, b}] = takes_part(a) ? rows_[a].along(answer.velocities) : algebra_.value(0);
      K_.push_back(takes ? rows_[b].along(unit) : algebra_.value(0));
    }
  }

  void output_S(const std::vector<int>& softness) {
    for (std::size_t a = 0; a < rows_.size(); ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        const bool softened = a == b && !softness.empty();
        const int entry = softened ? algebra_.sum({{S_.at({a, b}), softness[a]}, {1, 1}}) : S_.at({a, b});
        algebra_.output("B." + triangle_element("S", a, b), entry);
      }
  }

  void output_bounds(const Values& next, int h) {
    std::vector<int> softness;
    for (std::size_t b = 0; b < rows_.size(); ++b) {
      const BoundWriter::Kick kick = rows_[b].kick(h);
      softness.push_back(kick.softness);
      algebra_.output("B." + element("c", b),
                      algebra_.sum({{rows_[b].along(next), rows_[b].drift(), kick.bias}, {-1, -1, -1}}));
      algebra_.output("B." + element("low", b), kick.low);
      algebra_.output("B." + element("high", b), kick.high);
      algebra_.output("B." + element("K", b), K_[b]);
    }
    output_S(softness);
  }

 private:
  const RowBlocks& blocks_;
  Algebra& algebra_;
  std::deque<BoundWriter> rows_;                          // which refer to their own members
  std::map<std::pair<std::size_t, std::size_t>, int> S_;  // lower triangle
  std::vector<int> K_;                                    // J M^-1 J^T of each row alone
};

// A step of h that is implicit as far as the slopes k and d of the laws say. With rate and F at the start,
//   lambda = h (F + d (rate - rate') - h k rate') = h (F + d rate) + r mu,   r^2 = h (d + h k),
// the rows r J v' + mu = 0 give mu together with the impulses of the joints: 1 is added to their diagonals.
class KickWriter {
 public:
  KickWriter(const RowBlocks& blocks, const JointRows& joints, Constants& constants)
      : blocks_(blocks), joints_(joints), algebra_(constants), system_(blocks, all_blocks(blocks, joints)) {
    h_ = algebra_.input("h");
  }

  Program write() {
    Answers answers(blocks_, algebra_, system_, [&](const std::string& name) { return factor_.at(name); });
    const std::size_t joints = joints_.system().blocks().size();
    for (std::size_t k = 0; k < joints; ++k) {
      const Values in = joints_.inputs(algebra_, k);
      system_.add_block(algebra_, k, in);
      answers.add(in, {});
    }
    for (std::size_t e = 0; e < blocks_.mechanism().effects.size(); ++e) add_effect(answers, joints + e, e);
    factor();
    const std::size_t rows = joints_.system().size();
    const Answers::Answer end = answers.to(
        pushed(), [&](std::size_t row) { return row < rows ? joints_.drift(algebra_, row) : drifts_[row - rows]; });
    for (std::size_t row = 0; row < rows; ++row) algebra_.output(element("lambda", row), end.lambda[row]);
    each_component(blocks_, [&](const Component& component, double, double) {
      algebra_.output(component.in("next"), end.velocities.at(component.name));
    });
    if (blocks_.mechanism().bounded.empty()) return algebra_.finish();
    BoundedSystem bounded(blocks_, algebra_);
    bounded.answer(
        answers, rows, [](std::size_t) { return true; }, true);
    bounded.output_bounds(end.velocities, h_);
    return algebra_.finish();
  }

 private:
  static std::vector<RowBlock> all_blocks(const RowBlocks& blocks, const JointRows& joints) {
    std::vector<RowBlock> all = joints.system().blocks();
    for (std::size_t e = 0; e < blocks.mechanism().effects.size(); ++e) all.push_back(blocks.effect(e));
    return all;
  }

  void add_effect(Answers& answers, std::size_t k, std::size_t e) {
    const RowBlock& block = blocks_.effect(e);
    const Values in = blocks_.inputs_with_jacobian(algebra_, block);
    system_.add_block(algebra_, k, in);
    const LawWriter law(blocks_, algebra_, blocks_.mechanism().effects[e], block, in);
    const std::vector<int> F = law.force();
    const LawWriter::Slopes slopes = law.slopes();
    std::vector<int> impulses, share;
    for (std::size_t r = 0; r < F.size(); ++r) {
      const int force = algebra_.sum({{F[r], algebra_.times(slopes.d[r], law.rate()[r])}, {1, 1}});
      impulses.push_back(algebra_.times(h_, force));
      const int both = algebra_.sum({{slopes.d[r], algebra_.times(h_, slopes.k[r])}, {1, 1}});
      share.push_back(algebra_.function(Fn::sqrt, {algebra_.times(h_, both)}));
      drifts_.push_back(law.drift()[r]);
    }
    blocks_.add_forces(algebra_, block, in, impulses, given_);
    share_.insert(share_.end(), share.begin(), share.end());
    answers.add(in, share);
  }

  void factor() {
    system_.couple(algebra_);
    const std::size_t joints = joints_.system().size();
    for (std::size_t row = joints; row < system_.size(); ++row) system_.soften(algebra_, row, share_[row - joints]);
    system_.factor(algebra_, [&](const std::string& name, int op) { factor_[name] = op; });
  }

  // Gravity, constant forces, drag and the known impulses act. Drag is implicit: v / (1 + h d).
  Values pushed() {
    Forces torques;
    blocks_.add_torques(algebra_, torques);
    Values velocities;
    each_component(blocks_, [&](const Component& component, double a, double drag) {
      const int slowed = algebra_.sum({{algebra_.value(1), algebra_.times(h_, algebra_.value(drag))}, {1, 1}});
      const int v = algebra_.times(algebra_.input(component.in("v")), algebra_.function(Fn::inverse, {slowed}));
      const int rate = algebra_.sum({{algebra_.value(a), change_of(blocks_, algebra_, component, torques)}, {1, 1}});
      const int change = change_of(blocks_, algebra_, component, given_);
      velocities[component.name] = algebra_.sum({{v, algebra_.times(h_, rate), change}, {1, 1, 1}});
    });
    return velocities;
  }

  const RowBlocks& blocks_;
  const JointRows& joints_;
  Algebra algebra_;
  RowSystem system_;  // of joints and effects
  int h_;
  std::map<std::string, int> factor_;
  std::vector<int> share_, drifts_;  // r and dC/dt, by row of the effects
  Forces given_;                     // impulses h (F + d rate)
};

}  // namespace

Program accelerations_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants) {
  Algebra algebra(constants);
  Answers answers(blocks, algebra, joints.system(),
                  [&](const std::string& name) { return joints.factor(algebra, name); });
  std::vector<int> rest;  // -gamma
  for (std::size_t k = 0; k < joints.system().blocks().size(); ++k) {
    const RowBlock& joint = joints.system().blocks()[k];
    const Values in = joints.inputs(algebra, k);
    answers.add(in, {});
    const Values g = blocks.call(algebra, joint, "gamma", in);
    for (std::size_t r = 0; r < joint.rows->count(); ++r) rest.push_back(algebra.sum({{g.at(element("g", r))}, {-1}}));
  }
  const Answers::Answer answer =
      answers.to(free_accelerations(blocks, algebra), [&](std::size_t row) { return rest[row]; });
  for (std::size_t row = 0; row < rest.size(); ++row) algebra.output(element("lambda", row), answer.lambda[row]);
  each_component(blocks, [&](const Component& component, double, double) {
    algebra.output(component.in("a"), answer.velocities.at(component.name));
  });
  return algebra.finish();
}

Program kick_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants) {
  return KickWriter(blocks, joints, constants).write();
}

Program reach_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants) {
  Algebra algebra(constants);
  Answers answers(blocks, algebra, joints.system(),
                  [&](const std::string& name) { return joints.factor(algebra, name); });
  for (std::size_t k = 0; k < joints.system().blocks().size(); ++k) answers.add(joints.inputs(algebra, k), {});
  BoundedSystem bounded(blocks, algebra);
  bounded.answer(
      answers, joints.system().size(), [&](std::size_t b) { return has_ends(blocks, b); }, false);
  bounded.output_S({});
  return algebra.finish();
}

Program past_of(const RowBlocks& blocks, Constants& constants) {
  Algebra algebra(constants);
  for (std::size_t b = 0; b < blocks.mechanism().bounded.size(); ++b)
    algebra.output(element("past", b), BoundWriter(blocks, algebra, b).past());
  return algebra.finish();
}

Program along_of(const RowBlocks& blocks, Constants& constants) {
  Algebra algebra(constants);
  const Values velocities = velocities_in(blocks, algebra, "v");
  for (std::size_t b = 0; b < blocks.mechanism().bounded.size(); ++b)
    algebra.output(element("along", b), BoundWriter(blocks, algebra, b).along(velocities));
  return algebra.finish();
}

}  // namespace cdot::compile
