#include "derive/compile/rows/motion.hpp"

#include <fmt/format.h>

#include "derive/compile/rows/laws.hpp"
#include "derive/kernel/factor.hpp"

namespace cdot::compile {
namespace {

// Of a body's velocity: x, y or w.
struct Component {
  int body;
  std::size_t column;
  std::string name;  // "rod.x"
  std::string in(const std::string& array) const {
    return fmt::format("{}[{}]{}", array, name.substr(0, name.find('.')), name.substr(name.find('.')));
  }
};

// f(component, acceleration by gravity and constant forces, drag)
template <class F>
void each_component(const RowBlocks& blocks, F f) {
  const Mechanism& all = blocks.mechanism();
  for (int b = 0; b < static_cast<int>(all.bodies.size()); ++b) {
    const Body& body = all.bodies[static_cast<std::size_t>(b)];
    const double a[] = {all.gravity_x + body.ax, all.gravity_y + body.ay, body.aw};
    const double drag[] = {body.linear_drag, body.linear_drag, body.angular_drag};
    for (std::size_t c = 0; body.moves && c < 3; ++c)
      f(Component{b, c, fmt::format("{}.{}", blocks.body_name(b), "xyw"[c])}, a[c], drag[c]);
  }
}

// Inputs of the rows of an effect, with their J.
Values inputs_of_effect(const RowBlocks& blocks, Algebra& algebra, std::size_t effect) {
  const RowBlock& rows = blocks.effect(effect);
  Values in = blocks.inputs(algebra, rows);
  for (const auto& [name, op] : blocks.call(algebra, rows, "jacobian", in))
    if (name.starts_with("J.")) in[name] = op;
  return in;
}

int change_of(const RowBlocks& blocks, Algebra& algebra, const Component& component, const Forces& forces) {
  const auto force = forces.find({component.body, component.column});
  if (force == forces.end()) return algebra.value(0);
  return algebra.times(blocks.inverse_mass(algebra, component.body, component.column), algebra.sum(force->second));
}

// A step of h that is implicit as far as the slopes k and d of the laws say. With rate and F at the start,
//   lambda = h (F + d (rate - rate') - h k rate') = h (F + d rate) + r mu,   r^2 = h (d + h k),
// the rows r J v' + mu = 0 give mu together with the impulses of the joints: 1 is added to their diagonals.
class KickWriter {
 public:
  KickWriter(const RowBlocks& blocks, const JointRows& joints, Constants& constants)
      : blocks_(blocks), joints_(joints), algebra_(constants), system_(blocks, all_blocks(blocks, joints)) {
    h_ = algebra_.input("h");
    first_effect_ = joints.system().blocks().size();
  }

  Program write() {
    for (std::size_t k = 0; k < first_effect_; ++k) add(joints_.inputs(algebra_, k));
    for (std::size_t e = 0; e < blocks_.mechanism().effects.size(); ++e) add_effect(e);
    system_.couple(algebra_);
    for (std::size_t row = joints_.system().size(); row < system_.size(); ++row)
      system_.soften(algebra_, row, share_[row - joints_.system().size()]);
    std::map<std::string, int> factor;
    system_.factor(algebra_, [&](const std::string& name, int op) { factor[name] = op; });
    push();
    std::vector<int> lambda =
        system_.solve(algebra_, right_sides(), [&](const std::string& name) { return factor.at(name); });
    output(lambda);
    return algebra_.finish();
  }

 private:
  static std::vector<RowBlock> all_blocks(const RowBlocks& blocks, const JointRows& joints) {
    std::vector<RowBlock> all = joints.system().blocks();
    for (std::size_t e = 0; e < blocks.mechanism().effects.size(); ++e) all.push_back(blocks.effect(e));
    return all;
  }

  void add(Values in) {
    inputs_.push_back(std::move(in));
    system_.add_block(algebra_, inputs_.size() - 1, inputs_.back());
  }

  void add_effect(std::size_t e) {
    add(inputs_of_effect(blocks_, algebra_, e));
    const LawWriter law(blocks_, algebra_, e, inputs_.back());
    const std::vector<int> F = law.force();
    const LawWriter::Slopes slopes = law.slopes();
    std::vector<int> impulses;
    for (std::size_t r = 0; r < F.size(); ++r) {
      const int force = algebra_.sum({{F[r], algebra_.times(slopes.d[r], law.rate()[r])}, {1, 1}});
      impulses.push_back(algebra_.times(h_, force));
      const int both = algebra_.sum({{slopes.d[r], algebra_.times(h_, slopes.k[r])}, {1, 1}});
      share_.push_back(algebra_.function(Fn::sqrt, {algebra_.times(h_, both)}));
    }
    blocks_.add_forces(algebra_, blocks_.effect(e), inputs_.back(), impulses, given_);
  }

