// The forces that effects and soft joints bear which may break, by their own rows, as functions of the header.
#pragma once

#include <functional>
#include <vector>

#include "derive/compile/rows/dampers.hpp"

namespace cdot::compile {

class Borne {
 public:
  explicit Borne(const RowBlocks& blocks);

  std::size_t size() const { return size_; }  // rows of all
  // By number of a joint that may break, and the size: the first row of each. Joints with rows of K have none.
  const std::vector<std::size_t>& first() const { return first_; }

  // forces(algebra, number of the effect, its law, inputs): by row. -> borne
  using Forces = std::function<std::vector<int>(Algebra&, std::size_t effect, const LawWriter&, const Values& in)>;
  Program write(Constants& constants, const Forces& forces) const;

  // q, v, time -> borne: forces at these rates.
  Program at_rates(Constants& constants) const;
  // q, v, time, h, next -> borne: mean forces in an Euler step of h from v to next.
  Program in_kick(Constants& constants) const;
  // q, v, time, h -> borne: what the effects did at the start of a step of h; by RATTLE half of the forces at rest,
  // too.
  Program at_start(Constants& constants, const Dampers& dampers) const;
  // q, v, time, h, given, end -> borne: the same at its end, with its velocities.
  Program at_end(Constants& constants, const Dampers& dampers) const;

 private:
  std::vector<int> after(Algebra& algebra, std::size_t effect, const LawWriter& law, const Values& in,
                         const EffectRows& rows, const char* velocities) const;
  void add_half_at_rest(Algebra& algebra, const LawWriter& law, std::vector<int>& forces) const;

  const RowBlocks& blocks_;
  std::vector<std::size_t> effects_, first_;
  std::size_t size_ = 0;
};

}  // namespace cdot::compile
