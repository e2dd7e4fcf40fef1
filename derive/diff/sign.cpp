// The sign of C is the author's choice, row by row: the one is taken with which the fewest entries
// of C, Cdot, J and b differ over the whole entry, and in them the fewest terms.
#include <algorithm>

#include "derive/diff/entry.hpp"
#include "derive/diff/terms.hpp"

namespace cdot::derive {

int EntryJudge::block_of(int column, int width) const {
  return 2 * (column / width) + (column % width < joint_.dimension ? 0 : 1);
}

// How badly one row of an item fits if the row is counted with this sign.
EntryJudge::Misfit EntryJudge::misfit(const Part& part, const HandItem& item, std::size_t row, int sign) const {
  Misfit misfit;
  if (item.kind != HandItem::Kind::quantity || !item.value || item.what == "K") return misfit;
  const Generated& g = part.generated;
  const Matrix& mine = item.what == "C" ? g.C : item.what == "J" ? g.J : g.Cdot;
  if (item.value->rows != mine.rows || item.value->columns != mine.columns) return misfit;
  const Rational factor(item.what == "b" ? -sign : sign);
  int block = -1;  // columns of v, or of w, of one body count as one
  for (int c = 0; c < mine.columns; ++c) {
    const Expr hand = item.value->at(static_cast<int>(row), c);
    const Expr generated = factor * mine.at(static_cast<int>(row), c);
    if (poses().equal(hand, generated)) continue;
    const Leftover left = leftover_terms(hand, generated, joint_, Opened::everything);
    misfit.blocks += block_of(c, width()) == block ? 0 : 1;
    block = block_of(c, width());
    misfit.terms += left.hand.size() + left.generated.size();
  }
  return misfit;
}

void EntryJudge::find_signs(std::vector<Part>& parts) {
  struct Evidence {
    Misfit plus, minus;
    bool any = false;
  };
  std::map<std::string, Evidence> evidence;  // by row: a row may occur in several parts
  const auto add = [](Misfit& total, const Misfit& more) {
    total.blocks += more.blocks;
    total.terms += more.terms;
  };
  for (const Part& part : parts) {
    for (std::size_t row = 0; row < part.rows.size(); ++row) {
      Evidence& e = evidence[part.rows[row].name];
      for (const HandItem& item : part.hand->items) {
        add(e.plus, misfit(part, item, row, 1));
        add(e.minus, misfit(part, item, row, -1));
        e.any = e.any || (item.kind == HandItem::Kind::quantity && item.what != "K");
      }
    }
  }
  for (Part& part : parts) {
    bool any = false;
    for (std::size_t row = 0; row < part.rows.size(); ++row) {
      const Evidence& e = evidence.at(part.rows[row].name);
      const bool turned = std::pair(e.minus.blocks, e.minus.terms) < std::pair(e.plus.blocks, e.plus.terms);
      part.sign.push_back(turned ? -1 : 1);
      any = any || e.any;
    }
    if (!any) part.sign = signs_of_mass(part);
  }
}

// From K alone: D K D with the D = diag(+-1) that fits best; the first row's sign is free.
std::vector<int> EntryJudge::signs_of_mass(const Part& part) const {
  const Matrix& K = part.generated.K;
  int best = -1;
  std::vector<int> kept = part.sign;
  for (unsigned pattern = 0; pattern < (1u << part.rows.size()); pattern += 2) {
    std::vector<int> sign;
    for (std::size_t i = 0; i < part.rows.size(); ++i) sign.push_back((pattern >> i) & 1 ? -1 : 1);
    int agreed = 0;
    for (const HandItem& item : part.hand->items) {
      if (item.kind != HandItem::Kind::quantity || item.what != "K" || !item.value) continue;
      if (item.value->rows != K.rows || item.value->columns != K.columns) continue;
      for (int i = 0; i < K.rows; ++i) {
        for (int j = 0; j < K.columns; ++j) {
          const Rational s(sign[static_cast<std::size_t>(i)] * sign[static_cast<std::size_t>(j)]);
          agreed += poses().equal(item.value->at(i, j), s * K.at(i, j)) ? 1 : 0;
        }
      }
    }
    if (agreed > best) best = agreed, kept = sign;
  }
  return kept;
}

}  // namespace cdot::derive
