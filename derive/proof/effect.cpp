// The laws of an effect's force: the slope of its energy, its own slopes, and whether forces are opposite.
#include <algorithm>

#include "derive/expression/symbols.hpp"
#include "derive/proof/laws.hpp"

namespace cdot::derive {
namespace {

class EffectProver {
 public:
  EffectProver(const Derivation& derivation)
      : joint_(derivation.joint),
        block_(derivation.rows),
        bounded_(derivation.bounded),
        law_(derivation.law.value_or(DerivedLaw{})),
        names_(joint_, Algebra::Route::names),
        of_law_(joint_, Algebra::Route::names) {
    if (joint_.on_any_coordinate()) free_.name = joint_.law->free->name;
    for (std::size_t b = 0; b < joint_.bodies.size(); ++b) names_.coordinates(static_cast<int>(b));
  }

  // F = U - dE/dC, with U the part that has no energy.
  void force(Law& law) {
    for (std::size_t i = 0; i < law_.force.size(); ++i) {
      const ex unstored = of_law_.of(law_.unstored[i]);
      require_zero(law, of_law_, of_law_.of(law_.force[i]) - unstored + slope(law_.energy, law_.value[i]), row(i),
                   ": F is not -dE/dC and what the spec adds");
    }
  }

  // k = -dF/dC, d = -dF/d(rate)
  void slopes(Law& law) {
    const auto require = [&](Expr stated, std::size_t i, Expr by, std::size_t j, const char* letter) {
      require_zero(law, of_law_, of_law_.of(stated) + slope(law_.force[i], by), row(i),
                   ", column " + row(j).name + ": " + letter + " is not the slope of F");
    };
    for (std::size_t i = 0; i < law_.force.size(); ++i) {
      for (std::size_t j = 0; j < law_.force.size(); ++j) {
        require(law_.stiffness[i][j], i, law_.value[j], j, "k");
        require(law_.damping[i][j], i, law_.rate[j], j, "d");
      }
    }
  }

  // Bounds are those without a load and what each unit of it adds.
  void loads(Law& law) {
    for (std::size_t i = 0; i < bounded_.size(); ++i) {
      const BoundedRow& row = joint_.law->bounded[i];
      if (!row.load) continue;
      const auto differs = [&](Expr whole, Expr without, Expr by) {
        return of_law_.is_zero(of_law_.of(whole) - of_law_.of(without) - of_law_.of(row.load) * of_law_.of(by)) >
               Algebra::Zero::shown;
      };
      if (!differs(row.lower, bounded_[i].lower, bounded_[i].by_lower) &&
          !differs(row.upper, bounded_[i].upper, bounded_[i].by_upper))
        continue;
      law.verdict = Verdict::fails;
      law.text = row.name + ": a bound is not a multiple of the load and a part without it";
      law.fix = "write it as mu*load(...), with mu free of the load";
      law.parts = {row.where};
    }
  }

  // Of a prescribed rate.
  void accelerations(Law& law) {
    const Expr time = time_symbol(*joint_.pool);
    for (std::size_t i = 0; i < bounded_.size(); ++i)
      if (bounded_[i].rate && of_law_.is_zero(of_law_.of(bounded_[i].acceleration) - slope(bounded_[i].rate, time)) >
                                  Algebra::Zero::shown) {
        law.verdict = Verdict::fails;
        law.text = joint_.law->bounded[i].name + ": the acceleration is not the derivative of the rate by time";
      }
  }

  // The sum over rows of F times what the row feels of a common motion. F is written in C and its rate, so these take
  // the place of its leaves.
  void opposite(Law& law) {
    law.verdict = Verdict::does_not_apply;
    if (joint_.bodies.size() < 2 || joint_.uses_world) return;
    std::map<const Node*, Expr> leaves;
    for (std::size_t i = 0; i < block_.rows.size(); ++i) {
      if (law_.value[i]) leaves.emplace(&*law_.value[i], block_.rows[i].C);
      leaves.emplace(&*law_.rate[i], block_.rows[i].Cdot);
    }
    bool pushes = false;
    Felt total{zero_vector(*joint_.pool), zero_spin(*joint_.pool)};
    for (std::size_t i = 0; i < block_.rows.size(); ++i) {
      const Felt felt = felt_by(block_.rows[i].J, joint_);
      const Expr F = substitute(law_.force[i], leaves);
      pushes = pushes || (!is_zero(law_.force[i]) &&
                          std::ranges::any_of(block_.rows[i].J, [](const JacobianEntry& e) { return !is_zero(e.v); }));
      total = {total.translation + F * felt.translation, total.rotation + F * felt.rotation};
    }
    bool shown = false;
    const auto vanishes = [&](Expr sum) {
      for (const Expr component : components_of(sum)) {
        const Algebra::Zero zero = names_.is_zero(names_.of(component));
        shown |= zero == Algebra::Zero::shown;
        if (zero > Algebra::Zero::shown) return false;
      }
      return true;
    };
    if (!vanishes(total.translation)) law.text = "momentum is not conserved: the forces do not add up to 0";
    else if (!vanishes(total.rotation))
      law.text = pushes ? "angular momentum is not conserved: the forces are opposite, but not on one line"
                        : "angular momentum is not conserved: the torques do not add up to 0";
    else law.verdict = shown ? Verdict::shown : Verdict::holds;
  }

 private:
  const ScalarRow& row(std::size_t i) const { return joint_.on_any_coordinate() ? free_ : block_.rows[i]; }

  ex slope(Expr e, Expr by) { return e && by ? of_law_.derivative(of_law_.of(e), of_law_.of(by)) : ex(0); }

  const Joint& joint_;
  const Block& block_;
  const std::vector<DerivedBound>& bounded_;
  const DerivedLaw law_;
  Algebra names_, of_law_;
  ScalarRow free_{};  // the coordinate of any joint
};

}  // namespace

std::vector<Law> laws_of_effect(const Derivation& derivation) {
  EffectProver prover(derivation);
  const auto slopes = [&](Law& law) {
    prover.slopes(law);
    prover.accelerations(law);
    prover.loads(law);
  };
  if (!derivation.law) return {judged(LawId::slopes, slopes)};
  return {judged(LawId::force, [&](Law& law) { prover.force(law); }), judged(LawId::slopes, slopes),
          judged(LawId::opposite, [&](Law& law) { prover.opposite(law); })};
}

}  // namespace cdot::derive
