#include "derive/compile/rows/dampers.hpp"

#include <algorithm>

#include "derive/compile/rows/components.hpp"
#include "derive/kernel/factor.hpp"

namespace cdot::compile {

using derive::element;
using derive::triangle_element;

// K of one block, with both triangles.
class Masses {
 public:
  Masses(Algebra& algebra, std::function<int(std::size_t row, std::size_t column)> lower)
      : algebra_(algebra), lower_(std::move(lower)) {}
  int K(std::size_t r, std::size_t c) const { return lower_(std::max(r, c), std::min(r, c)); }
  int own(std::size_t r) const { return K(r, r); }
  // The sum over rows of x^2 / K, by the energies of the rows.
  int squares(const std::vector<int>& x) const {
    Summands terms;
    for (std::size_t r = 0; r < x.size(); ++r) {
      const int mass =
          algebra_.function(Fn::select, {own(r), algebra_.function(Fn::inverse, {own(r)}), algebra_.value(1)});
      terms.add(1, algebra_.product({x[r], mass}, {2, 1}));
    }
    return algebra_.sum(terms);
  }
  int size(const std::vector<int>& x) const { return algebra_.function(Fn::sqrt, {squares(x)}); }

 private:
  Algebra& algebra_;
  std::function<int(std::size_t, std::size_t)> lower_;
};

namespace {

// An effect of a spec at its rates.
struct AtRates {
  std::vector<int> R, d;  // R(r), and -dR/dr as bounded
  std::vector<int> t;     // the part of h in which R acts at the start
};

// At the start R acts for h/2, or for less where it would reverse the motion: for 1/(d K) of the slope d, or for
// |r|/|R| by the energies of the rows if that is less. A force that saturates would reverse the motion if its slope
// alone set the time.
AtRates at_rates(Algebra& algebra, const LawWriter& law, const Masses& masses) {
  AtRates at;
  const std::vector<int> F = law.force(), rest = law.at_rest().force(), &r = law.rate();
  Summands push, motion;
  for (std::size_t i = 0; i < F.size(); ++i) {
    at.R.push_back(algebra.sum({{F[i], rest[i]}, {1, -1}}));
    push.add(1, algebra.product({at.R[i], masses.own(i)}, {2, 1}));
    motion.add(1, algebra.product({r[i], algebra.function(Fn::inverse, {masses.own(i)})}, {2, 1}));
  }
  at.d = law.slopes_within_limits().d;
  const int ratio = algebra.times(algebra.sum(push), algebra.function(Fn::inverse, {algebra.sum(motion)}));
  const int secant = algebra.function(Fn::sqrt, {ratio}), half = algebra.times(algebra.value(0.5), algebra.input("h"));
  for (std::size_t i = 0; i < F.size(); ++i) {
    const int rate = law.most(algebra.times(at.d[i], masses.own(i)), secant);  // by which the effect slows its row
    const int reverses = algebra.sum({{algebra.times(half, rate), algebra.value(1)}, {1, -1}});
    at.t.push_back(algebra.function(Fn::select, {reverses, algebra.function(Fn::inverse, {rate}), half}));
  }
  return at;
}

// The impulse per rate of a linear damper at the start: h d min(1/2, 1/(h d K)).
int linear_start(Algebra& algebra, const LawWriter& law, int d, int K) {
  const int half = algebra.product({algebra.value(0.5), algebra.input("h"), d}, {1, 1, 1});
  return law.least(half, algebra.function(Fn::inverse, {K}));
}

// The impulse per rate that ends oscillations too fast for the step: h^2 k max(0, 1 - 1/u), u = h^2 k K.
int calming(Algebra& algebra, const LawWriter& law, int k, int K) {
  const int stiff = algebra.product({algebra.input("h"), k}, {2, 1}), mass = algebra.function(Fn::inverse, {K});
  return law.most(algebra.sum({{stiff, mass}, {1, -1}}), algebra.value(0));
}

}  // namespace

// The law refers to the inputs.
struct Dampers::Here {
  Here(const RowBlocks& blocks, Algebra& algebra, std::size_t effect)
      : block(blocks.effect(effect)),
        in(blocks.inputs_with_jacobian(algebra, block)),
        law(blocks, algebra, blocks.mechanism().effects[effect], block, in),
        K(blocks.call(algebra, block, "effective_mass", in)),
        masses(algebra, [&](std::size_t r, std::size_t c) { return K.at(triangle_element("K", r, c)); }) {}
  Here(const Here&) = delete;

