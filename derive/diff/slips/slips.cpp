// A published matrix and the generated one to the slip that explains all their differences.
#include "derive/diff/slips/slips.hpp"

#include <utility>

#include "derive/numbers/elimination.hpp"

namespace cdot::derive {

List inverted(const List& matrix) {
  const auto n = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(matrix.size()))));
  std::vector<List> rows(n, List(n));
  for (std::size_t i = 0; i < n * n; ++i) rows[i / n][i % n] = matrix[i];
  List inverse(n * n);
  for (std::size_t c = 0; c < n; ++c) {
    List unit(n);
    unit[c] = 1;
    const List column = derive::solved(rows, unit, [](double a, double pivot) { return a / pivot; });
    for (std::size_t r = 0; r < n; ++r) inverse[r * n + c] = column[r];
  }
  return inverse;
}

Whole::Whole(Entry& of, const Part* its_part, const std::string& quantity, const Matrix& its_hand,
             const Matrix& its_mine)
    : entry(of),
      part(its_part),
      what(quantity),
      by_velocities(quantity == "J" || quantity == "update"),
      hand(its_hand),
      mine(its_mine) {
  for (const Sample& sample : samples()) {
    published.push_back(values_at(hand.entries, sample));
    generated.push_back(values_at(mine.entries, sample));
  }
}

bool Whole::is_right_with(const std::map<const Node*, Expr>& replacements) const {
  return turns_into(hand, generated, replacements);
}

bool Whole::is_made_with(const std::map<const Node*, Expr>& replacements) const {
  return turns_into(mine, published, replacements);
}

bool Whole::turns_into(const Matrix& from, const std::vector<List>& to,
                       const std::map<const Node*, Expr>& replacements) const {
  std::map<const Node*, Expr> outside = replacements;
  for (const Let& let : entry.joint.lets) outside.emplace(&*let.value, let.value);
  for (const auto* by : {&replacements, &std::as_const(outside)}) {
    const std::vector<Expr> mended = substituted(from, *by);
    bool same = !to.empty(), opposite = same && what == "J";
    for (std::size_t i = 0; (same || opposite) && i < to.size(); ++i) {
      List values = values_at(mended, samples()[i]);
      same = same && alike(values, to[i]);
      for (double& value : values) value = -value;
      opposite = opposite && alike(values, to[i]);
    }
    if (same || opposite) return true;
  }
  return false;
}

std::vector<Expr> Whole::substituted(const Matrix& in, const std::map<const Node*, Expr>& replacements) {
  std::vector<Expr> entries;
  for (const Expr e : in.entries) entries.push_back(substitute(e, replacements, KeepNames::no));
  return entries;
}

std::optional<Slip> slip_of_whole(Entry& entry, const Part* part, const std::string& what, const Matrix& published,
                                  const Matrix& generated) {
  const Whole whole(entry, part, what, published, generated);
  return first_of({slip_of_order, slip_of_frame, slip_of_sign, slip_of_masses, slip_of_diagonal, slip_of_scale,
                   slip_of_symbol, slip_of_factor, slip_of_displacement, slip_of_name, slip_of_exchange, slip_of_rows},
                  whole);
}

}  // namespace cdot::derive
