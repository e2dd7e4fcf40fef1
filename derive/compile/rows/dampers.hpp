// Effects in a step of RATTLE or of the midpoint rule, as functions of the header. Their forces at rest act in the
// kicks, as a potential's do; the rest of a force, R(r) = F(r) - F(0) of its rate r, acts at both ends of the step,
// implicitly at the second. As the World does it: runtime/step/dampers.hpp.
#pragma once

#include "derive/compile/rows/kick.hpp"

namespace cdot::compile {

class Dampers {
 public:
  Dampers(const RowBlocks& blocks, Constants& constants);

  bool empty() const { return damped_.empty(); }
  // The number of the effect of each row whose rate at the end look() finds; empty: none.
  const std::vector<int>& effect_of() const { return effect_of_; }
  std::size_t triangle() const { return triangle_; }  // numbers of K of these

  // q, v, time, h -> next: v with what acts at the start.
  Program dampen() const;
  // q, v, time -> C, rate, K of those rows.
  Program notice() const;
  // C, rate, K, guess, time, h -> step, given, end, miss, size: each such effect alone at the end of a step, at guessed
  // rates.
  Program look() const;
  // Of one effect: its impulses at the start of a step, and how it acts at the end; nothing if it has no damper.
  std::vector<int> start(Algebra& algebra, std::size_t effect) const;
  EffectRows end(Algebra& algebra, std::size_t effect, const LawWriter& law, const Values& in) const;
  // q, v, time, J, h, given, end -> next, lambda, pull and B.
  Program finish(const JointRows& joints) const;

 private:
  struct Damped {
    std::size_t effect;
    bool is_spring;         // whose damper is linear
    std::size_t first = 0;  // of its rows, otherwise, and of its triangle of K
    std::size_t triangle = 0;
  };
  struct Here;  // an effect in an Algebra
  const Damped* find(std::size_t effect) const;
  std::vector<int> start_of(Algebra& algebra, const Damped& damped, const Here& there) const;
  bool calms(const Algebra& algebra, const LawWriter& law) const;
  void look_at(Algebra& algebra, const Damped& damped, std::size_t number) const;

  const RowBlocks& blocks_;
  Constants& constants_;
  const bool calms_;  // springs too stiff for the step are damped at its end, as the midpoint rule does
  std::vector<Damped> damped_;
  std::vector<int> effect_of_;
  std::size_t triangle_ = 0;
};

}  // namespace cdot::compile
