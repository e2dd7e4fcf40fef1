// What an entry says, entry by entry of its matrices against what is derived.
#include <fmt/format.h>

#include <algorithm>

#include "derive/diff_entry.hpp"

namespace cdot::derive {
namespace {

constexpr std::size_t whole_row = ~std::size_t{0};  // not an entry of J but all of Cdot

std::string column_name(const Joint& joint, int column) {
  static const char* const planar[] = {"v_{}.x", "v_{}.y", "w_{}"};
  static const char* const spatial[] = {"v_{}.x", "v_{}.y", "v_{}.z", "w_{}.x", "w_{}.y", "w_{}.z"};
  const int width = static_cast<int>(columns_per_body(joint.dimension));
  return fmt::format(fmt::runtime((width == 3 ? planar : spatial)[column % width]),
                     joint.bodies[static_cast<std::size_t>(column / width)]);
}

Matrix transposed(const Matrix& m) {
  Matrix t{m.columns, m.rows, {}};
  for (int c = 0; c < m.columns; ++c) {
    for (int r = 0; r < m.rows; ++r) t.entries.push_back(m.at(r, c));
  }
  return t;
}

std::string row_text(const Matrix& m, int row) {
  std::string s;
  for (int c = 0; c < m.columns; ++c) s += (c > 0 ? ", " : "") + text(m.at(row, c));
  return s;
}

// The rows of `larger` that are none of `smaller`, if the others are those, in order.
std::optional<std::vector<int>> further_rows(const Matrix& larger, const Matrix& smaller,
                                             const Poses& poses) {
  if (larger.columns != smaller.columns) return std::nullopt;
  const auto same = [&](int i, int j) {
    for (const Rational sign : {Rational(1), Rational(-1)}) {
      bool all = true;
      for (int c = 0; c < larger.columns; ++c)
        all = all && poses.equal(larger.at(i, c), sign * smaller.at(j, c));
      if (all) return true;
    }
    return false;
  };
  std::vector<int> further;
  int found = 0;
  for (int i = 0; i < larger.rows; ++i) {
    if (found < smaller.rows && same(i, found))
      ++found;
    else
      further.push_back(i);
  }
  if (found < smaller.rows) return std::nullopt;
  return further;
}

}  // namespace

// Rows are numbered, or named in parts about certain rows.
std::string EntryJudge::name_of_row(const Part& part, int row) {
  return part.hand->rows.empty() ? std::to_string(row + 1)
                                 : part.rows[static_cast<std::size_t>(row)].name;
}

Place EntryJudge::place_of(const Part& part, const HandItem& item, int row, int column) const {
  Place place{item.what, std::to_string(row + 1), "", {}, {}, &joint_};
  if (item.kind == HandItem::Kind::claim) {
    place.what = "claim on " + item.what;
    if (item.value && item.value->entries.size() == 1) place.row.clear();
    if (item.value && item.value->columns > 1) place.column = std::to_string(column + 1);
    return place;
  }
  place.row = name_of_row(part, row);
  if (item.what == "K") place.column = name_of_row(part, column);
  if (item.what == "J") place.column = column_name(joint_, column);
  return place;
}

void EntryJudge::add(const HandItem& item, Difference difference, Expr hand, Expr generated) {
  if (difference.kind != "sign" && difference.kind != "wrong body") {
    const std::string hidden = hidden_assumption(joint_, constraints(), hand, generated, poses());
    if (!hidden.empty()) difference.sentence += fmt::format("; equal only where {}", hidden);
    const bool unsaid = item.kind == HandItem::Kind::claim || hidden == "C = 0";
    if (!hidden.empty() && unsaid) difference.kind = "undeclared assumption";
  }
  difference.what = item.kind == HandItem::Kind::update ? "update" : item.what;
  difference.where = item.where;
  out_.differences.push_back(std::move(difference));
}

void EntryJudge::add_plain(const HandItem& item, const Place& place, std::string kind,
                           std::string sentence, std::string confirmed) {
  Difference d;
  d.what = item.kind == HandItem::Kind::claim ? item.what : place.what;
  d.row = place.row;
  d.column = place.column;
  d.kind = std::move(kind);
  d.hand = item.text;
  d.sentence = fmt::format("{}: {}", name_of(place), sentence);
  d.confirmed = std::move(confirmed);
  d.where = item.where;
  out_.differences.push_back(std::move(d));
}

// What each leaf of C that moves with a body brings into an entry of J, or into Cdot: the terms of
// the product rule.
std::vector<Contribution> EntryJudge::contributions(const ScalarRow& row, std::size_t entry,
                                                    Rational sign) const {
  std::vector<Contribution> sources;
  if (row.kind == RowKind::velocity) return sources;
  for (const Expr leaf : leaves_of(std::span(&row.C, 1))) {
    if (leaf->body < 0) continue;
    ScalarRow only;
    only.Cdot = time_derivative(row.C, joint_, {immovable_, leaf});
    only.J = isolate_velocities(only.Cdot, joint_);
    sources.push_back({leaf, sign * (entry == whole_row ? only.Cdot : columns_of(only.J)[entry])});
  }
  return sources;
}

void EntryJudge::compare_entry(const Part& part, const HandItem& item, int row, int column,
                               Expr hand, Expr generated) {
  if (equal(hand, generated)) return;
  Place place = place_of(part, item, row, column);
  const std::size_t r = static_cast<std::size_t>(row);
  if (item.kind != HandItem::Kind::claim && item.what == "J") {
    const std::vector<Expr> mine = columns_of(part.rows[r].J);
    const int width = static_cast<int>(columns_per_body(joint_.dimension));
    for (int c = column % width; c < static_cast<int>(mine.size()); c += width) {
      if (c != column) place.elsewhere.push_back(mine[static_cast<std::size_t>(c)]);
    }
    place.sources =
        contributions(part.rows[r], static_cast<std::size_t>(column), Rational(part.sign[r]));
  }
  if (item.kind != HandItem::Kind::claim && item.what == "Cdot") {
    place.sources = contributions(part.rows[r], whole_row, Rational(part.sign[r]));
  }
  Difference d = describe_difference(place, hand, generated, poses());
  d.confirmed = confirmation(part, item, row, column, hand, generated);
  add(item, std::move(d), hand, generated);
}

std::string EntryJudge::confirmation(const Part& part, const HandItem& item, int row, int column,
                                     Expr hand, Expr generated) {
  if (item.kind == HandItem::Kind::claim) return confirm().claim(hand, generated);
  const std::size_t r = static_cast<std::size_t>(row), c = static_cast<std::size_t>(column);
  const ScalarRow& of = part.rows[r];
  const double sign = part.sign[r];
  if (item.what == "C") return confirm().value_of_C(of, poses_on_constraint(), generated, hand);
  if (item.what == "J") return confirm().entry_of_J(of, sign, c, generated, hand);
  if (item.what == "K")
    return confirm().entry_of_K(of, part.rows[c], sign * part.sign[c], generated, hand);
  return confirm().rate(of, item.what == "b" ? -sign : sign, generated, hand);
}

void EntryJudge::compare(const Part& part, const HandItem& item, const Matrix& hand,
                         const Matrix& generated) {
  const bool claim = item.kind == HandItem::Kind::claim;
  if (hand.rows != generated.rows || hand.columns != generated.columns) {
    return compare_sizes(part, item, hand, generated);
  }
  for (int r = 0; r < hand.rows; ++r) {
    for (int c = 0; c < hand.columns; ++c) {
      Rational sign(1);
      if (!claim) sign = part.sign[static_cast<std::size_t>(r)];
      if (!claim && item.what == "K")
        sign = sign * Rational(part.sign[static_cast<std::size_t>(c)]);
      if (item.what == "b" && !claim) sign = -sign;
      compare_entry(part, item, r, c, hand.at(r, c), sign * generated.at(r, c));
    }
  }
}

// Matrices of different sizes: turned, or with rows too many or too few.
void EntryJudge::compare_sizes(const Part& part, const HandItem& item, const Matrix& hand,
                               const Matrix& generated) {
  Place place = place_of(part, item, 0, 0);
  place.row.clear();
  place.column.clear();
  const auto size = [](const Matrix& m) { return fmt::format("{} x {}", m.rows, m.columns); };
  const std::string sizes =
      fmt::format("{} numbers stand where {} belong", size(hand), size(generated));
  const std::string none =
      fmt::format("{} and {} numbers have no difference", size(hand), size(generated));
  if (hand.columns == generated.rows && hand.rows == generated.columns) {
    const bool right = further_rows(transposed(hand), generated, poses()).has_value();
    return add_plain(item, place, "transposed", sizes + ": it is transposed",
                     none + (right ? "; transposed, it agrees at 12 poses" : ""));
  }
  const bool more = hand.rows > generated.rows;
  const auto further = further_rows(more ? hand : generated, more ? generated : hand, poses());
  if (!further) return add_plain(item, place, more ? "extra term" : "missing term", sizes, none);
  std::string which, what;
  for (const int row : *further) {
    which += fmt::format("{}{}", which.empty() ? "" : ", ", row + 1);
    what += fmt::format("{}{}", what.empty() ? "" : "; ", row_text(more ? hand : generated, row));
  }
  place.row = which;
  if (more) {
    add_plain(item, place, "extra term",
              fmt::format("{}: this row ({}) does not belong", sizes, what),
              none + "; without that row both sides agree at 12 poses");
  } else {
    add_plain(item, place, "missing term", fmt::format("{}: this row ({}) is missing", sizes, what),
              none + "; the rows that are there agree at 12 poses");
  }
}

// A formula without a value: as it stands, and as its author may have meant it.
void EntryJudge::judge_problem(const Part& part, const HandItem& item) {
  Place place{item.what.empty() ? "update" : item.what, "", "", {}, {}, &joint_};
  if (part.rows.size() == 1 && item.kind == HandItem::Kind::quantity)
    place = place_of(part, item, 0, 0);
  std::string sentence = item.problem, confirmed = "no value: " + item.problem;
  const Matrix& Cdot = part.generated.Cdot;
  for (const HandReading& reading : item.readings) {
    const bool rate = item.what == "Cdot" || item.what == "b";
    if (!rate || reading.value.entries.size() != 1 || Cdot.entries.size() != 1) continue;
    for (const int sign : {1, -1}) {
      if (!equal(reading.value.entries[0], Rational(sign) * Cdot.entries[0])) continue;
      place.column = reading.column;
      sentence += fmt::format("; {} it is right", reading.words);
      confirmed = confirm().reading(reading.words, part.rows[0], sign, reading.value.entries[0]);
      return add_plain(item, place, "factor", std::move(sentence), std::move(confirmed));
    }
  }
  add_plain(item, place, "factor", std::move(sentence), std::move(confirmed));
}

}  // namespace cdot::derive
