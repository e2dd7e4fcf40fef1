#include "derive/compile/midpoint/middle.hpp"

#include <fmt/format.h>

#include "derive/compile/rows/answers.hpp"
#include "derive/compile/rows/components.hpp"
#include "derive/compile/rows/laws.hpp"
#include "derive/kernel/factor.hpp"

namespace cdot::compile {
namespace {

using derive::element;
using derive::triangle_element;

std::vector<RowBlock> blocks_of(const RowBlocks& blocks, const JointRows& joints, const Tensions& tensions) {
  std::vector<RowBlock> all = joints.system().blocks();
  for (std::size_t e = 0; e < blocks.mechanism().effects.size(); ++e) all.push_back(blocks.effect(e));
  std::ranges::copy(tensions.blocks(), std::back_inserter(all));
  return all;
}

// An effect acts at the share t of the step: in the middle, or near the end if it is too stiff for the step. With its
// force F at rest, its stiffness k and u = h^2 k K of its row,
//
//   lambda = h F - (t - 1/2) h^2 k rate,   t = max(1/2, 1 - 1 / (2 u)),   and for d: y = -t h^2 k / 2 J d.
struct EffectInMiddle {
  std::vector<int> half_impulse, answer;  // by row: lambda / 2, and -y of a rate J d of 1
  EffectInMiddle(Algebra& algebra, const LawWriter& law, const std::vector<int>& K) {
    const std::vector<int> F = law.at_rest().force(), k = law.slopes_within_limits().k;
    const int one = algebra.value(1), half = algebra.value(0.5), h = algebra.input("h");
    for (std::size_t r = 0; r < F.size(); ++r) {
      const int stiff = algebra.product({h, k[r]}, {2, 1});
      const int late = algebra.times(half, algebra.function(Fn::inverse, {algebra.times(stiff, K[r])}));
      const int t = law.most(half, algebra.sum({{one, late}, {1, -1}}));
      const int past_middle = algebra.product({algebra.sum({{t, half}, {1, -1}}), stiff, law.rate()[r]}, {1, 1, 1});
      half_impulse.push_back(algebra.times(half, algebra.sum({{algebra.times(h, F[r]), past_middle}, {1, -1}})));
      answer.push_back(algebra.times(half, algebra.times(t, stiff)));
    }
  }
};

// K of an effect's rows at the start of a step, from the place `first` on.
std::vector<int> masses_at_start(Algebra& algebra, const RowBlock& block, std::size_t first) {
  std::vector<int> K;
  for (std::size_t r = 0; r < block.rows->count(); ++r) K.push_back(algebra.input(element("K", first + r)));
  return K;
}

// One round of Newton. With the stiffness G = -d(J^T lambda)/dq of tension, whose part between bodies stands as rows,
//
//   (M + h G / 4) d - J^T y = M (before - v) + (h f + J^T lambda) / 2,   J d = -C / h,
//
// and J d = -(J v + dC/dt) of rows of velocities.
class Round {
 public:
  Round(const RowBlocks& stiff, const JointRows& joints, const Tensions& tensions, Constants& constants)
      : blocks_(stiff),
        joints_(joints),
        tensions_(tensions),
        algebra_(constants),
        system_(stiff, blocks_of(stiff, joints, tensions)),
        bounded_(stiff, algebra_) {
    h_ = algebra_.input("h"), half_ = algebra_.times(algebra_.value(0.5), h_);
    const char* const array = stiff.mechanism().has_gyroscopes() ? "mean" : "v";
    each_component(blocks_, [&](const Component& c, double, double) { mean_[c.name] = algebra_.input(c.in(array)); });
  }

