// Rows that cannot work: their J vanishes where C = 0, or they are redundant there.
#include <algorithm>
#include <cmath>

#include "derive/check/parts.hpp"
#include "derive/derivation/free_coordinates.hpp"
#include "derive/numbers/modular.hpp"
#include "derive/proof/words.hpp"

namespace cdot::derive {
namespace {

constexpr double negligible = 1e-5;  // of a row's usual length; projection reaches about 1e-7

// The u of |u| = 0 or u . u = 0.
Expr vector_that_vanishes(Expr C) {
  const Expr e = split_coefficient(C).e;
  if (e->kind == Kind::norm) return e->args[0];
  if (e->kind == Kind::dot && e->args[0] == e->args[1]) return e->args[0];
  if (e->kind == Kind::product && e->args.size() == 1) return vector_that_vanishes(e->args[0]);
  return {};
}

// An equivalent row that changes its sign at C = 0, if the form of C shows one.
std::string better_form(Expr C, const Joint& joint) {
  if (const Expr u = vector_that_vanishes(C)) return vanishing_vector(u, joint);
  const Expr e = split_coefficient(C).e;
  if (e->kind == Kind::product && e->args.size() == 1) return spec_text(e->args[0], joint) + " = 0";
  if (e->kind == Kind::function && e->fn == Fn::abs) return spec_text(e->args[0], joint) + " = 0";
  if (e->kind != Kind::sum || e->args.size() != 2) return "";
  for (std::size_t i = 0; i < 2; ++i) {  // cos(x) = 1, dot(s, t) = 1
    const Expr part = e->args[i], rest = e->args[1 - i];
    if (!is_one(rest) || abs(e->coefs[0]) != abs(e->coefs[1])) continue;
    if (part->kind == Kind::function && part->fn == Fn::cos) {
      return spec_text(part->args[0], joint) + (e->coefs[0] == e->coefs[1] ? " = pi" : " = 0");
    }
    const bool directions = part->kind == Kind::dot && part->args[0]->unit_length && part->args[1]->unit_length;
    if (directions) {
      if (joint.dimension == 3) return parallel(part->args[0], part->args[1], joint);
      const std::string both = spec_text(part->args[0], joint) + ", " + spec_text(part->args[1], joint);
      return e->coefs[0] == e->coefs[1] ? "angle(" + both + ") = pi" : "angle(" + both + ") = 0";
    }
  }
  return "";
}

// True if the row's J is negligible at every pose with C = 0, beside its length elsewhere.
bool vanishes_on_constraint(const Subject& subject, std::size_t row) {
  double usual = 0, largest = 0;
  for (const Sample& sample : subject.anywhere) {
    usual = std::max(usual, length(jacobian_at(subject.block, sample)[row]));
  }
  for (const Sample& sample : subject.on_constraint) {
    largest = std::max(largest, length(jacobian_at(subject.block, sample)[row]));
  }
  return !subject.on_constraint.empty() && largest < negligible * usual;
}

bool find_vanishing(const Subject& subject, Findings& findings) {
  bool found = false;
  for (std::size_t i = 0; i < subject.block.rows.size(); ++i) {
    const ScalarRow& row = subject.block.rows[i];
    if (row.kind == RowKind::velocity || !vanishes_on_constraint(subject, i)) continue;
    found = true;
    const std::string better = better_form(row.C, subject.joint);
    findings.add(
        Level::error, "vanishing", row.row->where,
        row.name +
            ": J vanishes where C = 0: C touches zero without changing its sign, so no impulse enforces it (K is 0)",
        better.empty() ? "write the row so that C changes its sign at C = 0"
                       : "write `" + better + "`, which changes its sign at zero");
  }
  return found;
}

// The unit row with the shortest part orthogonal to the rows before it.
struct Weakest {
  std::size_t row = 0;
  double rest = 1;
};
Weakest weakest(std::vector<std::vector<double>> J) {
  Weakest out;
  for (std::size_t i = 0; i < J.size(); ++i) {
    const double before = length(J[i]);
    for (double& x : J[i]) x /= before;
    for (std::size_t k = 0; k < i; ++k) {
      double along = 0;
      for (std::size_t c = 0; c < J[i].size(); ++c) along += J[i][c] * J[k][c];
      for (std::size_t c = 0; c < J[i].size(); ++c) J[i][c] -= along * J[k][c];
    }
    const double rest = length(J[i]);
    if (rest < out.rest) out = {i, rest};
    for (double& x : J[i]) x /= rest;
  }
  return out;
}

void find_dependent_on_constraint(const Subject& subject, Findings& findings) {
  const std::vector<ScalarRow>& rows = subject.block.rows;
  if (subject.on_constraint.empty() || !generic_rank(columns_of(rows)).dependences.empty()) return;
  std::size_t row = 0;
  for (const Sample& sample : subject.on_constraint) {
    const Weakest weak = weakest(jacobian_at(subject.block, sample));
    if (!(weak.rest < negligible)) return;
    row = std::max(row, weak.row);
  }
  const Expr C = split_coefficient(rows[row].row->C).e;
  const auto of = [&](Expr u, Expr v) { return parallel(u, v, subject.joint); };
  const bool difference = C->vector && C->kind == Kind::sum && C->args.size() == 2 && C->args[0]->unit_length &&
                          C->args[1]->unit_length && C->coefs[0] == -C->coefs[1];
  const std::string two = (C->vector && C->kind == Kind::cross) || difference ? of(C->args[0], C->args[1]) : "";
  findings.add(Level::error, "dependent", rows[row].row->where,
               rows[row].name + ": where C = 0, and only there, its row of J is a combination of the rows before it",
               two.empty() ? "drop the row, or state its condition in another form"
                           : "two of the three rows are independent: write `" + two + "`");
}

void find_unreachable(const Subject& subject, Findings& findings) {
  const bool any = std::any_of(subject.block.rows.begin(), subject.block.rows.end(),
                               [](const ScalarRow& r) { return r.kind != RowKind::velocity; });
  if (!any || !subject.on_constraint.empty()) return;
  findings.add(
      Level::warning, "unreachable", subject.block.rows.front().row->where,
      "no pose with C = 0 was found from " + std::to_string(subject.anywhere.size()) + " random poses and parameters",
      "check that all rows can be satisfied at once");
}

bool is_in(const Block& block, std::size_t row, std::size_t body) {
  const JacobianEntry& entry = block.rows[row].J[body];
  return !is_zero(entry.v) || !is_zero(entry.w);
}

// A joint does not act on a body whose velocity is in no row. A body that some rows lack is worth a note.
void find_absent_bodies(const Subject& subject, Findings& findings) {
  const Joint& joint = subject.joint;
  const std::size_t rows = subject.block.rows.size();
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    std::vector<std::string> without;
    for (std::size_t i = 0; i < rows; ++i) {
      if (!is_in(subject.block, i, b)) without.push_back(subject.block.rows[i].name);
    }
    if (without.empty()) continue;
    const bool all = without.size() == rows;
    findings.add(
        all ? Level::warning : Level::note, "absent", joint.rows.front().where,
        "the velocity of " + joint.bodies[b] +
            (all ? " is in no row: the joint does not act on it" : " is not in " + listed(without, " nor in ")),
        all ? "leave the body out, or use it in a row" : "");
  }
}

// A coordinate that the rows determine is not free: a motor on it would fight them.
void find_constrained_coordinates(const Subject& subject, Findings& findings) {
  for (const Diagnostic& said : errors_of_constrained_coordinates(subject.joint)) {
    findings.push_back({Level::error, "held", said.where, said.also, said.message, said.fix});
  }
}

}  // namespace

double length(const std::vector<double>& row) {
  double total = 0;
  for (const double x : row) total += x * x;
  return std::sqrt(total);
}

void check_rows(const Subject& subject, Findings& findings) {
  find_unreachable(subject, findings);
  if (!find_vanishing(subject, findings)) find_dependent_on_constraint(subject, findings);
  find_absent_bodies(subject, findings);
  find_constrained_coordinates(subject, findings);
}

}  // namespace cdot::derive
