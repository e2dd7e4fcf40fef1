// The law of ranks.
#include "derive/proof/laws.hpp"

namespace cdot::derive {
namespace {

// "the row of J of C3 is 2 C1 - C2"
std::string dependence_text(const GenericRank::Dependence& d, const Block& block) {
  const auto name = [&](int row) { return block.rows[static_cast<std::size_t>(row)].name; };
  if (d.on.empty()) return "the row of J of " + name(d.row) + " is zero";
  std::string sum;
  for (const int row : d.on) {
    if (d.coefs.empty()) {
      sum += (sum.empty() ? "" : " and ") + name(row);
      continue;
    }
    const Rational coef = -d.coefs[static_cast<std::size_t>(row)];
    sum += coef.sign() < 0 ? (sum.empty() ? "-" : " - ") : (sum.empty() ? "" : " + ");
    sum += (abs(coef) == Rational(1) ? "" : abs(coef).text() + " ") + name(row);
  }
  if (!d.coefs.empty()) return "the row of J of " + name(d.row) + " is that of " + sum;
  return "the row of J of " + name(d.row) + " is a combination of those of " + sum +
         ", with factors that depend on the pose or on parameters";
}

}  // namespace

void rows_are_independent(Law& law, const Block& block) {
  law.verdict = Verdict::does_not_apply;
  if (block.immovable >= 0) return;  // a row may well speak of that body alone
  const GenericRank found = generic_rank(columns_of(block.rows));
  if (found.poses == 0) {
    law.text = "no pose was found at which every row is defined";
    law.row = block.rows.front().row;
    law.fix = "give roots and logarithms arguments that can be positive at one pose, all together";
  }
  law.verdict = found.poses == 0 ? Verdict::undecided : found.dependences.empty() ? Verdict::holds : Verdict::fails;
  if (law.verdict != Verdict::fails) return;
  const GenericRank::Dependence& first = found.dependences.front();
  law.row = block.rows[static_cast<std::size_t>(first.row)].row;
  const bool alone = block.rows.size() == 1;
  law.text =
      (alone ? ""
             : std::to_string(block.rows.size()) + " rows, but only " + std::to_string(found.rank) + " independent: ") +
      dependence_text(first, block);
  law.fix = first.on.empty() ? "no motion changes this row: use points, directions or angles of two bodies"
                             : "drop one of these rows: it follows from the others";
}

}  // namespace cdot::derive
