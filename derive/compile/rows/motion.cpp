#include "derive/compile/rows/motion.hpp"

#include "derive/compile/rows/components.hpp"
#include "derive/compile/rows/laws.hpp"
#include "derive/kernel/factor.hpp"

namespace cdot::compile {

namespace {

int gyroscopic_rate(const RowBlocks& blocks, Algebra& algebra, const Component& component) {
  const Mechanism& all = blocks.mechanism();
  if (component.column < all.linear() || !all.bodies[static_cast<std::size_t>(component.body)].inertia_turns)
    return algebra.value(0);
  return blocks.gyroscopic_rates(algebra, component.body)[component.column - all.linear()];
}

}  // namespace

Values free_accelerations(const RowBlocks& blocks, Algebra& algebra, bool at_rest) {
  Forces forces;
  for (std::size_t e = 0; e < blocks.mechanism().effects.size(); ++e) {
    const RowBlock& block = blocks.effect(e);
    const Values in = blocks.inputs_with_jacobian(algebra, block);
    const LawWriter law(blocks, algebra, blocks.mechanism().effects[e], block, in);
    blocks.add_forces(algebra, block, in, at_rest ? law.at_rest().force() : law.force(), forces);
  }
  blocks.add_torques(algebra, forces);
  Values accelerations;
  each_component(blocks, [&](const Component& component, double a, double drag) {
    const int slowed = algebra.times(algebra.value(drag), algebra.input(component.in("v")));
    const int change = change_of(blocks, algebra, component, forces);
    accelerations[component.name] = algebra.sum(
        {{algebra.value(a), slowed, change, at_rest ? algebra.value(0) : gyroscopic_rate(blocks, algebra, component)},
         {1, -1, 1, 1}});
  });
  return accelerations;
}

Program fall_of(const RowBlocks& blocks, Constants& constants) {
  Algebra algebra(constants);
  const Values accelerations = free_accelerations(blocks, algebra, blocks.mechanism().method == Method::rattle);
  each_component(blocks, [&](const Component& component, double, double) {
    algebra.output(component.in("a"), accelerations.at(component.name));
  });
  return algebra.finish();
}

Program angles_of(const RowBlocks& blocks, Constants& constants) {
  Algebra algebra(constants);
  const auto output = [&](int number, const Unwound& angle) {
    algebra.output(derive::element("angle", static_cast<std::size_t>(number)), angle.angle);
    algebra.output(derive::element("turns", static_cast<std::size_t>(number)), angle.turns);
  };
  const auto count_turns = [&](const RowBlock& block) {
    for (const CountedTurns& turns : *block.turns)
      output(turns.angle, blocks.counted(algebra, block, turns, blocks.inputs(algebra, block)));
  };
  const auto count = [&](const Effect& effect, const RowBlock& block) {
    count_turns(block);
    if (effect.angle < 0) return;
    const int C = blocks.call(algebra, block, "position", blocks.inputs(algebra, block)).at("C[0]");
    output(effect.angle, unwound(algebra, effect.angle, C));
  };
  const Mechanism& all = blocks.mechanism();
  for (std::size_t j = 0; j < all.joints.size(); ++j) count_turns(blocks.joint(j));
  for (std::size_t e = 0; e < all.effects.size(); ++e) count(all.effects[e], blocks.effect(e));
  for (std::size_t b = 0; b < all.bounded.size(); ++b) count(all.bounded[b], blocks.bounded(b));
  return algebra.finish();
}

Program potential_of(const RowBlocks& blocks, Constants& constants) {
  Algebra algebra(constants);
  Summands terms;
  const auto add = [&](const Effect& effect, const RowBlock& block) {
    const Values in = blocks.inputs_with_jacobian(algebra, block);
    const int energy = LawWriter(blocks, algebra, effect, block, in).energy();
    terms.add(1, block.holds < 0 ? energy : algebra.times(in.at("holds"), energy));
  };
  const Mechanism& all = blocks.mechanism();
  for (std::size_t e = 0; e < all.effects.size(); ++e) add(all.effects[e], blocks.effect(e));
  for (std::size_t b = 0; b < all.bounded.size(); ++b)
    if (all.bounded[b].acts_by_force()) add(all.bounded[b], blocks.bounded(b));
  algebra.output("E", algebra.sum(terms));
  return algebra.finish();
}

}  // namespace cdot::compile
