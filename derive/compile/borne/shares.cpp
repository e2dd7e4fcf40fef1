#include "derive/compile/borne/shares.hpp"

#include <fmt/format.h>

#include "derive/kernel/factor.hpp"

namespace cdot::compile {
namespace {

using derive::element;

int product(Algebra& algebra, const std::vector<int>& a, const std::vector<int>& b) {
  Summands terms;
  for (std::size_t i = 0; i < a.size(); ++i) terms.add(1, algebra.times(a[i], b[i]));
  return algebra.sum(terms);
}

// to - (to z) z / |z|^2
void take_part_along(Algebra& algebra, const std::vector<int>& z, int inverse_square, std::vector<int>& to) {
  const int along = algebra.times(product(algebra, to, z), inverse_square);
  for (std::size_t i = 0; i < z.size(); ++i) to[i] = algebra.sum({{to[i], algebra.times(along, z[i])}, {1, -1}});
}

// Impulses by places that move nothing: 1 at the redundant place d, and -K_II^-1 K_Id = -L_II^-T L_d at those before.
// All are 0 while its row takes part.
std::vector<int> motionless(Algebra& algebra, const JointRows& joints, std::size_t d) {
  const int takes_part = joints.factor(algebra, fmt::format("inv_D_{}", d)), zero = algebra.value(0);
  std::vector<int> z(joints.system().size(), zero);
  z[d] = algebra.function(Fn::select, {takes_part, zero, algebra.value(1)});
  for (std::size_t k = d; k-- > 0;) {
    Summands terms;
    for (std::size_t i = k + 1; i <= d; ++i)
      if (joints.system().has_L(i, k))
        terms.add(-1, algebra.times(joints.factor(algebra, fmt::format("L_{}_{}", i, k)), z[i]));
    z[k] = algebra.sum(terms);
  }
  return z;
}

}  // namespace

Program share_of(const JointRows& joints, Constants& constants) {
  Algebra algebra(constants);
  const RowSystem& system = joints.system();
  std::vector<int> lambda;  // by places
  for (const std::size_t row : system.order()) lambda.push_back(algebra.input(element("lambda", row)));
  std::vector<std::pair<std::vector<int>, int>> taken;  // orthogonal, with 1 / |z|^2
  for (std::size_t d = 0; d < system.size(); ++d) {
    if (!system.is_redundant(d)) continue;
    std::vector<int> z = motionless(algebra, joints, d);
    for (const auto& [other, inverse_square] : taken) take_part_along(algebra, other, inverse_square, z);
    taken.emplace_back(z, algebra.function(Fn::inverse, {product(algebra, z, z)}));
    take_part_along(algebra, z, taken.back().second, lambda);
  }
  for (std::size_t i = 0; i < lambda.size(); ++i) algebra.output(element("shared", system.order()[i]), lambda[i]);
  return algebra.finish();
}

}  // namespace cdot::compile
