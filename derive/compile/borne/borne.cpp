#include "derive/compile/borne/borne.hpp"

#include "derive/compile/rows/components.hpp"
#include "derive/kernel/factor.hpp"

namespace cdot::compile {

using derive::element;

namespace {

// Impulses in a step of h to forces.
std::vector<int> per_step(Algebra& algebra, std::vector<int> impulses) {
  const int rate = algebra.function(Fn::inverse, {algebra.input("h")});
  for (int& of_row : impulses) of_row = algebra.times(rate, of_row);
  return impulses;
}

}  // namespace

Borne::Borne(const RowBlocks& blocks) : blocks_(blocks) {
  int last = -1;
  for (const Bond& bond : blocks.mechanism().bonds) {
    if (bond.holds == last) continue;
    last = bond.holds;
    first_.push_back(size_);
    if (bond.effect < 0) continue;
    effects_.push_back(static_cast<std::size_t>(bond.effect));
    size_ += blocks.effect(effects_.back()).rows->count();
  }
  first_.push_back(size_);
}

Program Borne::write(Constants& constants, const Forces& forces) const {
  Algebra algebra(constants);
  std::size_t row = 0;
  for (const std::size_t e : effects_) {
    const RowBlock& block = blocks_.effect(e);
    const Values in = blocks_.inputs_with_jacobian(algebra, block);
    const LawWriter law(blocks_, algebra, blocks_.mechanism().effects[e], block, in);
    for (const int force : forces(algebra, e, law, in))
      algebra.output(element("borne", row++), algebra.function(Fn::select, {in.at("holds"), force, algebra.value(0)}));
  }
  return algebra.finish();
}

Program Borne::at_rates(Constants& constants) const {
  return write(constants, [](Algebra&, std::size_t, const LawWriter& law, const Values&) { return law.force(); });
}

Program Borne::in_kick(Constants& constants) const {
  return write(constants, [&](Algebra& algebra, std::size_t e, const LawWriter& law, const Values& in) {
    return per_step(algebra, after(algebra, e, law, in, implicit_rows(algebra, law), "next"));
  });
}

Program Borne::at_start(Constants& constants, const Dampers& dampers) const {
  return write(constants, [&](Algebra& algebra, std::size_t e, const LawWriter& law, const Values&) {
    std::vector<int> forces = per_step(algebra, dampers.start(algebra, e));
    add_half_at_rest(algebra, law, forces);
    return forces;
  });
}

Program Borne::at_end(Constants& constants, const Dampers& dampers) const {
  return write(constants, [&](Algebra& algebra, std::size_t e, const LawWriter& law, const Values& in) {
    const EffectRows rows = dampers.end(algebra, e, law, in);
    std::vector<int> forces(law.C().size(), algebra.value(0));
    if (!rows.given.empty()) forces = per_step(algebra, after(algebra, e, law, in, rows, "v"));
    add_half_at_rest(algebra, law, forces);
    return forces;
  });
}

// given - share^2 (J v' + dC/dt)
std::vector<int> Borne::after(Algebra& algebra, std::size_t effect, const LawWriter& law, const Values& in,
                              const EffectRows& rows, const char* velocities) const {
  const RowBlock& block = blocks_.effect(effect);
  Values then = in;
  blocks_.replace_velocities(then, block, velocities_in(blocks_, algebra, velocities));
  const Values Jv = blocks_.call(algebra, block, "velocity", then);
  std::vector<int> impulses;
  for (std::size_t r = 0; r < rows.given.size(); ++r) {
    const int rate = algebra.sum({{Jv.at(element("Jv", r)), law.drift()[r]}, {1, 1}});
    const int taken = algebra.product({rows.share[r], rate}, {2, 1});
    impulses.push_back(algebra.sum({{rows.given[r], taken}, {1, -1}}));
  }
  return impulses;
}

// By RATTLE forces at rest act in its two kicks.
void Borne::add_half_at_rest(Algebra& algebra, const LawWriter& law, std::vector<int>& forces) const {
  if (blocks_.mechanism().method != Method::rattle) return;
  const std::vector<int> rest = law.at_rest().force();
  for (std::size_t r = 0; r < forces.size(); ++r)
    forces[r] = algebra.sum({{forces[r], algebra.times(algebra.value(0.5), rest[r])}, {1, 1}});
}

}  // namespace cdot::compile
