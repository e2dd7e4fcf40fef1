// The order of rows is the author's choice as well, if C, Cdot, b or J show it and all quantities of the part follow
// it.
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <numeric>

#include "derive/diff/entry.hpp"

namespace cdot::derive {
namespace {

constexpr int most_rows = 6;

bool of_rows(const HandItem& item) { return item.what != "K"; }

// The quantities of the part, if all have a value of the right size.
std::vector<const HandItem*> quantities(const Part& part) {
  std::vector<const HandItem*> all;
  for (const HandItem& item : part.hand->items) {
    if (item.kind != HandItem::Kind::quantity) continue;
    if (!item.value) return {};
    const Matrix& mine = generated_of(part, item);
    if (item.value->rows != mine.rows || item.value->columns != mine.columns) return {};
    all.push_back(&item);
  }
  return all;
}

class Orders {
 public:
  Orders(const Entry& entry, const Part& part) : entry_(entry), part_(part), items_(quantities(part)) {}

  // Rows of the spec in the order of the source; empty if there is none but the spec's.
  std::vector<int> find() {
    const int n = static_cast<int>(part_.rows.size());
    if (n < 2 || n > most_rows ||
        std::none_of(items_.begin(), items_.end(), [](const HandItem* i) { return of_rows(*i); }))
      return {};
    if (fits_from(0, true)) return {};
    order_.clear();
    return fits_from(0, false) ? order_ : std::vector<int>{};
  }

 private:
  // The sign with which the source's row i is the spec's row j in all of C, Cdot, b and J; 0 if there is none.
  int sign_of(int i, int j) {
    const auto known = signs_.find({i, j});
    if (known != signs_.end()) return known->second;
    int sign = 0;
    for (const int s : {1, -1}) {
      bool all = true;
      for (const HandItem* item : items_) {
        if (!of_rows(*item)) continue;
        const Matrix& mine = generated_of(part_, *item);
        const Rational factor(item->what == "b" ? -s : s);
        for (int c = 0; all && c < mine.columns; ++c)
          all = entry_.poses().equal(item->value->at(i, c), factor * mine.at(j, c));
      }
      if (all && sign == 0) sign = s;
    }
    return signs_[{i, j}] = sign;
  }

  // K between the rows found so far and the last one.
  bool mass_fits() {
    const int i = static_cast<int>(order_.size()) - 1;
    for (const HandItem* item : items_) {
      if (of_rows(*item)) continue;
      for (int k = 0; k <= i; ++k) {
        const Rational s(sign_of(i, order_.back()) * sign_of(k, order_[static_cast<std::size_t>(k)]));
        const Expr mine = s * part_.generated.K.at(order_.back(), order_[static_cast<std::size_t>(k)]);
        if (!entry_.poses().equal(item->value->at(i, k), mine) || !entry_.poses().equal(item->value->at(k, i), mine))
          return false;
      }
    }
    return true;
  }

  // Completes `order_` from row i on; `as_it_is`: in the spec's order alone.
  bool fits_from(int i, bool as_it_is) {
    const int n = static_cast<int>(part_.rows.size());
    if (i == n) return true;
    for (int j = as_it_is ? i : 0; j < (as_it_is ? i + 1 : n); ++j) {
      if (std::find(order_.begin(), order_.end(), j) != order_.end() || sign_of(i, j) == 0) continue;
      order_.push_back(j);
      if (mass_fits() && fits_from(i + 1, as_it_is)) return true;
      order_.pop_back();
    }
    return false;
  }

  const Entry& entry_;
  const Part& part_;
  std::vector<const HandItem*> items_;
  std::vector<int> order_;
  std::map<std::pair<int, int>, int> signs_;
};

}  // namespace

std::vector<ScalarRow> rows_in_order_of(const Entry& entry, const Part& part) {
  std::vector<ScalarRow> rows;
  for (const int row : Orders(entry, part).find()) rows.push_back(part.rows[static_cast<std::size_t>(row)]);
  return rows;
}

}  // namespace cdot::derive
