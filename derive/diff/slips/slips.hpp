// One slip that explains all differences of a published matrix: an order, an inverse, a frame, a factor, a name. A
// reading turns the generated numbers into those that such a slip gives; it is named if these are the published ones at
// every pose.
#pragma once

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "derive/diff/entry.hpp"

namespace cdot::derive {

using List = std::vector<double>;

inline bool alike(double a, double b) {
  constexpr double rounding = 1e-8;
  return std::abs(a - b) <= rounding * (1 + std::abs(a) + std::abs(b));
}
inline bool alike(const List& a, const List& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) { return alike(x, y); });
}

// The inverse of a square matrix, row by row.
List inverted(const List& matrix);

// A published matrix beside the generated one, and their numbers by pose.
struct Whole {
  Whole(Entry& of, const Part* its_part, const std::string& quantity, const Matrix& its_hand, const Matrix& its_mine);

  Entry& entry;
  const Part* const part;  // null: of a claim
  const std::string what;
  const bool by_velocities;  // its columns: the row is M^-1 J^T lambda of an update
  const Matrix &hand, &mine;
  std::vector<List> published, generated;

  const std::vector<Sample>& samples() const { return entry.poses().samples(); }
  std::string row_name(int row) const { return part ? name_of_row(*part, row) : std::to_string(row + 1); }
  std::size_t at(int row, int column) const { return static_cast<std::size_t>(row * mine.columns + column); }

  // True if the published numbers are `expected(pose)`.
  template <class Expected>
  bool is(Expected expected) const {
    for (std::size_t i = 0; i < published.size(); ++i)
      if (!alike(published[i], expected(i))) return false;
    return !published.empty();
  }
  // True if the published numbers are the generated ones at samples changed by `change`.
  template <class Change>
  bool at_changed(Change change) const {
    return is([&](std::size_t i) {
      Sample sample = samples()[i];
      change(sample);
      return values_at(mine.entries, sample);
    });
  }
  // True if the published matrix, with these replacements, is the generated one; everywhere, or outside the lets of the
  // spec. A J has either sign.
  bool is_right_with(const std::map<const Node*, Expr>& replacements) const;
  // The same for the generated matrix, which becomes the published one.
  bool is_made_with(const std::map<const Node*, Expr>& replacements) const;
  bool turns_into(const Matrix& from, const std::vector<List>& to,
                  const std::map<const Node*, Expr>& replacements) const;
  static std::vector<Expr> substituted(const Matrix& in, const std::map<const Node*, Expr>& replacements);
};

// The first of these readings that explains the whole.
using Reading = std::optional<Slip> (*)(const Whole&);
inline std::optional<Slip> first_of(std::initializer_list<Reading> readings, const Whole& whole) {
  for (const Reading reading : readings)
    if (std::optional<Slip> found = reading(whole)) return found;
  return {};
}

std::optional<Slip> slip_of_order(const Whole& whole);         // rows, columns, bodies
std::optional<Slip> slip_of_rows(const Whole& whole);          // of J: a row twice, combinations of the right ones
std::optional<Slip> slip_of_frame(const Whole& whole);         // angular velocities along other axes
std::optional<Slip> slip_of_sign(const Whole& whole);          // of a body, of v or w, of masses
std::optional<Slip> slip_of_masses(const Whole& whole);        // inverses, what is missing, another body's axes
std::optional<Slip> slip_of_diagonal(const Whole& whole);      // of K: reduced masses, softness, arms
std::optional<Slip> slip_of_scale(const Whole& whole);         // all of it times one factor
std::optional<Slip> slip_of_symbol(const Whole& whole);        // an arm halved or exchanged, one symbol for another
std::optional<Slip> slip_of_exchange(const Whole& whole);      // of two symbols
std::optional<Slip> slip_of_factor(const Whole& whole);        // all of it, or one row
std::optional<Slip> slip_of_displacement(const Whole& whole);  // a term in the columns of another body
std::optional<Slip> slip_of_name(const Whole& whole);          // a let of the entry that stands for something else

}  // namespace cdot::derive
