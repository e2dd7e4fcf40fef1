// The assumptions of a derivation and its limits: zero lengths, divisions, roots, angles that wrap.
#include <set>
#include <utility>

#include "derive/explain/lecture.hpp"
#include "derive/expression/functions.hpp"

namespace cdot::derive {
namespace {

class Limits {
 public:
  explicit Limits(const Lecture& lecture) : notation_(lecture.notation) {}

  void find(Expr root) {
    for (const Expr e : topological(std::span(&root, 1))) {
      if (!seen_.insert(&*e).second) continue;
      if (e->kind == Kind::unit) of_direction(e);
      if (e->kind == Kind::product) of_product(e);
      if (e->kind == Kind::function) of_function(e);
    }
  }

  Step limits{};

 private:
  void of_direction(Expr e) {
    const Formula u = notation_.of(e->args[0]), n = notation_.of(e);
    const bool plane = e->pool->dimension() == 2;
    const std::string rest = std::string(" has no direction where {} = 0; the kernel takes ") +
                             (plane ? "(1, 0) there." : "(1, 0, 0) there.");
    if (n.shape == Shape::leaf) limits.list("{}" + rest, {n, shaped(Shape::norm, u)});
    else limits.list("{}" + rest, {u, shaped(Shape::norm, u)});
  }

  void of_product(Expr e) {
    for (std::size_t i = 0; i < e->args.size(); ++i) {
      if (e->exponents[i] > 0 || !divided_by_.insert(&*e->args[i]).second) continue;
      const Formula below = notation_.of(e->args[i]);
      limits.list("A division by {}: where it is 0 the kernel takes 1/0 as 0, so that term vanishes.", {below});
    }
  }

  void of_function(Expr e) {
    if (e->fn == Fn::atan2) {
      const bool unsigned_angle = e->args[0]->kind == Kind::norm;
      return limits.list(unsigned_angle ? "{} is an angle in [0, pi]: it has a corner at both ends."
                                        : "{} is an angle in (-pi, pi]: it jumps where the turn is complete.",
                         {notation_.of(e)});
    }
    const std::string_view limit = function_of(e->fn).limit;
    if (!limit.empty()) limits.list(std::string(limit), {notation_.of(e->args[0])});
  }

  const Notation& notation_;
  std::set<const Node*> seen_, divided_by_;  // looked up only
};

void find_all(const Part& part, Limits& limits) {
  for (const ScalarRow& row : part.block.rows) {
    for (const Expr e : {row.C, row.Cdot, row.gamma}) limits.find(e);
    for (const JacobianEntry& entry : row.J) {
      limits.find(entry.v);
      limits.find(entry.w);
    }
  }
}

void assume(const Joint& joint, Step& step) {
  for (const Parameter& p : joint.parameters) {
    if (!p.axes.empty()) {
      step.list("{}, {} and {} have length 1 and stand on each other, a right-handed triad.",
                {leaf(p.axes[0]), leaf(p.axes[1]), leaf(p.axes[2])});
    } else if (p.kind == ParameterKind::unit || p.kind == ParameterKind::frame) {
      step.list("{} has length 1.", {leaf(p.symbol)});
    } else if (!p.range.empty()) {
      step.list(p.from ? "{} is " + p.range.substr(5) + " or more." : "{} lies " + p.range + ".", {leaf(p.symbol)});
    }
  }
  for (const Row& row : joint.rows) {
    if (row.kind == RowKind::inequality) {
      step.list("Row `" + row.name + "` acts only where C reaches 0.");
    }
  }
  if (joint.on_any_coordinate()) return;
  step.list("A body that cannot move has inverse mass and inverse inertia 0; its terms of K vanish.");
  step.list("If K = 0 (no body can move), the guarded factorisation of the kernel gives no impulse.");
  if (joint.uses_world) {
    step.list("A part is fixed in the world, which takes any impulse: the joint does not conserve momentum.");
  }
}

}  // namespace

void state_limits(Lecture& lecture, const std::vector<const Part*>& parts) {
  Limits limits(lecture);
  for (const Part* part : parts) find_all(*part, limits);
  Step& step = lecture.section("Assumptions and limits");
  assume(lecture.joint, step);
  for (Item& item : limits.limits.items) step.items.push_back(std::move(item));
}

}  // namespace cdot::derive
