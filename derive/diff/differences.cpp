// The differences of two matrices. In space one mistake in vectors changes many numbers: they are reported as one.
#include <algorithm>
#include <fmt/format.h>
#include <regex>

#include "derive/diff/entry.hpp"
#include "derive/diff/terms.hpp"

namespace cdot::derive {
namespace {

using Differences = std::vector<Difference>;

// A sentence is "place: reason".
std::string reason_of(const Difference& d) { return d.sentence.substr(d.sentence.find(": ") + 2); }

template <class Text>
bool all_same(const Differences& entries, Text text) {
  for (std::size_t i = 1; i < entries.size(); ++i) {
    if (text(entries[i], i) != text(entries[0], 0)) return false;
  }
  return true;
}

std::string condition_of(const Difference& d) {
  const std::size_t at = d.sentence.find("equal where ");
  return at == std::string::npos ? "" : d.sentence.substr(at);
}

void set_reason(Difference& d, const std::string& reason) {
  std::string place = d.sentence.substr(0, std::min(d.sentence.find(","), d.sentence.find(": ")));  // "J", "claim on C"
  if (!d.row.empty()) place += (d.row.find_first_of("-,") == d.row.npos ? ", row " : ", rows ") + d.row;
  const bool numbers = d.column.find_first_not_of("0123456789-") == d.column.npos;
  const bool several = d.column.find('-') != d.column.npos;
  if (!d.column.empty()) place += (!numbers ? ", " : several ? ", columns " : ", column ") + d.column;
  d.sentence = place + ": " + reason;
}

// "K, row 1, column 2: ..." as "K, row 1, column 2, and row 2, column 1: ...".
void add_mirror(Difference& d) {
  const auto place = [](const std::string& row, const std::string& column) {
    const auto is_several = [](const std::string& s) { return s.find_first_of("-,") != s.npos; };
    return fmt::format("{} {}, {} {}", is_several(row) ? "rows" : "row", row, is_several(column) ? "columns" : "column",
                       column);
  };
  d.sentence = fmt::format("{}, {}, and {}: {}", d.what, place(d.row, d.column), place(d.column, d.row), reason_of(d));
}

// "[a, b ; c, d]": the texts of `entry(row, column)` in a block.
template <class Entry>
std::string text_of(const Group& rows, const Group& columns, const Joint& joint, Entry entry) {
  std::string s;
  for (int r = 0; r < rows.count; ++r) {
    s += r == 0 ? "[" : " ; ";
    for (int c = 0; c < columns.count; ++c) {
      s += (c == 0 ? "" : ", ") + brief_text(entry(rows.first + r, columns.first + c), joint);
    }
  }
  return s + "]";
}

bool is_transposed(const Sides& sides, const Group& rows, const Group& columns, const Poses& poses) {
  if (rows.count != columns.count) return false;
  for (int r = 0; r < rows.count; ++r)
    for (int c = 0; c < rows.count; ++c)
      if (!poses.equal(sides.published.at(rows.first + r, columns.first + c),
                       sides.generated.at(rows.first + c, columns.first + r)))
        return false;
  return true;
}

// Merges the differences within a block into one, if one reason fits them all. Each is of one entry; their order is
// that of vector components.
Differences merged(Differences entries, const Sides& sides, const Group& rows, const Group& columns, const Joint& joint,
                   const Poses& poses) {
  if (entries.size() < 2) return entries;
  Difference one = entries[0];
  one.row = rows.name;
  one.column = columns.name;
  std::string Difference::*const formulas[] = {&Difference::hand, &Difference::generated, &Difference::difference};
  const bool kinds = all_same(entries, [](const Difference& d, std::size_t) { return d.kind; });
  const auto vector_formulas = [&](const Difference& d, std::size_t i) {
    std::string all = without_component(reason_of(d), i);
    for (std::string Difference::*formula : formulas) all += "\n" + without_component(d.*formula, i);
    return all;
  };
  if (kinds && entries.size() == static_cast<std::size_t>(joint.dimension) && all_same(entries, vector_formulas)) {
    set_reason(one, without_component(reason_of(entries[0]), 0));
    for (std::string Difference::*formula : formulas) one.*formula = without_component(one.*formula, 0);
    return {one};
  }
  const bool same_reason = all_same(entries, [](const Difference& d, std::size_t) { return reason_of(d); });
  const bool unexplained = !same_reason || reason_of(entries[0]).starts_with(not_generated);
  if (unexplained && is_transposed(sides, rows, columns, poses)) {
    one.kind = "transposed";
    set_reason(one, "the block is transposed");
    return {one};
  }
  if (kinds && same_reason) {
    const Matrix &published = sides.published, &generated = sides.generated;
    set_reason(one, reason_of(entries[0]));
    one.generated = text_of(rows, columns, joint, [&](int r, int c) { return generated.at(r, c); });
    one.hand = text_of(rows, columns, joint, [&](int r, int c) { return published.at(r, c); });
    one.difference = text_of(rows, columns, joint, [&](int r, int c) {
      return difference_of(published.at(r, c), generated.at(r, c), joint);
    });
    return {one};
  }
  const std::string condition = condition_of(entries[0]);
  const bool same_condition = all_same(entries, [](const Difference& d, std::size_t) { return condition_of(d); });
  constexpr std::size_t most_told = 4;  // one by one
  if (entries.size() > most_told && (condition.empty() || !same_condition)) {
    one.kind = "factor";
    set_reason(one, fmt::format("{}: {} entries differ (the first is shown)", not_generated, entries.size()));
    return {one};
  }
  if (!kinds || condition.empty() || !same_condition) return entries;
  set_reason(one, fmt::format("{} entries of it are {} (the first is shown)", entries.size(), condition));
  return {one};
}

}  // namespace

std::string without_component(const std::string& text, std::size_t i) {
  const std::string axis = std::string(".") + "xyz"[i];
  if (text.find(axis) == text.npos || text.find("world" + axis) != text.npos) return text;
  return std::regex_replace(text, std::regex("\\" + axis + "\\b"), "");
}

Difference finished(Entry& entry, const HandItem& item, Difference difference, Expr published, Expr generated) {
  if (difference.kind != "sign" && difference.kind != "wrong body") {
    const std::string hidden =
        hidden_assumption(entry.joint, entry.poses_on_constraint(), published, generated, entry.poses());
    if (!hidden.empty()) difference.sentence += fmt::format("; equal where {}", hidden);
    const bool unsaid = item.kind == HandItem::Kind::claim || hidden == "C = 0";
    if (!hidden.empty() && unsaid) difference.kind = "undeclared assumption";
  }
  difference.what = item.kind == HandItem::Kind::update ? "update" : item.what;
  difference.where = item.where;
  return difference;
}

void add_plain(Entry& entry, const HandItem& item, const Place& place, std::string kind, const std::string& sentence,
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
  entry.verdict.differences.push_back(std::move(d));
}

void add_slip(Entry& entry, const HandItem& item, const Place& place, const Slip& slip, std::string confirmed) {
  add_plain(entry, item, place, slip.kind, slip.sentence, std::move(confirmed));
  Difference& added = entry.verdict.differences.back();
  added.generated = slip.generated;
  added.difference = slip.difference;
  if (!slip.published.empty()) added.hand = slip.published;
}

namespace {

// True if both sides have, in these columns, the opposite of what they have in the others.
bool are_opposite(Entry& entry, const Sides& sides, const Group& rows, const Group& one, const Group& other) {
  if (one.count != other.count) return false;
  for (int r = rows.first; r < rows.first + rows.count; ++r)
    for (int k = 0; k < one.count; ++k)
      for (const Matrix* of : {&sides.published, &sides.generated})
        if (!entry.equal(of->at(r, one.first + k), -of->at(r, other.first + k))) return false;
  return true;
}

// The differences within a block of rows and columns, marked in `wrong`.
Differences of_block(Entry& entry, const Sides& sides, const Group& rows, const Group& columns,
                     const std::function<Difference(int, int)>& difference, std::vector<bool>& wrong) {
  Differences found;
  bool mirrored = false;
  for (int r = rows.first; r < rows.first + rows.count; ++r) {
    for (int c = columns.first; c < columns.first + columns.count; ++c) {
      if (entry.equal(sides.published.at(r, c), sides.generated.at(r, c))) continue;
      wrong[static_cast<std::size_t>(r * sides.generated.columns + c)] = true;
      const bool twice = sides.symmetric && r != c && entry.equal(sides.published.at(r, c), sides.published.at(c, r));
      mirrored = mirrored || twice;
      if (!twice || r < c) found.push_back(difference(r, c));
    }
  }
  found = merged(std::move(found), sides, rows, columns, entry.joint, entry.poses());
  for (Difference& d : found) {
    if (mirrored && rows.first != columns.first) add_mirror(d);
    for (std::string* text : {&d.generated, &d.hand, &d.difference, &d.sentence})
      *text = in_names_of_spec(*text, entry.joint);
  }
  return found;
}

}  // namespace

std::vector<Difference> differences_of(Entry& entry, const Sides& sides,
                                       const std::function<Difference(int, int)>& difference,
                                       std::vector<bool>& wrong) {
  std::vector<Difference> all;
  for (const Group& rows : sides.rows) {
    std::vector<std::pair<const Group*, std::size_t>> told;  // columns, and their only difference
    for (const Group& columns : sides.columns) {
      Differences found = of_block(entry, sides, rows, columns, difference, wrong);
      const auto opposite = std::ranges::find_if(told, [&](const auto& before) {
        return sides.opposites && found.size() == 1 && are_opposite(entry, sides, rows, columns, *before.first);
      });
      if (opposite != told.end()) {
        Difference& before = all[opposite->second];
        const std::size_t end = before.sentence.find(": ");
        before.sentence.insert(end, fmt::format("{}{}", and_opposite, columns.name));
        continue;
      }
      if (found.size() == 1) told.emplace_back(&columns, all.size());
      std::move(found.begin(), found.end(), std::back_inserter(all));
    }
  }
  return all;
}

void merge_diagonal(Entry& entry, std::size_t from) {
  std::vector<Difference>& all = entry.verdict.differences;
  for (std::size_t i = from; i < all.size(); ++i) {
    std::vector<std::string> rows = {all[i].row};
    const std::string reason = reason_of(all[i]);
    if (all[i].row != all[i].column) continue;
    for (std::size_t j = all.size(); --j > i;) {
      if (all[j].row != all[j].column || reason_of(all[j]) != reason) continue;
      rows.insert(rows.begin() + 1, all[j].row);
      all.erase(all.begin() + static_cast<std::ptrdiff_t>(j));
    }
    if (rows.size() > 1)
      all[i].sentence = fmt::format("{}, rows {} of the diagonal: {}", all[i].what, listed(rows), reason);
  }
}

void compare(Entry& entry, const Sides& sides, const std::function<Difference(int, int)>& difference) {
  std::vector<bool> wrong(sides.generated.entries.size());
  for (Difference& d : differences_of(entry, sides, difference, wrong))
    entry.verdict.differences.push_back(std::move(d));
  show(entry, sides, wrong);
}

}  // namespace cdot::derive