  Program write() {
    Answers answers(blocks_, algebra_, system_, [&](const std::string& name) { return factor_.at(name); });
    const std::size_t joints = joints_.system().blocks().size(), rows = joints_.system().size();
    for (std::size_t k = 0; k < joints; ++k) add_joint(answers, k);
    const std::size_t effects = blocks_.mechanism().effects.size();
    for (std::size_t e = 0; e < effects; ++e) add_effect(answers, joints + e, e);
    for (std::size_t t = 0; joints + effects + t < system_.blocks().size(); ++t)
      add_tension(answers, joints + effects + t, t);
    factor();
    const Answers::Answer change =
        answers.to(lack(), [&](std::size_t row) { return row < rows ? missed_[row] : algebra_.value(0); });
    for (std::size_t row = 0; row < rows; ++row) algebra_.output(element("y", row), change.lambda[row]);
    each_component(blocks_, [&](const Component& component, double, double) {
      algebra_.output(component.in("d"), change.velocities.at(component.name));
    });
    algebra_.output("power", algebra_.sum(power_));
    if (blocks_.mechanism().bounded.empty()) return algebra_.finish();
    bounded_.answer(
        answers, rows, [](std::size_t) { return true; }, BoundedSystem::Outputs::impulses);
    bounded_.output_changes(change.velocities, mean_, h_);
    return algebra_.finish();
  }

 private:
  void add_joint(Answers& answers, std::size_t k) {
    const RowBlock& joint = system_.blocks()[k];
    Values in = blocks_.inputs_with_jacobian(algebra_, joint);
    system_.add_block(algebra_, k, in);
    blocks_.replace_velocities(in, joint, mean_);
    const Values Jv = blocks_.call(algebra_, joint, "velocity", in);
    const bool has_rates = joint.rows->has_rates || joint.in_time;
    const Values C_t = has_rates ? blocks_.call(algebra_, joint, "time_derivative", in) : Values{};
    std::vector<int> lambda;
    for (std::size_t r = 0; r < joint.rows->count(); ++r) {
      const int impulse = algebra_.input(element("lambda", system_.first_row(k) + r));
      const int drift = C_t.empty() ? algebra_.value(0) : C_t.at(element("C_t", r));
      const int rate = algebra_.sum({{Jv.at(element("Jv", r)), drift}, {1, 1}});
      const bool is_rate = joint.joint->is_rate[r];
      const int C = algebra_.input(element("C", system_.first_row(k) + r));
      missed_.push_back(is_rate ? rate : algebra_.times(algebra_.function(Fn::inverse, {h_}), C));
      power_.add(1, algebra_.times(impulse, rate));
      lambda.push_back(half_of(impulse));
    }
    blocks_.add_forces(algebra_, joint, in, lambda, forces_);
    answers.add(in, {});
  }

  void add_effect(Answers& answers, std::size_t k, std::size_t e) {
    const RowBlock& block = blocks_.effect(e);
    const Values in = blocks_.inputs_with_jacobian(algebra_, block);
    system_.add_block(algebra_, k, in);
    const std::vector<int> K = masses_at_start(algebra_, block, share_.size());
    const LawWriter law = LawWriter(blocks_, algebra_, blocks_.mechanism().effects[e], block, in).with_masses(K);
    const EffectInMiddle middle(algebra_, law, K);
    std::vector<int> share;
    for (const int answer : middle.answer) share.push_back(algebra_.function(Fn::sqrt, {answer}));
    blocks_.add_forces(algebra_, block, in, middle.half_impulse, forces_);
    share_.insert(share_.end(), share.begin(), share.end());
    answers.add(in, share);
  }

  void add_tension(Answers& answers, std::size_t k, std::size_t t) {
    const Values in = tensions_.inputs(algebra_, blocks_, t);
    system_.add_block(algebra_, k, in);
    const std::vector<int> share = tensions_.share(algebra_, t);
    share_.insert(share_.end(), share.begin(), share.end());
    answers.add(in, share);
  }

  void factor() {
    system_.couple(algebra_);
    const std::size_t joints = joints_.system().size();
    for (std::size_t row = joints; row < system_.size(); ++row) system_.soften(algebra_, row, share_[row - joints]);
    system_.factor(algebra_, [&](const std::string& name, int op) { factor_[name] = op; });
  }

