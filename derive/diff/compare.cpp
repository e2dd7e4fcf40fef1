// Published C, Cdot, J, K and claims against the generated ones, entry by entry of their matrices.
#include <algorithm>
#include <fmt/format.h>

#include "derive/diff/entry.hpp"

namespace cdot::derive {
namespace {

// Groups neighbours. `joins(i)` is true if i belongs to the group of i - 1.
template <class Joins, class Name>
std::vector<Group> grouped(int count, Joins joins, Name name) {
  std::vector<Group> groups;
  for (int i = 0; i < count; ++i) {
    if (i > 0 && joins(i)) ++groups.back().count;
    else groups.push_back({i, 1, ""});
  }
  for (Group& group : groups) group.name = name(group);
  return groups;
}

// In space the rows of one vector equation form a group.
std::vector<Group> groups_of_rows(const Entry& entry, const Part& part, int count) {
  const auto row_of = [&](int r) { return part.rows[static_cast<std::size_t>(r)].row; };
  return grouped(
      count, [&](int r) { return entry.joint.dimension == 3 && row_of(r) && row_of(r) == row_of(r - 1); },
      [&](const Group& g) {
        if (g.count == 1) return name_of_row(part, g.first);
        return part.hand->rows.empty() ? fmt::format("{}-{}", g.first + 1, g.first + g.count) : row_of(g.first)->name;
      });
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

// The rows of `larger` that `smaller` lacks, if the others are those of `smaller`, in order.
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

// Matrices of different sizes: transposed, or with missing or extra rows.
void compare_sizes(Entry& entry, const HandItem& item, const std::string& what, const Matrix& hand,
                   const Matrix& generated) {
  show_apart(entry, what, item, &hand, &generated);
  Place place{what, "", "", {}, {}, &entry.joint};
  const auto size = [](const Matrix& m) { return fmt::format("{} x {}", m.rows, m.columns); };
  const std::string sizes = fmt::format("{} numbers stand where {} belong", size(hand), size(generated));
  const std::string none = fmt::format("{} and {} numbers have no difference", size(hand), size(generated));
  if (hand.columns == generated.rows && hand.rows == generated.columns) {
    const bool right = further_rows(transposed(hand), generated, entry.poses()).has_value();
    return add_plain(entry, item, place, "transposed", sizes + ": it is transposed",
                     none + (right ? "; transposed, it agrees at 12 poses" : ""));
  }
  const bool more = hand.rows > generated.rows;
  const Matrix &larger = more ? hand : generated, &smaller = more ? generated : hand;
  const std::string kind = more ? "extra term" : "missing term";
  const auto further = further_rows(larger, smaller, entry.poses());
  if (!further) {
    const std::string combined = larger.columns == smaller.columns
                                     ? entry.confirm().row_space(entry.poses_on_constraint(), larger, smaller)
                                     : "";
    return add_plain(entry, item, place, kind, sizes, none + combined);
  }
  std::string texts;
  for (const int row : *further) {
    place.row += fmt::format("{}{}", place.row.empty() ? "" : ", ", row + 1);
    texts += fmt::format("{}{}", texts.empty() ? "" : "; ", row_text(larger, row));
  }
  add_plain(entry, item, place, kind,
            fmt::format("{}: this row ({}) {}", sizes, texts, more ? "does not belong" : "is missing"),
            none + (more ? "; without that row both sides agree at 12 poses"
                         : "; the rows that are there agree at 12 poses"));
}

namespace {

// Each leaf of C that moves with a body, and the term of the product rule that it brings into `quantity`, which picks
// an entry of J or all of Cdot.
template <class Quantity>
std::vector<Contribution> contributions(const Entry& entry, const ScalarRow& row, Expr scale, Quantity quantity) {
  std::vector<Contribution> sources;
  if (row.kind == RowKind::velocity) return sources;
  for (const Expr leaf : leaves_of(std::span(&row.C, 1))) {
    if (leaf->body < 0) continue;
    ScalarRow only;
    only.Cdot = time_derivative(row.C, entry.joint, {entry.immovable, leaf});
    only.J = isolate_velocities(only.Cdot, entry.joint);
    sources.push_back({leaf, scaled(scale, quantity(only))});
  }
  return sources;
}

// Replaces the differences from `before` on by one slip that explains them all, if there are several, if it is the
// inverse or the frame of a mass, or if the only one has no words. `confirm(row, column)` shows by numbers that an
// entry is wrong.
template <class Confirmed>
void tell_slip(Entry& entry, const Part* part, const HandItem& item, std::size_t before, const Sides& sides,
               Confirmed confirm) {
  std::vector<Difference>& differences = entry.verdict.differences;
  const std::size_t told = differences.size() - before;
  const std::string what = part ? item.what : "claim on " + item.what;
  if (told == 0) return;
  const auto says = [&](const char* words) { return differences[before].sentence.find(words) != std::string::npos; };
  const bool without_words = says(not_generated) || (says(and_opposite) && differences[before].kind == "factor");
  if (told == 1 && item.what != "K" && part && !without_words) return;
  const std::string on_C = fmt::format("{}; equal where C = 0", not_generated);
  const bool all_on_C = std::all_of(differences.begin() + static_cast<std::ptrdiff_t>(before), differences.end(),
                                    [](const Difference& d) { return d.kind == "undeclared assumption"; });
  const std::optional<Slip> slip = part && told > 1 && all_on_C ? Slip{"undeclared assumption", on_C}
                                                                : slip_of_whole(entry, part, part ? item.what : "claim",
                                                                                sides.published, sides.generated);
  if (!slip || (told == 1 && part && slip->kind != "inverse" && slip->kind != "frame" && !without_words)) return;
  differences.erase(differences.begin() + static_cast<std::ptrdiff_t>(before), differences.end());
  int wrong = 0;
  const auto index = [](int i) { return static_cast<std::size_t>(i); };
  while (entry.equal(sides.published.entries[index(wrong)], sides.generated.entries[index(wrong)])) ++wrong;
  add_slip(entry, item, {what, "", "", {}, {}, &entry.joint}, *slip,
           confirm(wrong / sides.generated.columns, wrong % sides.generated.columns));
}

// A published quantity beside the generated one, in the source's signs and scales of C.
struct Quantity {
  Entry& entry;
  const Part& part;
  const HandItem& item;

  // `describe` completes the place of an entry; `confirm` shows by numbers that the published entry is wrong.
  template <class Scale, class Describe, class Confirmed>
  void compare(Matrix generated, const std::vector<Group>& columns, Scale scale_of, Describe describe,
               Confirmed confirm) const {
    const Matrix& published = *item.value;
    if (published.rows != generated.rows || published.columns != generated.columns)
      return compare_sizes(entry, item, item.what, published, generated);
    for (int r = 0; r < generated.rows; ++r) {
      for (int c = 0; c < generated.columns; ++c) {
        Expr& e = generated.entries[static_cast<std::size_t>(r * generated.columns + c)];
        e = scaled(scale_of(r, c), e);
      }
    }
    const std::size_t before = entry.verdict.differences.size();
    const Sides sides{item.what, published,        generated,       groups_of_rows(entry, part, generated.rows),
                      columns,   item.what == "K", item.what == "J"};
    derive::compare(entry, sides, [&](int r, int c) {
      Place place{item.what, name_of_row(part, r), "", {}, {}, &entry.joint};
      describe(place, r, c);
      const Expr hand = entry.as_assumed(published.at(r, c)), right = entry.as_assumed(generated.at(r, c));
      Difference d = describe_difference(place, hand, right, entry.poses());
      d.confirmed = confirm(r, c, right, hand);
      return finished(entry, item, std::move(d), hand, right);
    });
    tell_slip(entry, &part, item, before, sides,
              [&](int r, int c) { return confirm(r, c, generated.at(r, c), published.at(r, c)); });
    if (item.what == "K") merge_diagonal(entry, before);
  }

  Expr scale(int r) const { return part.scale[static_cast<std::size_t>(r)]; }
  const ScalarRow& row(int r) const { return part.rows[static_cast<std::size_t>(r)]; }
};

const std::vector<Group> one_column = {Group{}};

}  // namespace

std::string column_name(const Joint& joint, Form form, int column, bool positions) {
  const int width = static_cast<int>(joint.dimension == 2 ? columns_per_body(2) : columns_per_body(form));
  const std::string& body = joint.bodies[static_cast<std::size_t>(column / width)];
  const int k = column % width, turn = k - joint.dimension;
  if (turn < 0) return fmt::format("{}_{}.{}", positions ? "x" : "v", body, "xyz"[k]);
  if (form == Form::euler) return fmt::format("edot_{}.{}", body, turn);
  const std::string turning = fmt::format("{}_{}", positions ? "angle" : form == Form::local ? "w'" : "w", body);
  return joint.dimension == 2 ? turning : fmt::format("{}.{}", turning, "xyz"[turn]);
}

std::string name_of_row(const Part& part, int row) {
  return part.hand->rows.empty() ? std::to_string(row + 1) : part.rows[static_cast<std::size_t>(row)].name;
}

std::vector<Group> groups_of_velocities(const Joint& joint, Form form, int columns, bool positions) {
  const auto name = [&](int column) { return column_name(joint, form, column, positions); };
  const auto velocity = [&](int column) { return name(column).substr(0, name(column).find('.')); };
  return grouped(
      columns, [&](int c) { return joint.dimension == 3 && velocity(c) == velocity(c - 1); },
      [&](const Group& g) { return g.count == 1 ? name(g.first) : velocity(g.first); });
}

void judge_C(Entry& entry, const Part& part, const HandItem& item) {
  const Quantity C{entry, part, item};
  C.compare(
      part.generated.C, one_column, [&](int r, int) { return part.scale_of_C[static_cast<std::size_t>(r)]; },
      [](Place&, int, int) {},
      [&](int r, int, Expr generated, Expr published) {
        return entry.confirm().value_of_C(C.row(r), entry.poses_on_constraint(), generated, published);
      });
}

void judge_Cdot(Entry& entry, const Part& part, const HandItem& item) {
  const Quantity Cdot{entry, part, item};
  const auto scale = [&](int r, int) { return item.what == "b" ? -Cdot.scale(r) : Cdot.scale(r); };
  const auto describe = [&](Place& place, int r, int) {
    if (item.what == "b") return;
    place.sources = contributions(entry, Cdot.row(r), Cdot.scale(r), [](const ScalarRow& row) { return row.Cdot; });
  };
  const Matrix generated_rates = without_baumgarte(entry, part, item, part.generated.Cdot);
  Cdot.compare(generated_rates, one_column, scale, describe, [&](int r, int c, Expr generated, Expr published) {
    const auto rate = [&](const Sample& sample) {
      return values_at({scale(r, c)}, sample)[0] * entry.confirm().rate(Cdot.row(r), sample);
    };
    return entry.confirm().against(rate, generated, published);
  });
}

void judge_J(Entry& entry, const Part& part, const HandItem& item) {
  const Quantity J{entry, part, item};
  const auto describe = [&](Place& place, int r, int c) {
    place.column = column_name(entry.joint, entry.form, c);
    const std::vector<Expr> mine = entry.columns_in_form(J.row(r).J);
    for (int other = c % entry.width(); other < static_cast<int>(mine.size()); other += entry.width()) {
      if (other != c) place.elsewhere.push_back(mine[static_cast<std::size_t>(other)]);
    }
    place.sources = contributions(entry, J.row(r), J.scale(r), [&](const ScalarRow& row) {
      return entry.columns_in_form(row.J)[static_cast<std::size_t>(c)];
    });
  };
  J.compare(
      part.generated.J, groups_of_velocities(entry.joint, entry.form, part.generated.J.columns),
      [&](int r, int) { return J.scale(r); }, describe,
      [&](int r, int c, Expr generated, Expr published) {
        const Confirm confirm = entry.confirm();
        const auto slope = [&](const Sample& sample) {
          return values_at({J.scale(r)}, sample)[0] * confirm.columns(J.row(r), sample)[static_cast<std::size_t>(c)];
        };
        return confirm.against(slope, generated, published);
      });
  if (item.value->columns == part.generated.J.columns) judge_momentum(entry, part, *item.value);
}

void judge_K(Entry& entry, const Part& part, const HandItem& item) {
  const Quantity K{entry, part, item};
  const auto scale = [&](int r, int c) { return K.scale(r) * K.scale(c); };
  K.compare(
      without_softness(entry, part, item, part.generated.K), groups_of_rows(entry, part, part.generated.K.columns),
      scale, [&](Place& place, int, int c) { place.column = name_of_row(part, c); },
      [&](int r, int c, Expr generated, Expr published) {
        const Confirm confirm = entry.confirm();
        const auto mass = [&](const Sample& sample) {
          return values_at({scale(r, c)}, sample)[0] * confirm.mass(K.row(r), K.row(c), sample);
        };
        return confirm.against(mass, generated, published);
      });
}

// The left side of a claim counts as published, its right side as generated.
void judge_claim(Entry& entry, const HandItem& item) {
  const Matrix &left = *item.value, &right = *item.right;
  const std::string what = "claim on " + item.what;
  if (left.rows != right.rows || left.columns != right.columns) return compare_sizes(entry, item, what, left, right);
  const auto number = [](const Group& g) { return std::to_string(g.first + 1); };
  const auto row_name = [&](const Group& g) {
    if (g.count > 1) return fmt::format("{}-{}", g.first + 1, g.first + g.count);
    return left.entries.size() == 1 ? "" : number(g);
  };
  const bool vector = entry.joint.dimension == 3 && left.rows == 3;
  const Sides sides{
      what, left, right,
      grouped(
          left.rows, [&](int) { return vector; }, row_name),
      grouped(
          left.columns, [](int) { return false; }, [&](const Group& g) { return left.columns > 1 ? number(g) : ""; })};
  const std::size_t before = entry.verdict.differences.size();
  compare(entry, sides, [&](int r, int c) {
    const Place place{what, row_name({r, 1, ""}), left.columns > 1 ? std::to_string(c + 1) : "", {}, {}, &entry.joint};
    const Expr claimed = entry.as_assumed(left.at(r, c)), correct = entry.as_assumed(right.at(r, c));
    Difference d = describe_difference(place, claimed, correct, entry.poses());
    d.confirmed = entry.confirm().claim(claimed, correct);
    return finished(entry, item, std::move(d), claimed, correct);
  });
  tell_slip(entry, nullptr, item, before, sides,
            [&](int r, int c) { return entry.confirm().claim(left.at(r, c), right.at(r, c)); });
}

// Judges a formula without a value, also in other readings that its author may have meant.
void judge_problem(Entry& entry, const Part& part, const HandItem& item) {
  Place place{item.what.empty() ? "update" : item.what, "", "", {}, {}, &entry.joint};
  if (part.rows.size() == 1 && item.kind == HandItem::Kind::quantity) {
    place.row = name_of_row(part, 0);
    if (item.what == "J") place.column = column_name(entry.joint, entry.form, 0);
    if (item.what == "K") place.column = place.row;
  }
  const bool quantity = item.kind == HandItem::Kind::quantity;
  Matrix right = generated_of(part, item);
  for (Expr& e : right.entries) e = item.what == "b" ? -e : e;
  show_apart(entry, place.what, item, nullptr, quantity ? &right : nullptr);
  std::string sentence = item.problem, confirmed = "no value: " + item.problem;
  const Matrix& Cdot = part.generated.Cdot;
  const bool rate = item.what == "Cdot" || item.what == "b";
  for (const HandReading& reading : item.readings) {
    if (!rate || reading.value.entries.size() != 1 || Cdot.entries.size() != 1) continue;
    const Expr value = reading.value.entries[0];
    const int sign = entry.equal(value, Cdot.entries[0]) ? 1 : entry.equal(value, -Cdot.entries[0]) ? -1 : 0;
    if (sign == 0) continue;
    place.column = reading.column;
    sentence += fmt::format("; {} it is right", reading.words);
    confirmed = entry.confirm().reading(reading.words, part.rows[0], sign, value);
    break;
  }
  add_plain(entry, item, place, "factor", sentence, std::move(confirmed));
}

}  // namespace cdot::derive
