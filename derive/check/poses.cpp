// Random poses, and random poses projected onto C = 0.
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

}  // namespace

std::vector<std::vector<double>> jacobian_at(const Block& block, const Sample& sample) {
  Gradients J;
  for (const std::vector<Expr>& row : columns_of(block.rows)) J.push_back(values_at(row, sample));
  return J;
}

Subject subject_of(const Derivation& derivation) {
  const Joint& joint = derivation.joint;
  Subject subject{joint, derivation.rows, derivation.coordinates, {}, {}};
  std::vector<Expr> expressions = expressions_of(subject.block);
  for (const Parameter& p : joint.parameters) {  // a frame as a whole
    expressions.insert(expressions.end(), p.axes.begin(), p.axes.end());
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
    Sample sample = random_sample(joint, expressions, seed);
    subject.anywhere.push_back(sample);
    if (C.empty() || move_to_zero(joint, C, sample, J)) subject.on_constraint.push_back(sample);
  }
  return subject;
}

}  // namespace cdot::derive
