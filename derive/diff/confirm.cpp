#include "derive/diff/confirm.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace cdot::derive {
namespace {

Sample moved_along(const Joint& joint, Sample sample, const Motion& motion, double time, double amount) {
  const std::size_t width = columns_per_body(joint.dimension);
  for (std::size_t c = 0; c < motion.size(); ++c) {
    sample.bodies[c / width].move(joint.dimension, c % width, amount * motion[c]);
  }
  const auto clock = sample.scalars.find("time");
  if (clock != sample.scalars.end()) clock->second += amount * time;
  return sample;
}

Sample with_velocities(const Joint& joint, Sample sample, const Motion& motion) {
  const std::size_t width = columns_per_body(joint.dimension), linear = static_cast<std::size_t>(joint.dimension);
  for (std::size_t c = 0; c < motion.size(); ++c) {
    Sample::Body& body = sample.bodies[c / width];
    const std::size_t k = c % width;
    if (k < linear) body.v[k] = motion[c];
    else body.w[joint.dimension == 2 ? 2 : k - linear] = motion[c];
  }
  return sample;
}

// A row of the inverse inertia of a body: one number in the plane, of a tensor in space.
std::vector<double> inverse_inertia(const Joint& joint, const Sample& sample, std::size_t body, std::size_t row) {
  const std::string name = "inv_I_" + joint.bodies[body];
  if (joint.dimension == 2) return {sample.scalars.at(name)};
  std::vector<double> numbers;
  for (std::size_t k = 0; k < 3; ++k) {
    numbers.push_back(sample.scalars.at(name + "_" + "xyz"[std::min(row, k)] + "xyz"[std::max(row, k)]));
  }
  return numbers;
}

double largest(const Poses& poses, const Confirm::Measure& error) {
  double most = 0;
  for (const Sample& sample : poses.samples()) most = std::max(most, std::abs(error(sample)));
  return most;
}

std::string small(double error) { return error == 0 ? "0" : fmt::format("{:.0e}", error); }

double inner(const Motion& a, const Motion& b) {
  double total = 0;
  for (std::size_t i = 0; i < a.size(); ++i) total += a[i] * b[i];
  return total;
}

Motion sum_of(const Motion& a, const Motion& b) {
  Motion total = a;
  for (std::size_t i = 0; i < b.size(); ++i) total[i] += b[i];
  return total;
}

}  // namespace

double rate_along(const Joint& joint, const ScalarRow& row, const Sample& sample, const Motion& motion, double time) {
  if (row.kind == RowKind::velocity) {
    const Motion rest(motion.size());
    return values_at({row.Cdot}, with_velocities(joint, sample, motion))[0] -
           values_at({row.Cdot}, with_velocities(joint, sample, rest))[0];
  }
  constexpr double step = 1e-6;
  return (values_at({row.C}, moved_along(joint, sample, motion, time, step))[0] -
          values_at({row.C}, moved_along(joint, sample, motion, time, -step))[0]) /
         (2 * step);
}

Motion Confirm::gradient(const ScalarRow& row, const Sample& sample) const {
  Motion J;
  const std::size_t columns = sample.bodies.size() * columns_per_body(joint_.dimension);
  for (std::size_t c = 0; c < columns; ++c) {
    Motion along(columns);
    along[c] = 1;
    J.push_back(rate_along(joint_, row, sample, along, 0));
  }
  return J;
}

// J diag(E, A) or J diag(E, 2 G), body by body.
Motion Confirm::in_form(const Motion& gradient, const Sample& sample) const {
  if (form_ == Form::global) return gradient;
  Motion columns;
  for (std::size_t b = 0; b < sample.bodies.size(); ++b) {
    const double* J = &gradient[6 * b];
    const EulerParameters<double>& e = sample.bodies[b].e;
    const Triple<double> w = {J[3], J[4], J[5]};
    columns.insert(columns.end(), J, J + 3);
    if (form_ == Form::local) {
      for (const Triple<double>& axis : axes_of(e)) columns.push_back(inner_product(w, axis));
    } else {
      for (const Triple<double>& g :
           {Triple<double>{-e[1], -e[2], -e[3]}, {e[0], e[3], -e[2]}, {-e[3], e[0], e[1]}, {e[2], -e[1], e[0]}}) {
        columns.push_back(2 * inner_product(w, g));
      }
    }
  }
  return columns;
}

