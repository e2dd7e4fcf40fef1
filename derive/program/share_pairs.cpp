// The passes that share pairs of terms or of factors.
#include <algorithm>
#include <map>
#include <string>
#include <tuple>

#include "derive/program/rewrite.hpp"

namespace cdot::derive {
namespace {

// Two operands that occur together: a term pair x + ratio y (up to a common factor), or a factor pair x y.
struct Pair {
  int x = 0, y = 0;
  Rational ratio;
};

std::vector<Pair> term_pairs(const Program& program, const Operation& op) {
  std::vector<Pair> pairs;
  if (op.kind != OpKind::sum) return pairs;
  for (std::size_t i = 0; i < op.args.size(); ++i) {
    for (std::size_t j = i + 1; j < op.args.size(); ++j) {
      // The difference of two positions cancels what is large in both: neither is ever paired with anything else.
      const bool first = program.ops[static_cast<std::size_t>(op.args[i])].is_position;
      const bool second = program.ops[static_cast<std::size_t>(op.args[j])].is_position;
      if (first != second && op.args.size() > 2) continue;
      const bool swap = op.args[i] > op.args[j];
      const std::size_t x = swap ? j : i, y = swap ? i : j;
      pairs.push_back({op.args[x], op.args[y], op.coefs[y] / op.coefs[x]});
    }
  }
  return pairs;
}

std::vector<Pair> factor_pairs(const Program&, const Operation& op) {
  std::vector<Pair> pairs;
  if (op.kind != OpKind::product) return pairs;
  for (std::size_t i = 0; i < op.args.size(); ++i) {
    if (op.exponents[i] > 1) pairs.push_back({op.args[i], op.args[i], Rational(1)});
    for (std::size_t j = i + 1; j < op.args.size(); ++j) {
      pairs.push_back({std::min(op.args[i], op.args[j]), std::max(op.args[i], op.args[j]), Rational(1)});
    }
  }
  return pairs;
}

using PairFinder = std::vector<Pair> (*)(const Program&, const Operation&);

// The pair that occurs in most operations, if in more than one; the first such.
std::optional<Pair> most_frequent(const Program& program, PairFinder pairs_of) {
  const std::vector<int> uses = use_counts(program);
  const auto less = [](const Pair& a, const Pair& b) {
    return std::tie(a.x, a.y, a.ratio) < std::tie(b.x, b.y, b.ratio);
  };
  std::map<Pair, int, decltype(less)> seen(less);
  std::optional<Pair> best;
  int best_count = 1;
  for (std::size_t i = 0; i < program.ops.size(); ++i) {
    if (uses[i] == 0) continue;
    for (const Pair& pair : pairs_of(program, program.ops[i])) {
      const int n = ++seen[pair];
      if (n > best_count) best_count = n, best = pair;
    }
  }
  return best;
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
  const std::optional<Pair> pair = most_frequent(program, term_pairs);
  if (!pair) return std::nullopt;
  const std::string name = name_of(program, *pair);
  return rewritten(
      program,
      [&](ProgramBuilder& builder, const Operation& op, int, const std::vector<int>& at) -> std::optional<int> {
        if (op.kind != OpKind::sum) return std::nullopt;
        const std::size_t x = index_of(op.args, pair->x), y = index_of(op.args, pair->y);
        if (x == op.args.size() || y == op.args.size() || op.coefs[y] / op.coefs[x] != pair->ratio) {
          return std::nullopt;
        }
        const auto mapped = [&](std::size_t i) { return at[static_cast<std::size_t>(op.args[i])]; };
        std::vector<int> args{builder.sum({mapped(x), mapped(y)}, {Rational(1), pair->ratio}, name)};
        std::vector<Rational> coefs{op.coefs[x]};
        for (std::size_t i = 0; i < op.args.size(); ++i) {
          if (i == x || i == y) continue;
          args.push_back(mapped(i));
          coefs.push_back(op.coefs[i]);
        }
        return builder.sum(std::move(args), std::move(coefs), op.name);
      });
}

// x y once for all products that contain it.
std::optional<Program> share_factors(const Program& program) {
  const std::optional<Pair> pair = most_frequent(program, factor_pairs);
  if (!pair) return std::nullopt;
  return rewritten(
      program,
      [&](ProgramBuilder& builder, const Operation& op, int, const std::vector<int>& at) -> std::optional<int> {
        if (op.kind != OpKind::product) return std::nullopt;
        std::vector<int> exponents = op.exponents;
        const std::size_t x = index_of(op.args, pair->x), y = index_of(op.args, pair->y);
        if (x == op.args.size() || y == op.args.size()) return std::nullopt;
        const int times = x == y ? exponents[x] / 2 : std::min(exponents[x], exponents[y]);
        if (times == 0) return std::nullopt;
        exponents[x] -= times;
        exponents[y] -= times;
        const auto mapped = [&](std::size_t i) { return at[static_cast<std::size_t>(op.args[i])]; };
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
