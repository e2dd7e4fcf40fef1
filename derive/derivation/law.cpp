// The law of an effect: its force from its energy, and the slopes of the force that implicit methods need.
#include <map>

#include "derive/derivation/derivation.hpp"
#include "derive/expression/components.hpp"

namespace cdot::derive {
namespace {

// Vector leaves as sums of scalar leaves along the world's axes: what slopes are taken by.
class Leaves {
 public:
  explicit Leaves(const Joint& joint) : axes_(world_axes(*joint.pool)) {
    for (const LawInput& input : joint.law->inputs) {
      const std::vector<Expr> rates = scalars(input.rate);
      const std::vector<Expr> values = input.value ? scalars(input.value) : std::vector<Expr>(rates.size());
      value.insert(value.end(), values.begin(), values.end());
      rate.insert(rate.end(), rates.begin(), rates.end());
    }
  }

  Expr by_scalars(Expr e) const { return substitute(e, sums_); }

  std::vector<Expr> value, rate;  // by row; an input without a value has empty ones

 private:
  std::vector<Expr> scalars(Expr leaf) {
    if (!leaf->vector) return {leaf};
    Components components;
    const std::vector<Expr> parts = components.of_vector(leaf);
    Expr sum = zero_vector(*leaf->pool);
    for (std::size_t k = 0; k < parts.size(); ++k) sum = sum + parts[k] * axes_[k];
    sums_.emplace(&*leaf, sum);
    return parts;
  }

  std::vector<Expr> axes_;
  std::map<const Node*, Expr> sums_;
};

Expr slope(Expr e, Expr by, const Joint& joint) {
  return by ? time_derivative(e, joint, {.only = by}) : joint.pool->number(0);
}

DerivedLaw law_of(const Joint& joint) {
  Pool& pool = *joint.pool;
  const Leaves leaves(joint);
  DerivedLaw law{leaves.value, leaves.rate, {}, {}, {}, {}, {}};
  const Expr energy = joint.law->energy ? leaves.by_scalars(joint.law->energy) : pool.number(0);
  std::vector<Expr> forces;
  for (const LawInput& input : joint.law->inputs) {
    const Expr none = input.rate->vector ? zero_vector(pool) : pool.number(0);
    for (const Expr part : components_of(input.force ? leaves.by_scalars(input.force) : none)) {
      const Expr stored = slope(energy, law.value[forces.size()], joint);
      law.unstored.push_back(part);
      forces.push_back(part - stored);
    }
  }
  for (const Expr force : forces) {
    std::vector<Expr> by_value, by_rate;
    for (std::size_t j = 0; j < forces.size(); ++j) {
      by_value.push_back(-slope(force, law.value[j], joint));
      by_rate.push_back(-slope(force, law.rate[j], joint));
    }
    law.stiffness.push_back(std::move(by_value));
    law.damping.push_back(std::move(by_rate));
  }
  law.force = std::move(forces);
  if (joint.law->energy) law.energy = energy;
  return law;
}

}  // namespace

void derive_law(Derivation& derivation) {
  const Joint& joint = derivation.joint;
  if (!joint.law->inputs.empty()) derivation.law = law_of(joint);
  for (const BoundedRow& row : joint.law->bounded) {
    DerivedBound bound{row.rate, row.rate ? time_derivative(row.rate, joint) : Expr(), row.lower, row.upper, {}, {}};
    if (row.load) {
      const std::map<const Node*, Expr> none = {{&*row.load, joint.pool->number(0)}};
      bound.by_lower = slope(row.lower, row.load, joint), bound.by_upper = slope(row.upper, row.load, joint);
      bound.lower = substitute(row.lower, none), bound.upper = substitute(row.upper, none);
    }
    derivation.bounded.push_back(bound);
  }
}

}  // namespace cdot::derive