  // Gravity, constant forces, drag and the known impulses act. Drag is implicit: v / (1 + h d).
  void push() {
    each_component(blocks_, [&](const Component& component, double a, double drag) {
      const int slowed = algebra_.sum({{algebra_.value(1), algebra_.times(h_, algebra_.value(drag))}, {1, 1}});
      const int v = algebra_.times(algebra_.input(component.in("v")), algebra_.function(Fn::inverse, {slowed}));
      const int change = change_of(blocks_, algebra_, component, given_);
      velocities_[component.name] = algebra_.sum({{v, algebra_.times(h_, algebra_.value(a)), change}, {1, 1, 1}});
    });
  }

  // b = -(J v + dC/dt) of the joints, -r (J v + dC/dt) of the effects.
  std::vector<int> right_sides() {
    std::vector<int> b = joints_.rates(algebra_, velocities_);
    for (int& of_row : b) of_row = algebra_.sum({{of_row}, {-1}});
    std::size_t row = 0;
    for (std::size_t e = 0; e < blocks_.mechanism().effects.size(); ++e) {
      Values in = inputs_[first_effect_ + e];
      blocks_.replace_velocities(in, blocks_.effect(e), velocities_);
      const LawWriter law(blocks_, algebra_, e, in);
      for (const int rate : law.rate()) b.push_back(algebra_.sum({{algebra_.times(share_[row++], rate)}, {-1}}));
    }
    return b;
  }

  void output(std::vector<int>& lambda) {
    const std::size_t joints = joints_.system().size();
    for (std::size_t row = 0; row < joints; ++row) algebra_.output(derive::element("lambda", row), lambda[row]);
    for (std::size_t row = joints; row < lambda.size(); ++row)
      lambda[row] = algebra_.times(share_[row - joints], lambda[row]);
    Forces forces;
    for (std::size_t k = 0; k < inputs_.size(); ++k) {
      const auto first = lambda.begin() + static_cast<std::ptrdiff_t>(system_.first_row(k));
      const RowBlock& block = system_.blocks()[k];
      blocks_.add_forces(algebra_, block, inputs_[k], {first, first + static_cast<std::ptrdiff_t>(block.rows->count())},
                         forces);
    }
    each_component(blocks_, [&](const Component& component, double, double) {
      const int change = change_of(blocks_, algebra_, component, forces);
      algebra_.output(component.in("next"), algebra_.sum({{velocities_.at(component.name), change}, {1, 1}}));
    });
  }

  const RowBlocks& blocks_;
  const JointRows& joints_;
  Algebra algebra_;
  RowSystem system_;          // of joints and effects
  std::size_t first_effect_;  // its block
  std::vector<Values> inputs_;
  int h_;
  std::vector<int> share_;  // r, by row of the effects
  Forces given_;            // impulses h (F + d rate)
  Values velocities_;       // after these, by the names of components
};

}  // namespace

Program fall_of(const RowBlocks& blocks, Constants& constants) {
  Algebra algebra(constants);
  Forces forces;
  for (std::size_t e = 0; e < blocks.mechanism().effects.size(); ++e) {
    const Values in = inputs_of_effect(blocks, algebra, e);
    blocks.add_forces(algebra, blocks.effect(e), in, LawWriter(blocks, algebra, e, in).force(), forces);
  }
  each_component(blocks, [&](const Component& component, double a, double drag) {
    const int slowed = algebra.times(algebra.value(drag), algebra.input(component.in("v")));
    const int change = change_of(blocks, algebra, component, forces);
    algebra.output(component.in("a"), algebra.sum({{algebra.value(a), slowed, change}, {1, -1, 1}}));
  });
  return algebra.finish();
}

Program potential_of(const RowBlocks& blocks, Constants& constants) {
  Algebra algebra(constants);
  Summands terms;
  for (std::size_t e = 0; e < blocks.mechanism().effects.size(); ++e) {
    const Values in = inputs_of_effect(blocks, algebra, e);
    terms.add(1, LawWriter(blocks, algebra, e, in).energy());
  }
  algebra.output("E", algebra.sum(terms));
  return algebra.finish();
}

Program kick_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants) {
  return KickWriter(blocks, joints, constants).write();
}

}  // namespace cdot::compile
