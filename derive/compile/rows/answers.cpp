#include "derive/compile/rows/answers.hpp"

#include "derive/compile/rows/components.hpp"
#include "derive/kernel/factor.hpp"

namespace cdot::compile {

using derive::element;
using derive::triangle_element;

Answers::Answer Answers::to(const Values& u, const std::function<int(std::size_t row)>& drift) const {
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
  Answer answer{system_.solve(algebra_, b, factor_), {}, {}};
  add_changes(answer, u);
  return answer;
}

void Answers::add_changes(Answer& answer, const Values& u) const {
  Forces forces, of_joints;
  for (std::size_t k = 0; k < inputs_.size(); ++k) {
    std::vector<int> of_block;
    for (std::size_t r = 0; r < system_.blocks()[k].rows->count(); ++r) {
      int& lambda = answer.lambda[system_.first_row(k) + r];
      lambda = shared(k, r, lambda);
      of_block.push_back(lambda);
    }
    blocks_.add_forces(algebra_, system_.blocks()[k], inputs_[k], of_block, forces);
    if (share_[k].empty()) of_joints = forces;
  }
  each_component(blocks_, [&](const Component& component, double, double) {
    const int change = change_of(blocks_, algebra_, component, forces);
    answer.by_joints[component.name] = change_of(blocks_, algebra_, component, of_joints);
    answer.velocities[component.name] = algebra_.sum({{u.at(component.name), change}, {1, 1}});
  });
}

BoundedSystem::BoundedSystem(const RowBlocks& blocks, Algebra& algebra) : blocks_(blocks), algebra_(algebra) {
  for (std::size_t b = 0; b < blocks.mechanism().bounded.size(); ++b) rows_.emplace_back(blocks, algebra, b);
}

void BoundedSystem::answer(const Answers& answers, std::size_t joint_rows,
                           const std::function<bool(std::size_t)>& takes_part, Outputs outputs) {
  for (std::size_t b = 0; b < rows_.size(); ++b) {
    Values unit;
    Forces forces;
    const bool takes = takes_part(b);
    if (takes) blocks_.add_forces(algebra_, rows_[b].block(), rows_[b].inputs(), {algebra_.value(1)}, forces);
    each_component(blocks_,
                   [&](const Component& c, double, double) { unit[c.name] = change_of(blocks_, algebra_, c, forces); });
    const Answers::Answer answer = answers.to(unit);
    each_component(blocks_, [&](const Component& c, double, double) {
      algebra_.output(c.in("B." + element("g", b)), answer.velocities.at(c.name));
    });
    for (std::size_t row = 0; outputs != Outputs::velocities && row < joint_rows; ++row)
      algebra_.output(element("B." + element("l", b), row), answer.lambda[row]);
    if (outputs == Outputs::pulls) output_pulls(b, unit, answer.by_joints);
    for (std::size_t a = 0; a < rows_.size(); ++a)
      if (a >= b) S_[{a, b}] = takes_part(a) ? rows_[a].along(answer.velocities) : algebra_.value(0);
    K_.push_back(takes ? rows_[b].along(unit) : algebra_.value(0));
  }
}

void BoundedSystem::output_S(const std::vector<int>& softness) {
  for (std::size_t a = 0; a < rows_.size(); ++a) {
    algebra_.output("B." + element("K", a), K_[a]);
    for (std::size_t b = 0; b <= a; ++b) {
      const bool softened = a == b && !softness.empty();
      const int entry = softened ? algebra_.sum({{S_.at({a, b}), softness[a]}, {1, 1}}) : S_.at({a, b});
      algebra_.output("B." + triangle_element("S", a, b), entry);
    }
  }
}

void BoundedSystem::output_bounds(const Values& next, int h, bool halved) {
  std::vector<int> softness;
  for (std::size_t b = 0; b < rows_.size(); ++b) {
    const BoundWriter::Kick kick = rows_[b].kick(h);
    softness.push_back(kick.softness);
    output_row(b, algebra_.sum({{rows_[b].along(next), rows_[b].drift(), kick.bias}, {-1, -1, -1}}),
               halved && prescribes_rate(blocks_, b) ? half_of(kick) : kick);
    if (blocks_.mechanism().has_loads()) rows_[b].output_by_load();
  }
  output_S(softness);
}

void BoundedSystem::output_changes(const Values& w, const Values& v, int h) {
  const int half = algebra_.value(0.5);
  for (std::size_t b = 0; b < rows_.size(); ++b) {
    BoundWriter::Kick kick = rows_[b].in_middle(h);
    Summands missed{{rows_[b].along(w), kick.bias}, {1, 1}};
    if (prescribes_rate(blocks_, b)) missed.add(1, rows_[b].along(v)), missed.add(1, rows_[b].drift());
    const int mu = algebra_.input(element("mu", b));
    for (int* bound : {&kick.low, &kick.high}) *bound = algebra_.times(half, algebra_.sum({{*bound, mu}, {1, -1}}));
    output_row(b, algebra_.sum({{algebra_.sum(missed)}, {-1}}), kick);
    if (blocks_.mechanism().has_loads()) rows_[b].output_by_load();
  }
  output_S({});
}

void BoundedSystem::add_half_impulses(Forces& forces) const {
  for (std::size_t b = 0; b < rows_.size(); ++b) {
    const int half = algebra_.times(algebra_.value(0.5), algebra_.input(element("mu", b)));
    blocks_.add_forces(algebra_, rows_[b].block(), rows_[b].inputs(), {half}, forces);
  }
}

void BoundedSystem::output_forces(const Values& a, int h) {
  const int per_half = algebra_.function(Fn::inverse, {algebra_.times(algebra_.value(0.5), h)});
  const int zero = algebra_.value(0);
  for (std::size_t b = 0; b < rows_.size(); ++b) {
    if (blocks_.mechanism().has_loads()) rows_[b].output_by_load();
    if (!prescribes_rate(blocks_, b)) {
      const bool may_carry = blocks_.mechanism().has_loads();
      output_row(b, may_carry ? algebra_.sum({{rows_[b].gamma(), rows_[b].along(a)}, {1, -1}}) : zero,
                 may_carry ? rows_[b].while_it_is_met() : BoundWriter::Kick{zero, zero, zero, zero});
      continue;
    }
    const BoundWriter::Kick forces = rows_[b].kick(algebra_.value(1));
    const int missed = algebra_.sum({{rows_[b].rate(), forces.bias}, {1, 1}});
    const int asked = algebra_.sum({{rows_[b].gamma(), rows_[b].rate_change()}, {1, 1}});
    output_row(b, algebra_.sum({{asked, rows_[b].along(a), algebra_.times(per_half, missed)}, {1, -1, -1}}), forces);
  }
  output_S({});
}

void BoundedSystem::output_accelerations(const Values& a) {
  const int zero = algebra_.value(0);
  for (std::size_t b = 0; b < rows_.size(); ++b) {
    const BoundWriter::Guard guard = rows_[b].guard();
    const int asked = algebra_.sum({{rows_[b].gamma(), guard.acceleration}, {1, 1}});
    output_row(b, algebra_.sum({{asked, rows_[b].along(a)}, {1, -1}}), {zero, zero, guard.low, guard.high});
    if (blocks_.mechanism().has_loads()) rows_[b].output_by_load();
  }
  output_S({});
}

void BoundedSystem::output_row(std::size_t b, int c, const BoundWriter::Kick& kick) {
  algebra_.output("B." + element("c", b), c);
  algebra_.output("B." + element("low", b), kick.low);
  algebra_.output("B." + element("high", b), kick.high);
}

void BoundedSystem::output_pulls(std::size_t b, const Values& unit, const Values& by_joints) {
  each_component(blocks_, [&](const Component& c, double, double) {
    algebra_.output(c.in("B." + element("p", b)), by_joints.at(c.name));
    algebra_.output(c.in("B." + element("u", b)), prescribes_rate(blocks_, b) ? unit.at(c.name) : algebra_.value(0));
  });
}

// A force that may have either sign now and then has one of them is whole.
BoundWriter::Kick BoundedSystem::half_of(BoundWriter::Kick kick) {
  const bool one_way = algebra_.is_zero(kick.low) || algebra_.is_zero(kick.high);
  const int both = algebra_.function(Fn::abs, {algebra_.times(kick.low, kick.high)}), half = algebra_.value(0.5);
  const int share = one_way ? half : algebra_.function(Fn::select, {both, half, algebra_.value(1)});
  kick.low = algebra_.times(share, kick.low), kick.high = algebra_.times(share, kick.high);
  return kick;
}

}  // namespace cdot::compile
