// Rows of J that are combinations of the right ones: one of them twice, or all of them in other combinations.
#include "derive/diff/slips/slips.hpp"

namespace cdot::derive {
namespace {

using Rows = std::vector<List>;

Rows rows_of(const Whole& whole, const List& numbers) {
  Rows rows;
  for (int r = 0; r < whole.mine.rows; ++r)
    rows.emplace_back(numbers.begin() + static_cast<std::ptrdiff_t>(whole.at(r, 0)),
                      numbers.begin() + static_cast<std::ptrdiff_t>(whole.at(r, 0)) + whole.mine.columns);
  return rows;
}

// Directions that span the rows, orthogonal and of length 1.
Rows basis_of(const Rows& rows) {
  constexpr double rounding = 1e-9;
  Rows basis;
  const auto inner = [](const List& a, const List& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
  };
  for (List row : rows) {
    const double whole = std::sqrt(inner(row, row));
    for (int twice = 0; twice < 2; ++twice)
      for (const List& along : basis) {
        const double part = inner(row, along);
        for (std::size_t i = 0; i < row.size(); ++i) row[i] -= part * along[i];
      }
    const double rest = std::sqrt(inner(row, row));
    if (!(rest > rounding * (1 + whole))) continue;
    for (double& x : row) x /= rest;
    basis.push_back(std::move(row));
  }
  return basis;
}

std::optional<Slip> repeated(const Whole& whole) {
  for (int r = 1; r < whole.mine.rows; ++r)
    for (int other = 0; other < r; ++other) {
      const auto holds = [&](const std::vector<List>& numbers) {
        return std::ranges::all_of(numbers, [&](const List& of) {
          const Rows rows = rows_of(whole, of);
          return basis_of({rows[static_cast<std::size_t>(other)], rows[static_cast<std::size_t>(r)]}).size() < 2;
        });
      };
      if (holds(whole.published) && !holds(whole.generated))
        return Slip{"missing term", fmt::format("row {} repeats row {}, so one row is missing", r + 1, other + 1)};
    }
  return {};
}

std::optional<Slip> combined(const Whole& whole) {
  for (std::size_t i = 0; i < whole.published.size(); ++i) {
    const Rows mine = rows_of(whole, whole.generated[i]), hand = rows_of(whole, whole.published[i]);
    Rows both = mine;
    both.insert(both.end(), hand.begin(), hand.end());
    const std::size_t rank = basis_of(mine).size();
    const bool spans_all = rank == static_cast<std::size_t>(whole.mine.columns);
    if (spans_all || basis_of(hand).size() != rank || basis_of(both).size() != rank) return {};
  }
  return Slip{"order", "its rows are combinations of the right ones, which is right only with a C combined alike"};
}

}  // namespace

std::optional<Slip> slip_of_rows(const Whole& whole) {
  if (whole.what != "J" || whole.mine.rows < 2 || whole.published.empty()) return {};
  return first_of({repeated, combined}, whole);
}

}  // namespace cdot::derive
