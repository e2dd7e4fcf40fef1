// What an entry says, entry by entry of its matrices against what is derived.
#include <algorithm>
#include <fmt/format.h>
#include <regex>

#include "derive/diff/entry.hpp"
#include "derive/diff/merge.hpp"

namespace cdot::derive {
namespace {

constexpr std::size_t whole_row = ~std::size_t{0};  // not an entry of J but all of Cdot

std::string column_name(const Joint& joint, Form form, int column) {
  static const char* const planar[] = {"v_{}.x", "v_{}.y", "w_{}"};
  static const char* const spatial[] = {"v_{}.x", "v_{}.y", "v_{}.z", "w_{}.x", "w_{}.y", "w_{}.z"};
  const bool space = joint.dimension == 3;
  const int width = static_cast<int>(space ? columns_per_body(form) : columns_per_body(2));
  if (space && form != Form::global && column % width >= 3) {
    const std::string& body = joint.bodies[static_cast<std::size_t>(column / width)];
    const int k = column % width - 3;
    if (form == Form::euler) return fmt::format("edot_{}.{}", body, k);
    return fmt::format("w'_{}.{}", body, "xyz"[k]);
  }
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
std::optional<std::vector<int>> further_rows(const Matrix& larger, const Matrix& smaller, const Poses& poses) {
  if (larger.columns != smaller.columns) return std::nullopt;
  const auto same = [&](int i, int j) {
    for (const Rational sign : {Rational(1), Rational(-1)}) {
      bool all = true;
      for (int c = 0; c < larger.columns; ++c) all = all && poses.equal(larger.at(i, c), sign * smaller.at(j, c));
      if (all) return true;
    }
    return false;
  };
  std::vector<int> further;
  int found = 0;
  for (int i = 0; i < larger.rows; ++i) {
    if (found < smaller.rows && same(i, found)) ++found;
    else further.push_back(i);
  }
  if (found < smaller.rows) return std::nullopt;
  return further;
}

}  // namespace

// Rows are numbered, or named in parts about certain rows.
std::string EntryJudge::name_of_row(const Part& part, int row) {
  return part.hand->rows.empty() ? std::to_string(row + 1) : part.rows[static_cast<std::size_t>(row)].name;
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
  if (item.what == "J") place.column = column_name(joint_, form_, column);
  return place;
}

// The axis that the spec calls f.x is a leaf f_x.
std::string EntryJudge::in_names_of_spec(std::string text) const {
  if (joint_.dimension == 2) return text;
  std::vector<std::string> frames;
  for (const Parameter& p : joint_.parameters) {
    if (p.kind == ParameterKind::frame) frames.push_back(p.name);
  }
  for (const std::string& body : joint_.bodies) frames.push_back("axis_" + body);
  for (const std::string& frame : frames) {
    const std::string name = frame.starts_with("axis_") ? frame.substr(5) : frame;
    text = std::regex_replace(text, std::regex("\\b" + frame + "_([xyz])\\b"), name + ".$1");
  }
  return text;
}

// With the condition that may have been meant.
Difference EntryJudge::finished(const HandItem& item, Difference difference, Expr hand, Expr generated) {
  if (difference.kind != "sign" && difference.kind != "wrong body") {
    const std::string hidden = hidden_assumption(joint_, poses_on_constraint(), hand, generated, poses());
    if (!hidden.empty()) difference.sentence += fmt::format("; equal only where {}", hidden);
    const bool unsaid = item.kind == HandItem::Kind::claim || hidden == "C = 0";
    if (!hidden.empty() && unsaid) difference.kind = "undeclared assumption";
  }
  difference.what = item.kind == HandItem::Kind::update ? "update" : item.what;
  difference.where = item.where;
  return difference;
}

void EntryJudge::add_plain(const HandItem& item, const Place& place, std::string kind, std::string sentence,
                           std::string confirmed) {
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
std::vector<Contribution> EntryJudge::contributions(const ScalarRow& row, std::size_t entry, Rational sign) const {
  std::vector<Contribution> sources;
  if (row.kind == RowKind::velocity) return sources;
  for (const Expr leaf : leaves_of(std::span(&row.C, 1))) {
    if (leaf->body < 0) continue;
    ScalarRow only;
    only.Cdot = time_derivative(row.C, joint_, {immovable_, leaf});
    only.J = isolate_velocities(only.Cdot, joint_);
    sources.push_back({leaf, sign * (entry == whole_row ? only.Cdot : columns_in_form(only.J)[entry])});
  }
  return sources;
}

std::optional<Difference> EntryJudge::compare_entry(const Part& part, const HandItem& item, int row, int column,
                                                    Expr hand, Expr generated) {
  if (equal(hand, generated)) return std::nullopt;
  Place place = place_of(part, item, row, column);
  const std::size_t r = static_cast<std::size_t>(row);
  if (item.kind != HandItem::Kind::claim && item.what == "J") {
    const std::vector<Expr> mine = columns_in_form(part.rows[r].J);
    for (int c = column % width(); c < static_cast<int>(mine.size()); c += width()) {
      if (c != column) place.elsewhere.push_back(mine[static_cast<std::size_t>(c)]);
    }
    place.sources = contributions(part.rows[r], static_cast<std::size_t>(column), Rational(part.sign[r]));
  }
  if (item.kind != HandItem::Kind::claim && item.what == "Cdot") {
    place.sources = contributions(part.rows[r], whole_row, Rational(part.sign[r]));
  }
  Difference d = describe_difference(place, hand, generated, poses());
  d.confirmed = confirmation(part, item, row, column, hand, generated);
  return finished(item, std::move(d), hand, generated);
}

std::string EntryJudge::confirmation(const Part& part, const HandItem& item, int row, int column, Expr hand,
                                     Expr generated) {
  if (item.kind == HandItem::Kind::claim) return confirm().claim(hand, generated);
  const std::size_t r = static_cast<std::size_t>(row), c = static_cast<std::size_t>(column);
  const ScalarRow& of = part.rows[r];
  const double sign = part.sign[r];
  if (item.what == "C") return confirm().value_of_C(of, poses_on_constraint(), generated, hand);
  if (item.what == "J") return confirm().entry_of_J(of, sign, c, generated, hand);
  if (item.what == "K") return confirm().entry_of_K(of, part.rows[c], sign * part.sign[c], generated, hand);
  return confirm().rate(of, item.what == "b" ? -sign : sign, generated, hand);
}

void EntryJudge::compare(const Part& part, const HandItem& item, const Matrix& hand, const Matrix& generated) {
  const bool claim = item.kind == HandItem::Kind::claim;
  if (hand.rows != generated.rows || hand.columns != generated.columns) {
    return compare_sizes(part, item, hand, generated);
  }
  Matrix expected = generated;
  for (int r = 0; r < hand.rows && !claim; ++r) {
    for (int c = 0; c < hand.columns; ++c) {
      int sign = part.sign[static_cast<std::size_t>(r)];
      if (item.what == "K") sign *= part.sign[static_cast<std::size_t>(c)];
      Expr& entry = expected.entries[static_cast<std::size_t>(r * hand.columns + c)];
      entry = Rational(item.what == "b" ? -sign : sign) * entry;
    }
  }
  for (const Group& rows : groups_of_rows(part, item, hand.rows)) {
    for (const Group& columns : groups_of_columns(part, item, hand.columns)) {
      std::vector<Difference> found;
      for (int r = rows.first; r < rows.first + rows.count; ++r) {
        for (int c = columns.first; c < columns.first + columns.count; ++c) {
          auto difference = compare_entry(part, item, r, c, hand.at(r, c), expected.at(r, c));
          if (difference) found.push_back(std::move(*difference));
        }
      }
      const auto block = [&](const Matrix& m) {
        return part_of(m, rows.first, rows.count, columns.first, columns.count);
      };
      report(std::move(found), rows.name, columns.name, block(hand), block(expected));
    }
  }
}

// One difference where the entries of a block have one in common; in the spec's own names.
void EntryJudge::report(std::vector<Difference> found, const std::string& row, const std::string& column,
                        const Matrix& hand, const Matrix& generated) {
  BlockPlace place{row, column, "", "", ""};
  if (found.size() > 1) {
    place.generated = text_of(generated, joint_);
    place.hand = text_of(hand, joint_);
    place.difference = text_of(difference_of(hand, generated, joint_), joint_);
  }
  for (Difference& d : merged(std::move(found), place)) {
    for (std::string Difference::*text :
         {&Difference::generated, &Difference::hand, &Difference::difference, &Difference::sentence}) {
      d.*text = in_names_of_spec(d.*text);
    }
    out_.differences.push_back(std::move(d));
  }
}

// In space the rows of one vector equation go together.
std::vector<EntryJudge::Group> EntryJudge::groups_of_rows(const Part& part, const HandItem& item, int rows) const {
  std::vector<Group> groups;
  const bool claim = item.kind == HandItem::Kind::claim, named = !part.hand->rows.empty();
  for (int r = 0; r < rows;) {
    int count = joint_.dimension == 3 && claim && rows == 3 ? 3 : 1;
    if (joint_.dimension == 3 && !claim) {
      const Row* row = part.rows[static_cast<std::size_t>(r)].row;
      while (row && r + count < rows && part.rows[static_cast<std::size_t>(r + count)].row == row) ++count;
    }
    std::string name = place_of(part, item, r, 0).row;
    if (count > 1 && named && !claim) name = part.rows[static_cast<std::size_t>(r)].row->name;
    else if (count > 1) name = fmt::format("{}-{}", r + 1, r + count);
    groups.push_back({r, count, name});
    r += count;
  }
  return groups;
}

// In space the columns of one velocity go together.
std::vector<EntryJudge::Group> EntryJudge::groups_of_columns(const Part& part, const HandItem& item,
                                                             int columns) const {
  const bool claim = item.kind == HandItem::Kind::claim;
  if (item.what == "K" && !claim) return groups_of_rows(part, item, columns);
  std::vector<Group> groups;
  const bool blocks = item.what == "J" && !claim && joint_.dimension == 3;
  for (int c = 0; c < columns;) {
    int count = 1;
    while (blocks && c + count < columns && block_of(c + count, width()) == block_of(c, width())) ++count;
    const std::string name = place_of(part, item, 0, c).column;
    groups.push_back({c, count, count == 1 ? name : name.substr(0, name.find('.'))});
    c += count;
  }
  return groups;
}

// Matrices of different sizes: turned, or with rows too many or too few.
void EntryJudge::compare_sizes(const Part& part, const HandItem& item, const Matrix& hand, const Matrix& generated) {
  Place place = place_of(part, item, 0, 0);
  place.row.clear();
  place.column.clear();
  const auto size = [](const Matrix& m) { return fmt::format("{} x {}", m.rows, m.columns); };
  const std::string sizes = fmt::format("{} numbers stand where {} belong", size(hand), size(generated));
  const std::string none = fmt::format("{} and {} numbers have no difference", size(hand), size(generated));
  if (hand.columns == generated.rows && hand.rows == generated.columns) {
    const bool right = further_rows(transposed(hand), generated, poses()).has_value();
    return add_plain(item, place, "transposed", sizes + ": it is transposed",
                     none + (right ? "; transposed, it agrees at 12 poses" : ""));
  }
  const bool more = hand.rows > generated.rows;
  const auto further = further_rows(more ? hand : generated, more ? generated : hand, poses());
  if (!further) {
    const Matrix &larger = more ? hand : generated, &smaller = more ? generated : hand;
    const std::string combined =
        larger.columns == smaller.columns ? confirm().row_space(poses_on_constraint(), larger, smaller) : "";
    return add_plain(item, place, more ? "extra term" : "missing term", sizes, none + combined);
  }
  std::string which, what;
  for (const int row : *further) {
    which += fmt::format("{}{}", which.empty() ? "" : ", ", row + 1);
    what += fmt::format("{}{}", what.empty() ? "" : "; ", row_text(more ? hand : generated, row));
  }
  place.row = which;
  if (more) {
    add_plain(item, place, "extra term", fmt::format("{}: this row ({}) does not belong", sizes, what),
              none + "; without that row both sides agree at 12 poses");
  } else {
    add_plain(item, place, "missing term", fmt::format("{}: this row ({}) is missing", sizes, what),
              none + "; the rows that are there agree at 12 poses");
  }
}

// A formula without a value: as it stands, and as its author may have meant it.
void EntryJudge::judge_problem(const Part& part, const HandItem& item) {
  Place place{item.what.empty() ? "update" : item.what, "", "", {}, {}, &joint_};
  if (part.rows.size() == 1 && item.kind == HandItem::Kind::quantity) place = place_of(part, item, 0, 0);
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
