// The sign of C is the author's choice, row by row. The chosen sign has the fewest differing entries of C, Cdot, J and
// b in the whole entry, and the fewest differing terms in them.
#include <algorithm>
#include <array>

#include "derive/diff/entry.hpp"
#include "derive/diff/terms.hpp"

namespace cdot::derive {
namespace {

struct Misfit {
  int blocks = 0;         // differing ones
  std::size_t terms = 0;  // differing ones in them
  friend auto operator<=>(const Misfit&, const Misfit&) = default;
};

// v or w of a body.
int block_of(const Entry& entry, int column) {
  return 2 * (column / entry.width()) + (column % entry.width() < entry.joint.dimension ? 0 : 1);
}

// Adds the misfit of one row of an item, if the row has this sign.
void add_misfit(Misfit& misfit, const Entry& entry, const Part& part, const HandItem& item, std::size_t row, int sign) {
  if (!item.value) return;
  const Generated& g = part.generated;
  const Matrix& mine = item.what == "C" ? g.C : item.what == "J" ? g.J : g.Cdot;
  if (item.value->rows != mine.rows || item.value->columns != mine.columns) return;
  const Rational factor(item.what == "b" ? -sign : sign);
  int block = -1;  // columns of v, or of w, of one body count as one
  for (int c = 0; c < mine.columns; ++c) {
    const Expr hand = item.value->at(static_cast<int>(row), c);
    const Expr generated = factor * mine.at(static_cast<int>(row), c);
    if (entry.poses().equal(hand, generated)) continue;
    const Leftover left = leftover_terms(hand, generated, entry.joint, Opened::everything);
    misfit.blocks += block_of(entry, c) == block ? 0 : 1;
    block = block_of(entry, c);
    misfit.terms += left.hand.size() + left.generated.size();
  }
}

// The rows of one vector equation have one sign: its C is the author's choice as a whole. Others are alone.
std::vector<std::size_t> first_of_equation(const std::vector<ScalarRow>& rows) {
  std::vector<std::size_t> first;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool joins = i > 0 && rows[i].row && rows[i].row == rows[i - 1].row;
    first.push_back(joins ? first.back() : i);
  }
  return first;
}

// From K alone: D K D with the D = diag(+-1) that fits best; the first equation's sign is free.
std::vector<int> signs_of_mass(const Entry& entry, const Part& part) {
  const Matrix& K = part.generated.K;
  const std::vector<std::size_t> first = first_of_equation(part.rows);
  int best = -1;
  std::vector<int> kept = part.sign;
  for (unsigned pattern = 0; pattern < (1u << part.rows.size()); pattern += 2) {
    std::vector<int> sign;
    bool together = true;
    for (std::size_t i = 0; i < part.rows.size(); ++i) {
      sign.push_back((pattern >> i) & 1 ? -1 : 1);
      together = together && sign[i] == sign[first[i]];
    }
    if (!together) continue;
    int agreed = 0;
    for (const HandItem& item : part.hand->items) {
      if (item.kind != HandItem::Kind::quantity || item.what != "K" || !item.value) continue;
      if (item.value->rows != K.rows || item.value->columns != K.columns) continue;
      for (int i = 0; i < K.rows; ++i) {
        for (int j = 0; j < K.columns; ++j) {
          const Rational s(sign[static_cast<std::size_t>(i)] * sign[static_cast<std::size_t>(j)]);
          agreed += entry.poses().equal(item.value->at(i, j), s * K.at(i, j)) ? 1 : 0;
        }
      }
    }
    if (agreed > best) best = agreed, kept = sign;
  }
  return kept;
}

}  // namespace

void find_signs(const Entry& entry, std::vector<Part>& parts) {
  // By the first row of an equation, with the sign 1 and -1; several parts may have a row.
  std::map<std::string, std::array<Misfit, 2>> evidence;
  for (const Part& part : parts) {
    const std::vector<std::size_t> first = first_of_equation(part.rows);
    for (std::size_t row = 0; row < part.rows.size(); ++row) {
      for (const HandItem& item : part.hand->items) {
        if (item.kind != HandItem::Kind::quantity || item.what == "K") continue;
        auto& [plus, minus] = evidence[part.rows[first[row]].name];
        add_misfit(plus, entry, part, item, row, 1);
        add_misfit(minus, entry, part, item, row, -1);
      }
    }
  }
  for (Part& part : parts) {
    bool any = false;
    for (const std::size_t first : first_of_equation(part.rows)) {
      const auto found = evidence.find(part.rows[first].name);
      any = any || found != evidence.end();
      part.sign.push_back(found != evidence.end() && found->second[1] < found->second[0] ? -1 : 1);
    }
    if (!any) part.sign = signs_of_mass(entry, part);
  }
}

// Of which equations C has the opposite sign, and the consequence.
std::string remark_on_signs(const std::vector<Part>& parts) {
  std::string opposite;
  bool all = true;
  for (const Part& part : parts) {
    for (std::size_t i = 0; i < part.rows.size(); ++i) {
      const bool turned = part.sign[i] < 0;
      all = all && turned;
      const std::string& name = part.rows[i].row ? part.rows[i].row->name : part.rows[i].name;
      if (turned && opposite.find("`" + name + "`") == opposite.npos)
        opposite += (opposite.empty() ? "`" : ", `") + name + "`";
    }
  }
  if (opposite.empty()) return "";
  return all ? "C has the opposite sign: J changes its sign, K does not"
             : "C of " + opposite +
                   " has the opposite sign: its rows of J change their sign, and K between it and others";
}

}  // namespace cdot::derive
