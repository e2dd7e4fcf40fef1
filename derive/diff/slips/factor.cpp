// All of a matrix, or one of its rows, times one factor: a number, or a power of a name.
#include "derive/diff/slips/slips.hpp"
#include "derive/diff/terms.hpp"

namespace cdot::derive {
namespace {

constexpr double too_small = 1e-3;  // to divide by
constexpr const char* right_if_C_is = ", which is right only with a C scaled alike";

// Some of a matrix: rows and columns, the ends not included.
struct Region {
  int row, row_end, column, column_end;
  bool has(int r, int c) const { return r >= row && r < row_end && c >= column && c < column_end; }
};

template <class At>
void each_entry(const Whole& whole, At at) {
  for (std::size_t i = 0; i < whole.published.size(); ++i)
    for (int r = 0; r < whole.mine.rows; ++r)
      for (int c = 0; c < whole.mine.columns; ++c)
        at(i, r, c, whole.published[i][whole.at(r, c)], whole.generated[i][whole.at(r, c)]);
}

// Published over generated in this region, pose by pose; empty if that is not one number, or if the rest is wrong.
List ratios(const Whole& whole, const Region& region) {
  List all(whole.published.size(), std::nan(""));
  each_entry(whole, [&](std::size_t i, int r, int c, double hand, double mine) {
    if (region.has(r, c) && std::isnan(all[i]) && std::abs(mine) > too_small) all[i] = hand / mine;
  });
  bool same = true;
  each_entry(whole, [&](std::size_t i, int r, int c, double hand, double mine) {
    same = same && alike(hand, (region.has(r, c) ? all[i] : 1) * mine);
  });
  return same ? all : List{};
}

struct Factor {
  Expr value;
  std::string name;
};

// Powers of the numbers that the entry or the spec names, and of the lengths of named vectors; before them 1.
std::vector<Factor> likely_factors(const Whole& whole) {
  std::vector<Factor> bases;
  const auto add = [&](Expr e, const std::string& name) {
    const Expr base = e->vector ? norm(e) : e;
    const bool known = std::ranges::any_of(bases, [&](const Factor& f) { return f.value == base; });
    if (base->kind != Kind::number && !known) bases.push_back({base, e->vector ? fmt::format("norm({})", name) : name});
  };
  for (const Parameter& p : whole.entry.joint.parameters)
    if (p.kind == ParameterKind::scalar) add(p.symbol, p.name);
  for (const Expr e : whole.hand.entries)
    for (const Expr symbol : free_symbols(e)) add(symbol, symbol->symbol);
  for (const Matrix* of : {&whole.hand, &whole.mine})
    for (const Expr node : topological(of->entries))
      if (!node->name.empty() && !node->unit_length && !is_tensor(node)) add(node, node->name);
  std::vector<Factor> factors = {{whole.entry.pool().number(1), ""}};
  for (const auto& [base, name] : bases)
    factors.insert(factors.end(), {{base, name},
                                   {pow(base, -1), "1/" + name},
                                   {pow(base, 2), name + "^2"},
                                   {pow(base, -2), fmt::format("1/{}^2", name)}});
  return factors;
}

// The factor with these values at the poses, in words; empty if none of the likely ones has them.
std::string factor_with(const List& values, const Whole& whole) {
  if (values.empty()) return "";
  for (const auto& [factor, name] : likely_factors(whole)) {
    std::optional<double> k;
    bool same = true;
    for (std::size_t i = 0; same && i < values.size(); ++i) {
      const double unit = values_at({factor}, whole.samples()[i])[0];
      if (!k) k = values[i] / unit;
      same = std::isfinite(*k) && alike(*k, values[i] / unit);
    }
    if (!same) continue;
    const std::string number = fmt::format("{:.6g}", *k);
    return name.empty() ? number : alike(*k, 1) ? name : alike(*k, -1) ? "-" + name : number + "*" + name;
  }
  return "";
}

// 1/ratio in place of ratio, in a row that is scaled otherwise: the ratio stands at the other body.
std::optional<Slip> reciprocal(const Whole& whole) {
  for (const Parameter& p : whole.entry.joint.parameters) {
    if (p.kind != ParameterKind::scalar || p.unit != Unit{}) continue;
    const Matrix mine{whole.mine.rows, whole.mine.columns,
                      Whole::substituted(whole.mine, {{&*p.symbol, pow(p.symbol, -1)}})};
    const Whole other(whole.entry, whole.part, whole.what, whole.hand, mine);
    if (!factor_with(ratios(other, {0, mine.rows, 0, mine.columns}), other).empty())
      return Slip{"factor", fmt::format("{0} stands where 1/{0} belongs, at the other body", p.name)};
  }
  return {};
}

}  // namespace

std::optional<Slip> slip_of_scale(const Whole& whole) {
  const bool scales = whole.part && whole.what != "C" && whole.what != "K" && whole.what != "update";
  std::string all = factor_with(ratios(whole, {0, whole.mine.rows, 0, whole.mine.columns}), whole);
  if (whole.what == "J" && all.starts_with('-')) all.erase(0, 1);  // of either sign
  if (all.empty()) return {};
  if (all == "0") return Slip{"missing term", "only zeros stand here"};
  return Slip{"factor", fmt::format("all of it is {} times what it should be{}", all, scales ? right_if_C_is : "")};
}

std::optional<Slip> slip_of_factor(const Whole& whole) {
  const int rows = whole.mine.rows, columns = whole.mine.columns;
  for (int r = 0; r < rows && whole.what != "K"; ++r) {
    const std::string k = factor_with(ratios(whole, {r, r + 1, 0, columns}), whole);
    if (k == "0") return Slip{"missing term", fmt::format("only zeros stand in row {}", whole.row_name(r))};
    if (k == "-1")
      return Slip{"sign", fmt::format("row {} has the wrong sign: the rows of one vector equation change it together",
                                      whole.row_name(r))};
    if (!k.empty()) return Slip{"factor", fmt::format("row {} is {} times what it should be", whole.row_name(r), k)};
  }
  const int width = whole.entry.width();
  for (int b = 0; whole.by_velocities && b * width < columns; ++b) {
    const std::string k = factor_with(ratios(whole, {0, rows, b * width, (b + 1) * width}), whole);
    const std::string& body = whole.entry.joint.bodies[static_cast<std::size_t>(b)];
    if (k == "0") return Slip{"missing term", fmt::format("only zeros stand in the columns of {}", body)};
    if (k.starts_with("1/"))
      return Slip{"factor", fmt::format("the factor {} is missing in the columns of {}", k.substr(2), body)};
    if (!k.empty()) return Slip{"factor", fmt::format("the columns of {} are {} times what they should be", body, k)};
  }
  return reciprocal(whole);
}

}  // namespace cdot::derive
