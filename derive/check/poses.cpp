// Poses to look at: random ones, and random ones brought to C = 0.
#include <algorithm>
#include <cmath>

#include "derive/check/parts.hpp"
#include "derive/numbers/newton.hpp"

namespace cdot::derive {
namespace {

constexpr int poses = 12;
constexpr int most_steps = 100;
constexpr double reached = 1e-11, converged = 1e-14;  // |C|

// The rows that a pose can satisfy.
std::vector<std::size_t> position_rows(const Block& block) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < block.rows.size(); ++i) {
    if (block.rows[i].kind != RowKind::velocity) rows.push_back(i);
  }
  return rows;
}

Gradients jacobian(Numbers& numbers, const Block& block, const std::vector<std::size_t>& rows) {
  Gradients J;
  for (const std::size_t i : rows) {
    std::vector<double> entries;
    for (const Expr entry : columns_of(block.rows[i].J)) entries.push_back(numbers.scalar(entry));
    J.push_back(std::move(entries));
  }
  return J;
}

std::vector<double> values(Numbers& numbers, const Block& block, const std::vector<std::size_t>& rows) {
  std::vector<double> C;
  for (const std::size_t i : rows) C.push_back(numbers.scalar(block.rows[i].C));
  return C;
}

double norm_of(const std::vector<double>& v) {
  double total = 0;
  for (const double x : v) total += x * x;
  return std::sqrt(total);
}

Sample moved(int dimension, Sample sample, const std::vector<double>& step, double fraction) {
  const std::size_t columns = columns_per_body(dimension);
  for (std::size_t i = 0; i < step.size(); ++i) {
    sample.bodies[i / columns].move(dimension, i % columns, fraction * step[i]);
  }
  return sample;
}

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

bool project(const Joint& joint, const Block& block, Sample& sample) {
  const std::vector<std::size_t> rows = position_rows(block);
  if (rows.empty()) return true;
  double error = INFINITY;
  for (int i = 0; i < most_steps && error > converged; ++i) {
    Numbers numbers(world_values(joint, sample));
    const std::vector<double> C = values(numbers, block, rows);
    error = norm_of(C);
    if (!std::isfinite(error)) return false;
    const std::vector<double> step = shortest_step(jacobian(numbers, block, rows), C);
    Sample next = sample;
    double next_error = INFINITY;
    for (double fraction = 1; fraction > 1e-3 && !(next_error < error); fraction /= 2) {
      next = moved(joint.dimension, sample, step, fraction);
      Numbers there(world_values(joint, next));
      next_error = norm_of(values(there, block, rows));
    }
    if (!(next_error < error)) break;
    sample = next;
    error = next_error;
  }
  return error < reached;
}

std::vector<std::vector<double>> jacobian_at(const Joint& joint, const Block& block, const Sample& sample) {
  std::vector<std::size_t> rows(block.rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = i;
  Numbers numbers(world_values(joint, sample));
  return jacobian(numbers, block, rows);
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
  for (std::uint64_t seed = 1; seed <= poses; ++seed) {
    Sample sample = random_sample(joint, expressions, seed);
    subject.anywhere.push_back(sample);
    if (project(joint, subject.block, sample)) subject.on_constraint.push_back(sample);
  }
  return subject;
}

}  // namespace cdot::derive
