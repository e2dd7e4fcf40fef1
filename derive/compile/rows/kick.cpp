#include "derive/compile/rows/kick.hpp"

#include "derive/compile/rows/answers.hpp"
#include "derive/compile/rows/components.hpp"
#include "derive/compile/rows/motion.hpp"
#include "derive/kernel/factor.hpp"

namespace cdot::compile {
namespace {

using derive::element;

// The rows r J v' + mu = 0 of effects give mu together with the impulses of the joints: 1 is added to their diagonals.
// r is their share, and their impulse that of EffectRows: given - r^2 dC/dt + r mu.
class KickWriter {
 public:
  KickWriter(const RowBlocks& blocks, const JointRows& joints, Constants& constants, const KickPlan& plan)
      : blocks_(blocks),
        joints_(joints),
        plan_(plan),
        algebra_(constants),
        system_(blocks, all_blocks(blocks, joints, plan)) {
    h_ = algebra_.input("h");
  }

  Program write() {
    const bool by_rattle = blocks_.mechanism().method == Method::rattle;
    const bool by_euler = blocks_.mechanism().method == Method::euler;
    Answers answers(blocks_, algebra_, system_, [&](const std::string& name) { return factor_.at(name); });
    const std::size_t joints = joints_.system().blocks().size();
    for (std::size_t k = 0; k < joints; ++k) {
      const Values in = joints_.inputs(algebra_, k);
      system_.add_block(algebra_, k, in);
      answers.add(in, {});
    }
    for (std::size_t k = 0; k < plan_.effects.size(); ++k) add_effect(answers, joints + k, plan_.effects[k]);
    factor();
    const std::size_t rows = joints_.system().size();
    const std::vector<int> wanted = by_euler ? fed_back() : std::vector<int>(rows, algebra_.value(0));
    const Answers::Answer end = answers.to(by_euler ? pushed() : given(), [&](std::size_t row) {
      if (row >= rows) return drifts_[row - rows];
      return algebra_.sum({{joints_.drift(algebra_, row), wanted[row]}, {1, 1}});
    });
    for (std::size_t row = 0; row < rows; ++row) algebra_.output(element("lambda", row), end.lambda[row]);
    output("next", end.velocities);
    if (by_rattle) output("pull", end.by_joints);
    if (blocks_.mechanism().bounded.empty()) return algebra_.finish();
    BoundedSystem bounded(blocks_, algebra_);
    bounded.answer(
        answers, rows, [](std::size_t) { return true; },
        by_rattle ? BoundedSystem::Outputs::pulls : BoundedSystem::Outputs::impulses);
    bounded.output_bounds(end.velocities, h_, by_rattle);
    return algebra_.finish();
  }

 private:
  static std::vector<RowBlock> all_blocks(const RowBlocks& blocks, const JointRows& joints, const KickPlan& plan) {
    std::vector<RowBlock> all = joints.system().blocks();
    for (const std::size_t e : plan.effects) all.push_back(blocks.effect(e));
    return all;
  }

  void add_effect(Answers& answers, std::size_t k, std::size_t e) {
    const RowBlock& block = blocks_.effect(e);
    const Values in = blocks_.inputs_with_jacobian(algebra_, block);
    system_.add_block(algebra_, k, in);
    const LawWriter law(blocks_, algebra_, blocks_.mechanism().effects[e], block, in);
    const EffectRows rows = plan_.rows_of(algebra_, e, law, in);
    blocks_.add_forces(algebra_, block, in, rows.given, given_);
    drifts_.insert(drifts_.end(), law.drift().begin(), law.drift().end());
    share_.insert(share_.end(), rows.share.begin(), rows.share.end());
    answers.add(in, rows.share);
  }

  void factor() {
    system_.couple(algebra_);
    const std::size_t joints = joints_.system().size();
    for (std::size_t row = joints; row < system_.size(); ++row) system_.soften(algebra_, row, share_[row - joints]);
    system_.factor(algebra_, [&](const std::string& name, int op) { factor_[name] = op; });
  }

  void output(const std::string& array, const Values& velocities) {
    each_component(blocks_, [&](const Component& component, double, double) {
      algebra_.output(component.in(array), velocities.at(component.name));
    });
  }

