// The rows of a mechanism as blocks: a kernel with its bodies and parameters in this scene, to be inlined.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "derive/compile/rows/algebra.hpp"
#include "derive/compile/rows/spec_programs.hpp"
#include "derive/compile/scene/mechanism.hpp"

namespace cdot::compile {

using Values = std::map<std::string, int>;  // operations by the names of a kernel's inputs or outputs

// `names` are those of bodies, joints and effects in C++; "" for bodies that do not move.
struct Names {
  std::vector<std::string> bodies, joints, effects, bounded;
};

struct RowBlock {
  std::string name;   // before the names of what it computes
  std::string owner;  // before those of its parameters
  const SpecPrograms* spec = nullptr;
  const RowPrograms* rows = nullptr;
  const std::vector<int>* bodies = nullptr;
  const std::vector<double>* parameters = nullptr;
};

// Forces by body and column: x, y, angle.
using Forces = std::map<std::pair<int, std::size_t>, Summands>;

// Of a parameter of a kernel, "p.pa_x" or "phi", in the header.
std::string constant_name(const RowBlock& block, const std::string& parameter);
// Of a number of an effect's law.
std::string number_name(const RowBlock& block, const std::string& parameter);

class RowBlocks {
 public:
  RowBlocks(const Mechanism& mechanism, const Names& names, const derive::SpecsFolder& specs);

  const Mechanism& mechanism() const { return mechanism_; }
  const RowBlock& joint(std::size_t j) const { return joints_[j]; }
  const RowBlock& effect(std::size_t e) const { return effects_[e]; }
  const RowBlock& bounded(std::size_t b) const { return bounded_[b]; }
  // The spec whose law the effect has.
  const SpecPrograms& law(const Effect& effect) const { return types_.at(effect.law_type); }
  const std::string& body_name(int index) const { return names_.bodies[static_cast<std::size_t>(index)]; }

  // Inputs of the kernel, in this scene: places and velocities of its bodies, masses, parameters.
  Values inputs(Algebra& algebra, const RowBlock& block) const;
  // The same with its J.
  Values inputs_with_jacobian(Algebra& algebra, const RowBlock& block) const;
  // Puts these in place of v in the inputs; by the names of components, "rod.x"; empty: leaves v.
  void replace_velocities(Values& in, const RowBlock& block, const Values& velocities) const;
  // One of its functions.
  Values call(Algebra& algebra, const RowBlock& block, const std::string& function, const Values& in) const;
  // The column is 0, 1 for x and y, 2 for the angle.
  int inverse_mass(Algebra& algebra, int body, std::size_t column) const;
  // forces += J^T lambda, with J among `in`.
  void add_forces(Algebra& algebra, const RowBlock& block, Values in, const std::vector<int>& lambda,
                  Forces& forces) const;

 private:
  std::string owner_of(const std::string& name, const Effect& effect) const;
  RowBlock block_of(const std::string& name, const Effect& effect) const;
  void add_body(Algebra& algebra, Values& in, const std::string& L, int index) const;

  const Mechanism& mechanism_;
  const Names& names_;
  std::map<std::string, SpecPrograms> types_;
  std::vector<RowBlock> joints_, effects_, bounded_;
};

}  // namespace cdot::compile
