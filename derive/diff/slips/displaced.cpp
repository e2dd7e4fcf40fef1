// A term of J, or of an update, that stands in the columns of another body.
#include "derive/diff/slips/slips.hpp"
#include "derive/diff/terms.hpp"

namespace cdot::derive {
namespace {

// The columns of v, and those of w, of each body.
std::vector<Group> velocities_of(const Whole& whole) {
  const Joint& joint = whole.entry.joint;
  std::vector<Group> all;
  const auto add = [&](int first, int count) {
    const std::string name = column_name(joint, whole.entry.form, first);
    all.push_back({first, count, name.substr(0, name.find('.'))});
  };
  const int width = whole.entry.width();
  for (int first = 0; first < whole.mine.columns; first += width) {
    add(first, joint.dimension);
    add(first + joint.dimension, width - joint.dimension);
  }
  return all;
}

// Whether all differences are in these columns, where each term that the first lack is one that the others have more.
bool is_moved(const Whole& whole, const Group& from, const Group& to) {
  const auto is_in = [](const Group& g, int c) { return c >= g.first && c < g.first + g.count; };
  for (std::size_t i = 0; i < whole.published.size(); ++i)
    for (int r = 0; r < whole.mine.rows; ++r)
      for (int c = 0; c < whole.mine.columns; ++c) {
        const std::size_t at = whole.at(r, c);
        double belongs = whole.generated[i][at];
        if (is_in(from, c) || is_in(to, c)) {
          const std::size_t other = whole.at(r, is_in(from, c) ? c - from.first + to.first : c - to.first + from.first);
          belongs += whole.generated[i][other] - whole.published[i][other];
        }
        if (!alike(whole.published[i][at], belongs)) return false;
      }
  return !whole.published.empty();
}

// Whether in some expansion these entries lack terms of the other matrix, and have none that it lacks.
bool only_lack(const Whole& whole, const Matrix& in, const Matrix& other, const Group& columns) {
  const auto has_no_other = [&](Expr here, Expr there) {
    return std::ranges::any_of(all_openings, [&](Opened opened) {
      return leftover_terms(here, there, whole.entry.joint, opened).hand.empty();
    });
  };
  for (int r = 0; r < in.rows; ++r)
    for (int c = columns.first; c < columns.first + columns.count; ++c)
      if (!has_no_other(in.at(r, c), other.at(r, c))) return false;
  return true;
}

// The term, where it is a formula of one row; of a vector the formula without its component.
std::string words_of_term(const Whole& whole, const Group& to) {
  std::string words;
  for (int r = 0; r < whole.mine.rows; ++r) {
    std::vector<std::string> parts;
    for (int k = 0; k < to.count; ++k) {
      const Expr moved =
          difference_of(whole.hand.at(r, to.first + k), whole.mine.at(r, to.first + k), whole.entry.joint);
      parts.push_back(
          is_zero(moved) ? "" : without_component(brief_text(moved, whole.entry.joint), static_cast<std::size_t>(k)));
    }
    const bool zero = std::ranges::all_of(parts, [](const std::string& part) { return part.empty(); });
    if (zero) continue;
    const bool one = std::ranges::all_of(parts, [&](const std::string& part) { return part == parts[0]; });
    if (!one || !words.empty()) return "";
    words = parts[0];
  }
  return in_names_of_spec(words, whole.entry.joint);
}

}  // namespace

std::optional<Slip> slip_of_displacement(const Whole& whole) {
  if (!whole.by_velocities) return {};
  const std::vector<Group> all = velocities_of(whole);
  for (const Group& from : all)
    for (const Group& to : all) {
      const bool same_kind = from.count == to.count && (from.first - to.first) % whole.entry.width() == 0;
      if (from.first == to.first || !same_kind || !is_moved(whole, from, to)) continue;
      if (!only_lack(whole, whole.hand, whole.mine, from) || !only_lack(whole, whole.mine, whole.hand, to)) continue;
      const std::string term = words_of_term(whole, to);
      return Slip{"wrong body", fmt::format("{} in the columns of {}, but belong{} in those of {}",
                                            term.empty() ? "terms stand" : term + " stands", to.name,
                                            term.empty() ? "" : "s", from.name)};
    }
  return {};
}

}  // namespace cdot::derive