  const RowBlock& block;
  const Values in;
  const LawWriter law;
  const Values K;
  const Masses masses;
};

// True if the effect acts at the end because it is stiff.
bool Dampers::calms(const Algebra& algebra, const LawWriter& law) const {
  return calms_ && !std::ranges::all_of(law.slopes().k, [&](int k) { return algebra.is_zero(k); });
}

Dampers::Dampers(const RowBlocks& blocks, Constants& constants)
    : blocks_(blocks), constants_(constants), calms_(blocks.mechanism().method == Method::implicit) {
  Algebra algebra(constants);
  int count = 0;
  for (std::size_t e = 0; e < blocks.mechanism().effects.size(); ++e) {
    const bool is_spring = blocks.mechanism().effects[e].law == Effect::spring;
    const Damped damped{e, is_spring, effect_of_.size(), triangle_};
    const Here there(blocks, algebra, e);
    if (!there.law.reads_rates() && !calms(algebra, there.law)) continue;
    damped_.push_back(damped);
    if (is_spring) continue;
    const std::size_t rows = there.law.C().size();
    effect_of_.insert(effect_of_.end(), rows, count++);
    for (std::size_t row = damped.first; row < effect_of_.size(); ++row)
      for (const char* array : {"end", "given"}) constants.at_start[element(array, row)] = 0;
    triangle_ += rows * (rows + 1) / 2;
  }
}

const Dampers::Damped* Dampers::find(std::size_t effect) const {
  const auto found = std::ranges::find(damped_, effect, &Damped::effect);
  return found == damped_.end() ? nullptr : &*found;
}

std::vector<int> Dampers::start_of(Algebra& algebra, const Damped& damped, const Here& there) const {
  const std::vector<int>& rate = there.law.rate();
  std::vector<int> impulses;
  const LawWriter::Slopes slopes = damped.is_spring ? there.law.slopes() : LawWriter::Slopes{};
  const AtRates at = damped.is_spring ? AtRates{} : at_rates(algebra, there.law, there.masses);
  for (std::size_t r = 0; r < rate.size(); ++r) {
    if (!damped.is_spring) impulses.push_back(algebra.times(at.t[r], at.R[r]));
    else {
      const int start = linear_start(algebra, there.law, slopes.d[r], there.masses.own(r));
      impulses.push_back(algebra.sum({{algebra.times(start, rate[r])}, {-1}}));
    }
  }
  return impulses;
}

std::vector<int> Dampers::start(Algebra& algebra, std::size_t effect) const {
  const Here there(blocks_, algebra, effect);
  const Damped* const damped = find(effect);
  return damped ? start_of(algebra, *damped, there) : std::vector<int>(there.law.C().size(), algebra.value(0));
}

Program Dampers::dampen() const {
  Algebra algebra(constants_);
  Forces forces;
  for (const Damped& damped : damped_) {
    const Here there(blocks_, algebra, damped.effect);
    blocks_.add_forces(algebra, there.block, there.in, start_of(algebra, damped, there), forces);
  }
  each_component(blocks_, [&](const Component& component, double, double) {
    const int change = change_of(blocks_, algebra, component, forces);
    algebra.output(component.in("next"), algebra.sum({{algebra.input(component.in("v")), change}, {1, 1}}));
  });
  return algebra.finish();
}

Program Dampers::notice() const {
  Algebra algebra(constants_);
  for (const Damped& damped : damped_) {
    if (damped.is_spring) continue;
    const Here there(blocks_, algebra, damped.effect);
    const std::size_t rows = there.law.C().size();
    for (std::size_t r = 0, k = damped.triangle; r < rows; ++r) {
      algebra.output(element("C", damped.first + r), there.law.C()[r]);
      algebra.output(element("rate", damped.first + r), there.law.rate()[r]);
      for (std::size_t c = 0; c <= r; ++c) algebra.output(element("K", k++), there.masses.K(r, c));
    }
  }
  return algebra.finish();
}

Program Dampers::look() const {
  Algebra algebra(constants_);
  std::size_t number = 0;
  for (const Damped& damped : damped_)
    if (!damped.is_spring) look_at(algebra, damped, number++);
  return algebra.finish();
}

// At the end, the rates p = r + K t R(p) of the effect alone, by Newton with the diagonal of K and of the slopes; t is
// the rest of h. With R linear about p the impulse is t (R(p) + d (p - r')) = given - end r'.
void Dampers::look_at(Algebra& algebra, const Damped& damped, std::size_t number) const {
  const RowBlock& block = blocks_.effect(damped.effect);
  const std::size_t rows = block.rows->count();
  std::vector<int> C, r, p;
  for (std::size_t i = damped.first; i < damped.first + rows; ++i) {
    C.push_back(algebra.input(element("C", i))), r.push_back(algebra.input(element("rate", i)));
    p.push_back(algebra.input(element("guess", i)));
  }
  const Masses masses(algebra, [&](std::size_t row, std::size_t column) {
    return algebra.input(element("K", damped.triangle + row * (row + 1) / 2 + column));
  });
  const Here there(blocks_, algebra, damped.effect);  // at any pose: C and K are inputs
  const LawWriter law = there.law.at(C, p);
  const AtRates at = at_rates(algebra, law, masses);
  const std::vector<int> k = calms_ ? law.slopes_within_limits().k : std::vector<int>{};
  std::vector<int> impulse, ends, g;
  for (std::size_t i = 0; i < rows; ++i) {
    const int rest = algebra.sum({{algebra.input("h"), at.t[i]}, {1, -1}});
    impulse.push_back(algebra.times(rest, at.R[i]));
    const int end = algebra.times(rest, at.d[i]);
    ends.push_back(calms_ ? algebra.sum({{end, calming(algebra, law, k[i], masses.own(i))}, {1, 1}}) : end);
    algebra.output(element("end", damped.first + i), ends[i]);
    algebra.output(element("given", damped.first + i), algebra.sum({{impulse[i], algebra.times(end, p[i])}, {1, 1}}));
  }
  for (std::size_t i = 0; i < rows; ++i) {
    Summands terms{{p[i], r[i]}, {1, -1}};
    for (std::size_t k = 0; k < rows; ++k) terms.add(-1, algebra.times(masses.K(i, k), impulse[k]));
    g.push_back(algebra.sum(terms));
    const int slope = algebra.sum({{algebra.value(1), algebra.times(ends[i], masses.own(i))}, {1, 1}});
    algebra.output(element("step", damped.first + i),
                   algebra.sum({{algebra.times(g[i], algebra.function(Fn::inverse, {slope}))}, {-1}}));
  }
  algebra.output(element("miss", number), masses.size(g));
  algebra.output(element("size", number), algebra.sum({{masses.size(r), masses.size(p)}, {1, 1}}));
}

EffectRows Dampers::end(Algebra& algebra, std::size_t effect, const LawWriter& law, const Values& in) const {
  EffectRows rows;
  if (!find(effect)) return rows;
  const Damped& damped = *find(effect);
  const std::size_t count = law.C().size();
  const Values K =
      damped.is_spring ? blocks_.call(algebra, blocks_.effect(damped.effect), "effective_mass", in) : Values{};
  const LawWriter::Slopes slopes = damped.is_spring ? law.slopes() : LawWriter::Slopes{};
  for (std::size_t r = 0; r < count; ++r) {
    int end = -1;
    if (damped.is_spring) {
      const int own = K.at(triangle_element("K", r, r)), start = linear_start(algebra, law, slopes.d[r], own);
      end = algebra.sum({{algebra.times(algebra.input("h"), slopes.d[r]), start}, {1, -1}});
      if (calms_) end = algebra.sum({{end, calming(algebra, law, slopes.k[r], own)}, {1, 1}});
    } else {
      end = algebra.input(element("end", damped.first + r));
    }
    rows.given.push_back(damped.is_spring ? algebra.value(0) : algebra.input(element("given", damped.first + r)));
    rows.share.push_back(algebra.function(Fn::sqrt, {end}));
  }
  return rows;
}

Program Dampers::finish(const JointRows& joints) const {
  KickPlan plan;
  for (const Damped& damped : damped_) plan.effects.push_back(damped.effect);
  plan.rows_of = [&](Algebra& algebra, std::size_t effect, const LawWriter& law, const Values& in) {
    return end(algebra, effect, law, in);
  };
  return finish_of(blocks_, joints, constants_, plan);
}

}  // namespace cdot::compile