  // Rates by which the joints take a share of C back in the step.
  std::vector<int> fed_back() {
    const int rate = algebra_.times(algebra_.value(blocks_.mechanism().fed_back), algebra_.function(Fn::inverse, {h_}));
    std::vector<int> rates = joints_.errors(algebra_);
    for (int& of_row : rates) of_row = algebra_.times(rate, of_row);
    return rates;
  }

  // The known impulses act.
  Values given() {
    Values velocities;
    each_component(blocks_, [&](const Component& component, double, double) {
      const int change = change_of(blocks_, algebra_, component, given_);
      velocities[component.name] = algebra_.sum({{algebra_.input(component.in("v")), change}, {1, 1}});
    });
    return velocities;
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
  const KickPlan& plan_;
  Algebra algebra_;
  RowSystem system_;  // of joints and effects
  int h_;
  std::map<std::string, int> factor_;
  std::vector<int> share_, drifts_;  // r and dC/dt, by row of the effects
  Forces given_;                     // known impulses
};

// Joints' answers to accelerations without them: J a = gamma.
class Accelerated {
 public:
  Accelerated(const RowBlocks& blocks, const JointRows& joints, Algebra& algebra)
      : answers(blocks, algebra, joints.system(),
                [&](const std::string& name) { return joints.factor(algebra, name); }) {
    std::vector<int> rest;  // -gamma
    for (std::size_t k = 0; k < joints.system().blocks().size(); ++k) {
      const RowBlock& joint = joints.system().blocks()[k];
      const Values in = joints.inputs(algebra, k);
      answers.add(in, {});
      const Values g = blocks.call(algebra, joint, "gamma", in);
      for (std::size_t r = 0; r < joint.rows->count(); ++r)
        rest.push_back(algebra.sum({{g.at(element("g", r)), faster(blocks, algebra, joint, in)}, {-1, -1}}));
    }
    end = answers.to(free_accelerations(blocks, algebra), [&](std::size_t row) { return rest[row]; });
    for (std::size_t row = 0; row < rest.size(); ++row) algebra.output(element("lambda", row), end.lambda[row]);
  }

  Answers answers;
  Answers::Answer end;

 private:
  static int faster(const RowBlocks& blocks, Algebra& algebra, const RowBlock& joint, const Values& in) {
    if (!joint.motor) return algebra.value(0);
    const int rate = blocks.speed_rate(algebra, joint);
    return joint.holds < 0 ? rate : algebra.times(in.at("holds"), rate);
  }
};

}  // namespace

// With the slopes k and d of the law, and rate and F at the start,
//   lambda = h (F + d (rate - rate') - h k rate') = h (F + d rate) - r^2 rate',   r^2 = h (d + h k)
EffectRows implicit_rows(Algebra& algebra, const LawWriter& law) {
  const int h = algebra.input("h");
  const std::vector<int> F = law.force();
  const LawWriter::Slopes slopes = law.slopes();
  EffectRows rows;
  for (std::size_t r = 0; r < F.size(); ++r) {
    const int force = algebra.sum({{F[r], algebra.times(slopes.d[r], law.rate()[r])}, {1, 1}});
    rows.given.push_back(algebra.times(h, force));
    const int both = algebra.sum({{slopes.d[r], algebra.times(h, slopes.k[r])}, {1, 1}});
    rows.share.push_back(algebra.function(Fn::sqrt, {algebra.times(h, both)}));
  }
  return rows;
}

Program accelerations_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants) {
  Algebra algebra(constants);
  const Accelerated accelerated(blocks, joints, algebra);
  each_component(blocks, [&](const Component& component, double, double) {
    algebra.output(component.in("a"), accelerated.end.velocities.at(component.name));
  });
  if (blocks.mechanism().bounded.empty()) return algebra.finish();
  BoundedSystem bounded(blocks, algebra);
  bounded.answer(
      accelerated.answers, joints.system().size(), [](std::size_t) { return true; }, BoundedSystem::Outputs::impulses);
  bounded.output_accelerations(accelerated.end.velocities);
  return algebra.finish();
}

Program kick_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants) {
  KickPlan plan;
  for (std::size_t e = 0; e < blocks.mechanism().effects.size(); ++e) plan.effects.push_back(e);
  plan.rows_of = [](Algebra& algebra, std::size_t, const LawWriter& law, const Values&) {
    return implicit_rows(algebra, law);
  };
  return finish_of(blocks, joints, constants, plan);
}

Program finish_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants, const KickPlan& plan) {
  return KickWriter(blocks, joints, constants, plan).write();
}