Motion Confirm::velocity(const Sample& sample) const {
  Motion v;
  for (const Sample::Body& body : sample.bodies) {
    for (std::size_t k = 0; k < columns_per_body(joint_.dimension); ++k)
      v.push_back(body.velocity(joint_.dimension, k));
  }
  return v;
}

Motion Confirm::times_inverse_mass(const Sample& sample, const Motion& impulse) const {
  const std::size_t width = columns_per_body(joint_.dimension), linear = static_cast<std::size_t>(joint_.dimension);
  Motion change(impulse.size());
  for (std::size_t c = 0; c < impulse.size(); ++c) {
    const std::size_t body = c / width, k = c % width;
    if (static_cast<int>(body) == immovable_) continue;
    if (k < linear) {
      change[c] = impulse[c] * sample.scalars.at("inv_m_" + joint_.bodies[body]);
      continue;
    }
    const std::vector<double> row = inverse_inertia(joint_, sample, body, k - linear);
    for (std::size_t j = 0; j < row.size(); ++j) change[c] += row[j] * impulse[body * width + linear + j];
  }
  return change;
}

// The impulse p with M^-1 p = change, body by body: the shortest such p is the only one.
Motion Confirm::times_mass(const Sample& sample, const Motion& change) const {
  Gradients inverse(change.size());
  for (std::size_t c = 0; c < change.size(); ++c) {
    Motion unit(change.size());
    unit[c] = -1;
    inverse[c] = times_inverse_mass(sample, unit);
  }
  return shortest_step(inverse, change);
}

std::string Confirm::worst(const std::string& how, const Poses& poses, const Measure& generated_error,
                           const Measure& published_error) const {
  return fmt::format("{} at {} poses: generated off by {}, published by {:.2g}", how, poses.samples().size(),
                     small(largest(poses, generated_error)), largest(poses, published_error));
}

Confirm::Measure Confirm::error(const Measure& measured, Expr e) const {
  return [this, measured, e](const Sample& sample) {
    const double truth = measured(sample);
    return (value(e, sample) - truth) / (1 + std::abs(truth));
  };
}

std::string Confirm::against(const Measure& measured, Expr generated, Expr published, const std::string& how) const {
  return worst(how, poses_, error(measured, generated), error(measured, published));
}

double Confirm::mass(const ScalarRow& row, const ScalarRow& other, const Sample& sample) const {
  return inner(gradient(row, sample), times_inverse_mass(sample, gradient(other, sample)));
}

double Confirm::rate(const ScalarRow& row, const Sample& sample) const {
  return rate_along(joint_, row, sample, velocity(sample), 1);
}

std::string Confirm::value_of_C(const ScalarRow& row, const Poses& fulfilled, Expr generated, Expr published) const {
  const bool coordinate = row.row == nullptr;
  const Expr zero = published->pool->number(0);
  if (!coordinate && !fulfilled.empty() && !fulfilled.equal(published, zero)) {
    return worst(
        "C where the constraint holds", fulfilled, [&](const Sample& sample) { return value(generated, sample); },
        [&](const Sample& sample) { return value(published, sample); });
  }
  const std::string how = coordinate ? "the coordinate" : "C, which is zero in the same places,";
  return worst(
      how, poses_, [](const Sample&) { return 0.; },
      [&](const Sample& sample) { return value(published, sample) - value(generated, sample); });
}

