// Rows, columns or bodies in another order.
#include "derive/diff/slips/slips.hpp"

namespace cdot::derive {
namespace {

constexpr int most_ordered = 6;  // whose orders are tried

// The generated matrix with its rows and columns in another order.
List reordered(const Whole& whole, const List& from, const Order* rows, const Order* columns) {
  List to;
  for (int r = 0; r < whole.mine.rows; ++r)
    for (int c = 0; c < whole.mine.columns; ++c)
      to.push_back(from[whole.at(rows ? (*rows)[static_cast<std::size_t>(r)] : r,
                                 columns ? (*columns)[static_cast<std::size_t>(c)] : c)]);
  return to;
}

std::optional<Slip> other_rows(const Whole& whole) {
  std::optional<Slip> found;
  if (whole.mine.rows < 2 || whole.mine.rows > most_ordered) return found;
  std::vector<std::string> names;
  for (int r = 0; r < whole.mine.rows; ++r) names.push_back(whole.row_name(r));
  any_order(whole.mine.rows, [&](const Order& order) {
    const Order* const columns = whole.what == "K" ? &order : nullptr;
    if (!whole.is([&](std::size_t i) { return reordered(whole, whole.generated[i], &order, columns); })) return false;
    found = Slip{"order", words_of(order, whole.what == "K" ? "rows and columns" : "rows", names)};
    return true;
  });
  return found;
}

// Bodies in another order; of each body, w before v.
std::optional<Slip> other_columns(const Whole& whole) {
  if (!whole.by_velocities) return {};
  const int bodies = static_cast<int>(whole.entry.joint.bodies.size()), width = whole.entry.width();
  const auto matches = [&](auto column) {
    Order columns;
    for (int c = 0; c < whole.mine.columns; ++c) columns.push_back(column(c / width, c % width));
    return whole.is([&](std::size_t i) { return reordered(whole, whole.generated[i], nullptr, &columns); });
  };
  std::optional<Slip> found;
  any_order(bodies, [&](const Order& order) {
    if (!matches([&](int b, int k) { return order[static_cast<std::size_t>(b)] * width + k; })) return false;
    found = Slip{"order", words_of(order, "the columns of", whole.entry.joint.bodies)};
    return true;
  });
  if (found) return found;
  const int turns = width - whole.entry.joint.dimension;
  if (matches([&](int b, int k) { return b * width + (k < turns ? whole.entry.joint.dimension + k : k - turns); }))
    found = Slip{"order", "the columns of w stand before those of v"};
  return found;
}

}  // namespace

std::optional<Slip> slip_of_order(const Whole& whole) { return first_of({other_rows, other_columns}, whole); }

}  // namespace cdot::derive
