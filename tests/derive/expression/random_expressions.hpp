// Random expressions with their values: built by the builders under test and computed in plain numbers.
#pragma once

#include <vector>

#include "derive/numbers/numeric.hpp"
#include "derive/program/program.hpp"

namespace cdot::derive {

struct KnownScalar {
  Expr e;
  double value;
};
struct KnownVector {
  Expr e;
  Triple<double> value;
};

// Grows from leaves by random builders, in the space of the pool. Keeps expressions that are neither huge nor near a
// singularity.
class RandomExpressions {
 public:
  RandomExpressions(Pool& pool, std::uint64_t seed);
  void grow(int steps);

  const std::vector<KnownScalar>& scalars() const { return scalars_; }
  const std::vector<KnownVector>& vectors() const { return vectors_; }
  const Values& leaves() const { return leaves_; }

 private:
  const KnownScalar& scalar() { return scalars_[pick(scalars_.size())]; }
  const KnownVector& vector() { return vectors_[pick(vectors_.size())]; }
  std::size_t pick(std::size_t size) { return static_cast<std::size_t>(random_.bits() % size); }
  void keep(KnownScalar s);
  void keep(KnownVector v);
  void grow_scalar();
  void add_leaf(const char* name, Role role, int body, bool of_unit_length);
  void grow_vector();
  void grow_turned(const KnownVector& u, const KnownVector& v);
  void grow_function();

  Pool& pool_;
  Random random_;
  Values leaves_;
  std::vector<KnownScalar> scalars_;
  std::vector<KnownVector> vectors_;
};

// Evaluates a program operation by operation, without code of printers or passes.
std::vector<double> run(const Program& program, const Values& inputs);

}  // namespace cdot::derive