  // (M + h G / 4)^-1 (M (before - v) + h f / 2 + J^T lambda / 2)
  Values lack() {
    bounded_.add_half_impulses(forces_);
    Forces torques;
    blocks_.add_torques(algebra_, torques);
    for (const auto& [place, terms] : torques) forces_[place].add(1, algebra_.times(half_, algebra_.sum(terms)));
    std::map<std::pair<int, std::size_t>, int> changes;
    each_component(blocks_, [&](const Component& c, double a, double) {
      changes[{c.body, c.column}] = algebra_.sum(
          {{algebra_.input(c.in("before")), algebra_.input(c.in("v")), algebra_.times(half_, algebra_.value(a))},
           {1, -1, 1}});
    });
    each_component(blocks_, [&](const Component& c, double, double) {
      const int momentum = blocks_.momentum(algebra_, c.body, c.column, [&](std::size_t column) {
        return changes.at({c.body, column});
      });
      forces_[{c.body, c.column}].add(1, momentum);
    });
    Values lack;
    each_component(
        blocks_, [&](const Component& c, double, double) { lack[c.name] = change_of(blocks_, algebra_, c, forces_); });
    return lack;
  }

  int half_of(int op) { return algebra_.times(algebra_.value(0.5), op); }

  const RowBlocks& blocks_;
  const JointRows& joints_;
  const Tensions& tensions_;
  Algebra algebra_;
  RowSystem system_;  // of joints, effects and tension
  BoundedSystem bounded_;
  int h_, half_;
  Values mean_;              // velocities of the drift
  std::vector<int> missed_;  // by row of the joints: C / h of the end, or the rate of a row of velocities
  Summands power_;           // of the joints, in the step
  std::map<std::string, int> factor_;
  std::vector<int> share_;  // by row of the effects and of tension
  Forces forces_;           // impulses of half a step
};

}  // namespace

Middle::Middle(const RowBlocks& blocks, const JointRows& joints, Constants& constants)
    : blocks_(blocks),
      stiff_(joints.system().size() > 0 || !blocks.mechanism().bounded.empty() ? blocks.stiffened(constants) : blocks),
      joints_(joints),
      tensions_(blocks, joints, constants),
      constants_(constants) {}

Program Middle::weigh() const {
  Algebra algebra(constants_);
  std::size_t row = 0;
  for (std::size_t e = 0; e < blocks_.mechanism().effects.size(); ++e) {
    const RowBlock& block = blocks_.effect(e);
    const Values K = blocks_.call(algebra, block, "effective_mass", blocks_.inputs_with_jacobian(algebra, block));
    for (std::size_t r = 0; r < block.rows->count(); ++r, ++row) {
      const int own = K.at(triangle_element("K", r, r));
      algebra.output(element("K", row), own);
      constants_.at_start[element("K", row)] = algebra.at_start(own);
    }
  }
  return algebra.finish();
}

// In the plane, with the positive part of G: inv_I / (1 + h G inv_I / 4).
int Middle::stiffened(Algebra& algebra, int body, int G) const {
  const int quarter = algebra.times(algebra.value(0.25), algebra.input("h"));
  const int inv_I = blocks_.inverse_inertia(algebra, body, 0, 0);
  const int added = algebra.times(quarter, algebra.function(Fn::select, {G, G, algebra.value(0)}));
  const int times = algebra.sum({{algebra.value(1), algebra.times(added, inv_I)}, {1, 1}});
  return algebra.times(inv_I, algebra.function(Fn::inverse, {times}));
}

// The symmetric part of -d(J^T lambda)/dq of one block; if it is not asked for as a whole, of own rotations alone.
std::vector<std::vector<int>> Middle::stiffness_of(Algebra& algebra, const RowBlock& block, const char* impulses,
                                                   std::size_t first, bool whole) const {
  const std::size_t columns = blocks_.mechanism().columns(), n = columns * block.bodies->size();
  const auto turns = [&](std::size_t i) { return i % columns >= blocks_.mechanism().linear(); };
  Values in = blocks_.inputs(algebra, block);
  for (std::size_t r = 0; r < block.rows->count(); ++r)
    in[fmt::format("lambda_{}", r + 1)] = algebra.input(element(impulses, first + r));
  const Values of_block = blocks_.call(algebra, block, "stiffness", in);
  std::vector<std::vector<int>> A(n, std::vector<int>(n));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      if (whole || (i / columns == j / columns && turns(i) && turns(j)))
        A[i][j] = algebra.sum({{of_block.at(element(element("H", i), j)), of_block.at(element(element("H", j), i))},
                               {Rational(-1, 2), Rational(-1, 2)}});
  return A;
}

Program Middle::stiffen() const {
  Algebra algebra(constants_);
  const std::size_t columns = blocks_.mechanism().columns(), linear = blocks_.mechanism().linear();
  std::map<std::pair<int, std::size_t>, Summands> own;  // of each body's own rotation, by columns i and j
  std::size_t number = 0;
  const auto add = [&](const RowBlock& block, const char* impulses, std::size_t first) {
    std::vector<std::vector<int>> A = stiffness_of(algebra, block, impulses, first, tensions_.has(number));
    tensions_.write(algebra, number++, A);
    for (std::size_t b = 0; b < block.bodies->size(); ++b)
      for (std::size_t i = linear; i < columns; ++i)
        for (std::size_t j = i; j < columns; ++j)
          own[{(*block.bodies)[b], columns * i + j}].add(1, A[columns * b + i][columns * b + j]);
  };
  for (std::size_t k = 0; k < joints_.system().blocks().size(); ++k)
    add(joints_.system().blocks()[k], "lambda", joints_.system().first_row(k));
  for (std::size_t b = 0; b < blocks_.mechanism().bounded.size(); ++b) add(blocks_.bounded(b), "mu", b);
  for (int body = 0; body < static_cast<int>(blocks_.mechanism().bodies.size()); ++body) {
    if (!blocks_.mechanism().bodies[static_cast<std::size_t>(body)].turns()) continue;
    for (std::size_t i = linear; i < columns; ++i)
      for (std::size_t j = i; j < columns; ++j) {
        const int G = algebra.sum(own[{body, columns * i + j}], "G_" + blocks_.body_name(body));
        algebra.output(stiff_.stiffened_name(body, i - linear, j - linear),
                       blocks_.mechanism().spatial() ? G : stiffened(algebra, body, G));
      }
  }
  return algebra.finish();
}

Program Middle::bear(const Borne& borne) const {
  return borne.write(constants_, [&](Algebra& algebra, std::size_t e, const LawWriter& law, const Values& in) {
    std::size_t first = 0;
    for (std::size_t before = 0; before < e; ++before) first += blocks_.effect(before).rows->count();
    const RowBlock& block = blocks_.effect(e);
    const std::vector<int> K = masses_at_start(algebra, block, first);
    const EffectInMiddle middle(algebra, law.with_masses(K), K);
    Values change = in;
    blocks_.replace_velocities(change, block, velocities_in(blocks_, algebra, "d"));
    const Values Jd = blocks_.call(algebra, block, "velocity", change);
    const int per_half = algebra.times(algebra.value(2), algebra.function(Fn::inverse, {algebra.input("h")}));
    std::vector<int> forces;
    for (std::size_t r = 0; r < K.size(); ++r) {
      const int y = algebra.times(middle.answer[r], Jd.at(element("Jv", r)));
      forces.push_back(algebra.times(per_half, algebra.sum({{middle.half_impulse[r], y}, {1, -1}})));
    }
    return forces;
  });
}

Program Middle::improve() const { return Round(stiff_, joints_, tensions_, constants_).write(); }

}  // namespace cdot::compile
