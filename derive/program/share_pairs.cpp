// The passes that share pairs of terms or of factors.
#include <algorithm>
#include <numeric>
#include <string>
#include <tuple>

#include "derive/program/rewrite.hpp"

namespace cdot::derive {
namespace {

// Two operands that occur together: a term pair x + ratio y (up to a common factor), or a factor pair x y.
struct Pair {
  int x = 0, y = 0;
  Rational ratio;

  friend bool operator==(const Pair&, const Pair&) = default;
};
using Pairs = std::vector<Pair>;

void add_term_pairs(const Program& program, const Operation& op, Pairs& pairs) {
  if (op.kind != OpKind::sum) return;
  for (std::size_t i = 0; i < op.args.size(); ++i) {
    for (std::size_t j = i + 1; j < op.args.size(); ++j) {
      // The difference of two positions cancels what is large in both: neither is ever paired with anything else.
      const bool first = program.at(op.args[i]).is_position;
      const bool second = program.at(op.args[j]).is_position;
      if (first != second && op.args.size() > 2) continue;
      const bool swap = op.args[i] > op.args[j];
      const std::size_t x = swap ? j : i, y = swap ? i : j;
      pairs.push_back({op.args[x], op.args[y], op.coefs[y] / op.coefs[x]});
    }
  }
}

void add_factor_pairs(const Program&, const Operation& op, Pairs& pairs) {
  if (op.kind != OpKind::product) return;
  for (std::size_t i = 0; i < op.args.size(); ++i) {
    // x^4 = (x^2)^2 has the pair x x twice, x^2 y^2 = (x y)^2 the pair x y.
    for (int k = op.exponents[i]; k > 1; k -= 2) pairs.push_back({op.args[i], op.args[i], Rational(1)});
    for (std::size_t j = i + 1; j < op.args.size(); ++j) {
      const Pair pair{std::min(op.args[i], op.args[j]), std::max(op.args[i], op.args[j]), Rational(1)};
      pairs.insert(pairs.end(), static_cast<std::size_t>(std::min(op.exponents[i], op.exponents[j])), pair);
    }
  }
}

using PairFinder = void (*)(const Program&, const Operation&, Pairs&);

// The pair that occurs in most operations, if in more than one; of equals the first whose occurrences are complete.
std::optional<Pair> most_frequent(const Program& program, PairFinder add_pairs) {
  const std::vector<int> uses = use_counts(program);
  Pairs pairs;
  for (std::size_t i = 0; i < program.ops.size(); ++i) {
    if (uses[i] > 0) add_pairs(program, program.ops[i], pairs);
  }
  std::vector<std::size_t> alike(pairs.size());  // equal pairs side by side, each in order of occurrence
  std::iota(alike.begin(), alike.end(), std::size_t{0});
  std::ranges::sort(alike, {}, [&](std::size_t i) {
    const Pair& p = pairs[i];
    return std::tuple(p.x, p.y, p.ratio.num(), p.ratio.den(), i);
  });
  const auto rank = [&](std::size_t i) {  // of equals, numbers last: they can be taken out later
    return std::pair(program.at(pairs[i].x).kind == OpKind::factor || program.at(pairs[i].y).kind == OpKind::factor, i);
  };
  std::size_t best = 0, best_count = 1;
  for (std::size_t i = 0, count = 0; i < alike.size(); ++i) {
    count = i > 0 && pairs[alike[i]] == pairs[alike[i - 1]] ? count + 1 : 1;
    if (count > best_count || (count > 1 && count == best_count && rank(alike[i]) < rank(best)))
      best_count = count, best = alike[i];
  }
  return best_count > 1 ? std::optional(pairs[best]) : std::nullopt;
}

// The name of x + ratio y in the spec; empty if it has none.
std::string name_of(const Program& program, const Pair& pair) {
  for (const Operation& op : program.ops) {
    if (op.kind != OpKind::sum || op.args.size() != 2 || op.name.empty()) continue;
    const std::size_t x = index_of(op.args, pair.x), y = 1 - x;
    if (x < 2 && op.args[y] == pair.y && op.coefs[x] == Rational(1) && op.coefs[y] == pair.ratio) return op.name;
  }
  return {};
}

}  // namespace

// x + y once for all sums that contain it.
std::optional<Program> share_terms(const Program& program) {
  const std::optional<Pair> pair = most_frequent(program, add_term_pairs);
  if (!pair) return std::nullopt;
  const std::string name = name_of(program, *pair);
  return rewritten(program, [&](ProgramBuilder& builder, const Operation& op, int, const Moved& at) -> Made {
    if (op.kind != OpKind::sum) return std::nullopt;
    const std::size_t x = index_of(op.args, pair->x), y = index_of(op.args, pair->y);
    if (x == op.args.size() || y == op.args.size() || op.coefs[y] / op.coefs[x] != pair->ratio) {
      return std::nullopt;
    }
    const auto mapped = [&](std::size_t i) { return at(op.args[i]); };
    Summands terms{{builder.sum({{mapped(x), mapped(y)}, {Rational(1), pair->ratio}}, name)}, {op.coefs[x]}};
    for (std::size_t i = 0; i < op.args.size(); ++i) {
      if (i != x && i != y) terms.add(op.coefs[i], mapped(i));
    }
    return builder.sum(std::move(terms), op.name);
  });
}

// x y once for all products that contain it.
std::optional<Program> share_factors(const Program& program) {
  const std::optional<Pair> pair = most_frequent(program, add_factor_pairs);
  if (!pair) return std::nullopt;
  return rewritten(program, [&](ProgramBuilder& builder, const Operation& op, int, const Moved& at) -> Made {
    if (op.kind != OpKind::product) return std::nullopt;
    std::vector<int> exponents = op.exponents;
    const std::size_t x = index_of(op.args, pair->x), y = index_of(op.args, pair->y);
    if (x == op.args.size() || y == op.args.size()) return std::nullopt;
    const int times = x == y ? exponents[x] / 2 : std::min(exponents[x], exponents[y]);
    if (times == 0) return std::nullopt;
    exponents[x] -= times;
    exponents[y] -= times;
    const auto mapped = [&](std::size_t i) { return at(op.args[i]); };
    std::vector<int> args{builder.product({mapped(x), mapped(y)}, {1, 1})};
    std::vector<int> powers{times};
    for (std::size_t i = 0; i < op.args.size(); ++i) {
      if (exponents[i] == 0) continue;
      args.push_back(mapped(i));
      powers.push_back(exponents[i]);
    }
    return builder.product(std::move(args), std::move(powers), op.name);
  });
}

}  // namespace cdot::derive