Program exert_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants) {
  Algebra algebra(constants);
  const Accelerated accelerated(blocks, joints, algebra);
  each_component(blocks, [&](const Component& component, double, double) {
    algebra.output(component.in("pull"), accelerated.end.by_joints.at(component.name));
  });
  if (blocks.mechanism().bounded.empty()) return algebra.finish();
  BoundedSystem bounded(blocks, algebra);
  bounded.answer(
      accelerated.answers, joints.system().size(),
      [&](std::size_t b) { return prescribes_rate(blocks, b) || blocks.mechanism().has_loads(); },
      BoundedSystem::Outputs::pulls);
  bounded.output_forces(accelerated.end.velocities, algebra.input("h"));
  return algebra.finish();
}

Program reach_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants) {
  Algebra algebra(constants);
  Answers answers(blocks, algebra, joints.system(),
                  [&](const std::string& name) { return joints.factor(algebra, name); });
  for (std::size_t k = 0; k < joints.system().blocks().size(); ++k) answers.add(joints.inputs(algebra, k), {});
  BoundedSystem bounded(blocks, algebra);
  bounded.answer(
      answers, joints.system().size(),
      [&](std::size_t b) { return blocks.mechanism().on_accelerations() || has_ends(blocks, b); },
      blocks.mechanism().has_loads() || blocks.mechanism().has_rates() || blocks.mechanism().keeps_momenta() ||
              !blocks.mechanism().bonds.empty()
          ? BoundedSystem::Outputs::impulses
          : BoundedSystem::Outputs::velocities);
  bounded.output_S({});
  return algebra.finish();
}

Program displace_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants,
                    const std::function<bool(std::size_t bounded)>& takes_part) {
  Algebra algebra(constants);
  Forces forces;
  std::size_t row = 0;
  for (std::size_t k = 0; k < joints.system().blocks().size(); ++k) {
    const RowBlock& block = joints.system().blocks()[k];
    std::vector<int> lambda;
    for (std::size_t r = 0; r < block.rows->count(); ++r) lambda.push_back(algebra.input(element("lambda", row++)));
    blocks.add_forces(algebra, block, joints.inputs(algebra, k), lambda, forces);
  }
  for (std::size_t b = 0; b < blocks.mechanism().bounded.size(); ++b) {
    if (!takes_part(b)) continue;
    const BoundWriter end(blocks, algebra, b);
    blocks.add_forces(algebra, end.block(), end.inputs(), {algebra.input(element("mu", b))}, forces);
  }
  each_component(blocks, [&](const Component& component, double, double) {
    algebra.output(component.in("d"), change_of(blocks, algebra, component, forces));
  });
  return algebra.finish();
}

Program past_of(const RowBlocks& blocks, Constants& constants) {
  Algebra algebra(constants);
  for (std::size_t b = 0; b < blocks.mechanism().bounded.size(); ++b) {
    const BoundWriter row(blocks, algebra, b);
    algebra.output(element("past", b), blocks.mechanism().on_accelerations() ? row.guard().off : row.past());
  }
  return algebra.finish_as_kernels();
}

Program nearest_of(const RowBlocks& blocks, Constants& constants) {
  Algebra algebra(constants);
  for (std::size_t b = 0; b < blocks.mechanism().bounded.size(); ++b) {
    const BoundWriter::End end = BoundWriter(blocks, algebra, b).nearest();
    algebra.output(element("off", b), end.off);
    algebra.output(element("side", b), end.side);
  }
  return algebra.finish_as_kernels();
}

Program drift_of_ends(const RowBlocks& blocks, Constants& constants) {
  Algebra algebra(constants);
  bool some = false;
  for (std::size_t b = 0; b < blocks.mechanism().bounded.size(); ++b) {
    const int moves = BoundWriter(blocks, algebra, b).drift_from_end();
    some |= !algebra.is_zero(moves);
    algebra.output(element("moves", b), moves);
  }
  return some ? algebra.finish_as_kernels() : Program{};
}

Program along_of(const RowBlocks& blocks, Constants& constants) {
  Algebra algebra(constants);
  const Values velocities = velocities_in(blocks, algebra, "v");
  for (std::size_t b = 0; b < blocks.mechanism().bounded.size(); ++b)
    algebra.output(element("along", b), BoundWriter(blocks, algebra, b).along(velocities));
  return algebra.finish();
}

}  // namespace cdot::compile
