// Random poses, and poses projected onto C = 0: from random ones, and from starts with the spec's defaults, which lie
// on the branch that the author means.
#include <cmath>

#include "derive/check/parts.hpp"
#include "derive/numbers/newton.hpp"

namespace cdot::derive {
namespace {

constexpr int poses = 12;

std::vector<Expr> expressions_of(const Block& block) {
  std::vector<Expr> all;
  for (const ScalarRow& row : block.rows) {
    all.insert(all.end(), {row.C, row.Cdot, row.gamma});
    for (const Expr entry : columns_of(row.J)) all.push_back(entry);
  }
  for (const auto& K : block.K) all.insert(all.end(), K.begin(), K.end());
  return all;
}

// Components in the frame of a body, or of the world.
Triple<double> in_frame(const Triple<double>& u, const Sample& sample, int body, int dimension) {
  if (body < 0) return u;
  const Sample::Body& b = sample.bodies[static_cast<std::size_t>(body)];
  const EulerParameters<double> about_z{std::cos(b.theta / 2), 0, 0, std::sin(b.theta / 2)};
  const auto axes = axes_of(dimension == 2 ? about_z : b.e);
  return {inner_product(axes[0], u), inner_product(axes[1], u), inner_product(axes[2], u)};
}

// The rotation with these axes: row i of the matrix 4 e e^T, taken where 4 e_i^2 is largest.
EulerParameters<double> parameters_of(const std::array<Triple<double>, 3>& A) {
  const double xx = A[0][0], yy = A[1][1], zz = A[2][2];
  const double wx = A[1][2] - A[2][1], wy = A[2][0] - A[0][2], wz = A[0][1] - A[1][0];
  const double xy = A[0][1] + A[1][0], xz = A[0][2] + A[2][0], yz = A[1][2] + A[2][1];
  const std::array<EulerParameters<double>, 4> columns = {{{1 + xx + yy + zz, wx, wy, wz},
                                                           {wx, 1 + xx - yy - zz, xy, xz},
                                                           {wy, xy, 1 - xx + yy - zz, yz},
                                                           {wz, xz, yz, 1 - xx - yy + zz}}};
  std::size_t largest = 0;
  for (std::size_t i = 1; i < 4; ++i)
    if (columns[i][i] > columns[largest][largest]) largest = i;
  EulerParameters<double> e = columns[largest];
  const double length = std::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3]);
  for (double& component : e) component /= length;
  return e;
}

// Gives the parameters of a sample their defaults at its pose.
void put_defaults(const Joint& joint, Sample& sample) {
  for (const Parameter& p : joint.parameters) {
    if (!p.default_value) continue;
    Numbers numbers(sample);
    const auto local = [&](Expr e) { return in_frame(numbers.vector(e), sample, p.body, joint.dimension); };
    if (p.kind == ParameterKind::scalar) {
      if (const auto at = sample.scalars.find(p.symbol->symbol); at != sample.scalars.end())
        at->second = numbers.scalar(p.default_value);
    } else if (!p.axes.empty()) {
      const auto at = sample.triads.find(joint.pool->axis_of(p.axes[0]).triad);
      if (at == sample.triads.end()) continue;
      at->second = parameters_of({local(p.default_axes[0]), local(p.default_axes[1]), local(p.default_axes[2])});
    } else if (const auto at = sample.local.find(p.symbol->symbol); at != sample.local.end()) {
      const bool arm = p.kind == ParameterKind::point && p.body >= 0;
      at->second = local(arm ? p.default_value - body_symbols(joint, p.body).x : p.default_value);
    }
  }
}

// Bodies side by side, turned a little, so that a picture shows all of them.
Sample side_by_side(const Joint& joint, const std::vector<Expr>& expressions) {
  Sample sample = random_sample(joint, expressions, 1);
  for (std::size_t b = 0; b < sample.bodies.size(); ++b) {
    const double k = static_cast<double>(b), side = b % 2 == 0 ? 1 : -1;
    Sample::Body& body = sample.bodies[b];
    body.x = {2 * k, 0.5 * (1 - side), joint.dimension == 2 ? 0 : 0.4 * k};
    body.theta = 0.3 * side;
    body.e = turned_about(2, 0.3 * side, turned_about(b % 2, 0.2, {1, 0, 0, 0}));
  }
  put_defaults(joint, sample);
  return sample;
}

}  // namespace

std::vector<std::vector<double>> jacobian_at(const Block& block, const Sample& sample) {
  Gradients J;
  for (const std::vector<Expr>& row : columns_of(block.rows)) J.push_back(values_at(row, sample));
  return J;
}

Sample completed(Sample sample, Sample other) {
  sample.scalars.merge(other.scalars);
  sample.local.merge(other.local);
  sample.triads.merge(other.triads);
  sample.leaves = other.leaves;
  return sample;
}

Subject subject_of(const Derivation& derivation) {
  const Joint& joint = derivation.joint;
  Subject subject{joint, derivation.rows, derivation.coordinates, {}, {}, 0, {}};
  std::vector<Expr> expressions = expressions_of(subject.block);
  for (const Parameter& p : joint.parameters) {
    expressions.insert(expressions.end(), p.axes.begin(), p.axes.end());  // a frame as a whole
    if (p.default_value) expressions.push_back(p.default_value);
    expressions.insert(expressions.end(), p.default_axes.begin(), p.default_axes.end());
  }
  for (const Block& coordinate : subject.coordinates) {
    const std::vector<Expr> more = expressions_of(coordinate);
    expressions.insert(expressions.end(), more.begin(), more.end());
  }
  std::vector<Expr> C;
  std::vector<std::vector<Expr>> J;
  for (const ScalarRow& row : subject.block.rows) {
    if (row.kind == RowKind::velocity) continue;  // no pose can satisfy it
    C.push_back(row.C);
    J.push_back(columns_of(row.J));
  }
  for (std::uint64_t seed = 1; seed <= poses; ++seed) {
    subject.anywhere.push_back(random_sample(joint, expressions, seed));
    Sample sample = subject.anywhere.back();
    if (seed <= poses / 2) put_defaults(joint, sample);
    if (!C.empty() && !move_to_zero(joint, C, sample, J)) continue;
    subject.on_constraint.push_back(sample);
    if (seed <= poses / 2) ++subject.by_defaults;
  }
  for (const Parameter& p : joint.parameters) expressions.push_back(p.value);
  for (const Let& let : joint.lets) expressions.push_back(let.value);
  subject.usual = side_by_side(joint, expressions);
  if (!C.empty() && !move_to_zero(joint, C, subject.usual, J) && !subject.on_constraint.empty())
    subject.usual = completed(subject.on_constraint[0], subject.usual);
  return subject;
}

}  // namespace cdot::derive
