// The functions of rows with bounds, and of bonds, as programs of all of them.
#include <fmt/format.h>
#include <numbers>

#include "derive/compile/rows/bounds.hpp"
#include "derive/kernel/factor.hpp"
#include "derive/kernel/plan.hpp"

namespace cdot::compile {

using derive::element;

bool prescribes_rate(const RowBlocks& blocks, std::size_t bounded) {
  const Effect& effect = blocks.mechanism().bounded[bounded];
  return effect.law == Effect::motor || (effect.law == Effect::bound && blocks.law(effect).bounded[effect.row].of_rate);
}

bool has_events(const RowBlocks& blocks, std::size_t bounded) {
  const Effect& effect = blocks.mechanism().bounded[bounded];
  return effect.law == Effect::bound && blocks.law(effect).bounded[effect.row].has_events();
}

bool waits(const RowBlocks& blocks, std::size_t bounded) {
  const Effect& effect = blocks.mechanism().bounded[bounded];
  return effect.law == Effect::bound && blocks.law(effect).bounded[effect.row].after;
}

Program distances_of(const RowBlocks& blocks, Constants& constants) {
  Algebra algebra(constants);
  for (std::size_t b = 0; b < blocks.mechanism().bounded.size(); ++b) {
    const Effect& effect = blocks.mechanism().bounded[b];
    const BoundWriter row(blocks, algebra, b);
    const bool of_spec = effect.law == Effect::bound;
    const std::optional<Program> none;
    algebra.output(element("after", b), row.distance(of_spec ? blocks.law(effect).bounded[effect.row].after : none));
    algebra.output(element("until", b), row.distance(of_spec ? blocks.law(effect).bounded[effect.row].until : none));
  }
  return algebra.finish_as_kernels();
}

Program strain_of(const RowBlocks& blocks, Constants& constants) {
  Algebra algebra(constants);
  for (std::size_t k = 0; k < blocks.mechanism().bonds.size(); ++k) {
    const Bond& bond = blocks.mechanism().bonds[k];
    const SpecPrograms& spec = blocks.bond(bond);
    const std::string& owner = blocks.block_of(bond).name;
    Values in;
    for (std::size_t p = 0; p < spec.parameters.size(); ++p)
      in[spec.parameters[p]] =
          algebra.value(bond.numbers[p], fmt::format("{}_{}_{}", owner, bond.type, spec.parameters[p]));
    in["pi"] = algebra.value(std::numbers::pi);
    in["time"] = algebra.input("time");
    in[derive::bounded_load] = algebra.input(element("load", static_cast<std::size_t>(bond.holds)));
    const Values out = algebra.inlined(
        *spec.bounded.front().breaks, [&](const std::string& text) { return in.at(text); }, "bond");
    algebra.output(element("from", k), out.at("D"));
  }
  return algebra.finish();
}

Program guard_of(const RowBlocks& blocks, Constants& constants) {
  Algebra algebra(constants);
  for (std::size_t b = 0; b < blocks.mechanism().bounded.size(); ++b) {
    const BoundWriter row(blocks, algebra, b);
    const BoundWriter::Guard guard = row.guard();
    const int missing = algebra.sum({{guard.rate, row.rate()}, {1, -1}});
    algebra.output("B." + element("off", b), guard.off);
    algebra.output("B." + element("missing", b), missing);
    algebra.output("B." + element("low", b), guard.low);
    algebra.output("B." + element("high", b), guard.high);
    if (blocks.mechanism().has_loads()) row.output_by_load();
  }
  return algebra.finish_as_kernels();
}

Program resolve_of(const RowBlocks& blocks, Constants& constants) {
  Algebra algebra(constants);
  for (std::size_t b = 0; b < blocks.mechanism().bounded.size(); ++b) {
    const BoundWriter::Resolution resolution = BoundWriter(blocks, algebra, b).resolution();
    algebra.output(element("of_value", b), resolution.value);
    algebra.output(element("of_rate", b), resolution.rate);
    algebra.output(element("of_force", b), resolution.force);
    algebra.output(element("of_hop", b), resolution.hop);
  }
  return algebra.finish();
}

namespace {

// The resultant force of a joint's rows, by the linear columns of its last body that moves.
int force_of(const RowBlocks& blocks, const JointRows& joints, Algebra& algebra, int joint) {
  const Mechanism& all = blocks.mechanism();
  const RowSystem& system = joints.system();
  std::size_t k = 0;
  while (system.blocks()[k].name != blocks.joint(static_cast<std::size_t>(joint)).name) ++k;
  const RowBlock& block = system.blocks()[k];
  std::size_t last = block.bodies->size() - 1;
  while (last > 0 && !all.bodies[static_cast<std::size_t>((*block.bodies)[last])].moves) --last;
  const Values J = blocks.call(algebra, block, "dense", joints.inputs(algebra, k));
  Summands squares;
  for (std::size_t c = 0; c < all.linear(); ++c) {
    Summands force;
    for (std::size_t r = 0; r < block.rows->count(); ++r)
      force.add(1, algebra.times(J.at(element(element("D", r), all.columns() * last + c)),
                                 algebra.input(element("lambda", system.first_row(k) + r))));
    squares.add(1, algebra.product({algebra.sum(force)}, {2}));
  }
  return algebra.function(Fn::sqrt, {algebra.sum(squares)});
}

}  // namespace

Program carry_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants) {
  Algebra algebra(constants);
  for (std::size_t b = 0; b < blocks.mechanism().bounded.size(); ++b) {
    const Effect& effect = blocks.mechanism().bounded[b];
    int load = algebra.value(0);
    if (effect.loaded_by_row >= 0) {
      const std::string force = element("force", static_cast<std::size_t>(effect.loaded_by_row));
      load = algebra.function(Fn::abs, {algebra.input(force)});
    }
    if (effect.loaded_by_joint >= 0) load = force_of(blocks, joints, algebra, effect.loaded_by_joint);
    algebra.output(element("load", b), load);
  }
  return algebra.finish();
}

bool has_ends(const RowBlocks& blocks, std::size_t bounded) {
  return !prescribes_rate(blocks, bounded) && !blocks.mechanism().bounded[bounded].acts_by_force();
}

bool drives_one_way(const RowBlocks& blocks, std::size_t bounded, Constants& constants) {
  if (!prescribes_rate(blocks, bounded)) return false;
  Algebra algebra(constants);
  const BoundWriter::Kick kick = BoundWriter(blocks, algebra, bounded).kick(algebra.value(1));
  return algebra.is_zero(kick.low) || algebra.is_zero(kick.high);
}

bool is_late_end(const RowBlocks& blocks, std::size_t bounded, Constants& constants) {
  if (!has_ends(blocks, bounded) || !waits(blocks, bounded)) return false;
  Algebra algebra(constants);
  return !BoundWriter(blocks, algebra, bounded).holds();
}

}  // namespace cdot::compile