std::string Confirm::claim(Expr left, Expr right) const {
  const Measure apart = [&](const Sample& sample) { return value(left, sample) - value(right, sample); };
  const Sample& first = poses_.samples().front();
  return fmt::format(
      "both sides at {} poses: they differ by up to {:.2g}; at the first {:.4g} stands where {:.4g} belongs",
      poses_.samples().size(), largest(poses_, apart), value(left, first), value(right, first));
}

std::string Confirm::reading(const std::string& words, const ScalarRow& row, double sign, Expr read) const {
  const Measure measured = [&](const Sample& sample) { return sign * rate(row, sample); };
  return fmt::format("no value as published; {} it is off by {} from central differences of C at {} poses", words,
                     small(largest(poses_, error(measured, read))), poses_.samples().size());
}

std::string Confirm::row_space(const Poses& poses, const Matrix& larger, const Matrix& smaller) const {
  double off = 0;
  for (const Sample& sample : poses.samples()) {
    const auto rows_of = [&](const Matrix& m) {
      const std::vector<double> all = values_at(m.entries, sample);
      Gradients rows;
      for (int r = 0; r < m.rows; ++r) {
        rows.emplace_back(all.begin() + r * m.columns, all.begin() + (r + 1) * m.columns);
      }
      return rows;
    };
    const Gradients basis = rows_of(larger);
    for (const Motion& row : rows_of(smaller)) {
      std::vector<double> along;
      for (const Motion& of : basis) along.push_back(inner(of, row));
      for (const double rest : sum_of(row, shortest_step(basis, along))) off = std::max(off, std::abs(rest));
    }
  }
  return fmt::format(
      "; where the constraint holds, the rows of the smaller are combinations of those of the larger, off by {} at {} "
      "poses",
      small(off), poses.samples().size());
}

double Confirm::work(const std::vector<ScalarRow>& rows, const Motion& added, const Sample& sample) const {
  Gradients J;
  Motion rates;
  for (const ScalarRow& row : rows) {
    J.push_back(gradient(row, sample));
    rates.push_back(inner(J.back(), velocity(sample)));
  }
  return inner(times_mass(sample, added), sum_of(velocity(sample), shortest_step(J, rates)));
}

std::string Confirm::after(UpdateLevel level, const std::vector<ScalarRow>& rows, const Change& change) const {
  static const char* const how[] = {
      // in the order of UpdateLevel
      "Cdot after the update, by central differences of C,", "C after the update, by central differences along it,",
      "work along motions that C allows (right: 0)"};
  const auto left = [&](const Motion& added, const Sample& sample) {
    if (level == UpdateLevel::any_impulse) return work(rows, added, sample);
    double most = 0;
    for (const ScalarRow& row : rows) {
      const double rest = level == UpdateLevel::positions
                              ? value(row.C, sample) + rate_along(joint_, row, sample, added, 0)
                              : rate_along(joint_, row, sample, sum_of(velocity(sample), added), 1);
      most = std::max(most, std::abs(rest));
    }
    return most;
  };
  const auto remaining = [&](const std::vector<Expr>& columns) {
    return [&](const Sample& sample) { return left(values_at(columns, sample), sample); };
  };
  return worst(how[static_cast<int>(level)], poses_, remaining(change.generated), remaining(change.published));
}

std::string Confirm::bound(const std::vector<ScalarRow>& rows, const std::vector<Expr>& lambda, bool inequality) const {
  // Velocities are reversed where C falls.
  const auto rising = [&](const Sample& sample) {
    return std::abs(rate_along(joint_, rows[0], sample, velocity(sample), 0));
  };
  const auto impulse = [&](const Sample& sample) { return value(lambda[0], sample); };
  const auto none = [](const Sample&) { return 0.; };
  if (inequality) return worst("impulse while C rises by itself", poses_, none, impulse);
  return worst("Cdot that an impulse kept above 0 leaves while C rises", poses_, none, rising);
}

}  // namespace cdot::derive
