#include "tests/derive/program/full_rebuild.hpp"

#include <algorithm>
#include <numeric>
#include <set>
#include <string>
#include <tuple>

namespace cdot::derive {
namespace {

// Two operands that occur together: a term pair x + ratio y (up to a common factor), or a factor pair x y.
struct PlainPair {
  int x = 0, y = 0;
  Rational ratio;

  friend bool operator==(const PlainPair&, const PlainPair&) = default;
};
using PlainPairs = std::vector<PlainPair>;

void add_term_pairs(const Program& program, const Operation& op, PlainPairs& pairs) {
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

void add_factor_pairs(const Program&, const Operation& op, PlainPairs& pairs) {
  if (op.kind != OpKind::product) return;
  for (std::size_t i = 0; i < op.args.size(); ++i) {
    // x^4 = (x^2)^2 has the pair x x twice, x^2 y^2 = (x y)^2 the pair x y.
    for (int k = op.exponents[i]; k > 1; k -= 2) pairs.push_back({op.args[i], op.args[i], Rational(1)});
    for (std::size_t j = i + 1; j < op.args.size(); ++j) {
      const PlainPair pair{std::min(op.args[i], op.args[j]), std::max(op.args[i], op.args[j]), Rational(1)};
      pairs.insert(pairs.end(), static_cast<std::size_t>(std::min(op.exponents[i], op.exponents[j])), pair);
    }
  }
}

using PairFinder = void (*)(const Program&, const Operation&, PlainPairs&);

// The pair that occurs in most operations, if in more than one; of equals the first whose occurrences are complete.
std::optional<PlainPair> most_frequent_pair(const Program& program, PairFinder add_pairs) {
  const std::vector<int> uses = use_counts(program);
  PlainPairs pairs;
  for (std::size_t i = 0; i < program.ops.size(); ++i) {
    if (uses[i] > 0) add_pairs(program, program.ops[i], pairs);
  }
  std::vector<std::size_t> alike(pairs.size());  // equal pairs side by side, each in order of occurrence
  std::iota(alike.begin(), alike.end(), std::size_t{0});
  std::ranges::sort(alike, {}, [&](std::size_t i) {
    const PlainPair& p = pairs[i];
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
std::string name_of(const Program& program, const PlainPair& pair) {
  for (const Operation& op : program.ops) {
    if (op.kind != OpKind::sum || op.args.size() != 2 || op.name.empty()) continue;
    const std::size_t x = index_of(op.args, pair.x), y = 1 - x;
    if (x < 2 && op.args[y] == pair.y && op.coefs[x] == Rational(1) && op.coefs[y] == pair.ratio) return op.name;
  }
  return {};
}

// x + y once for all sums that contain it.
std::optional<Program> share_a_term_pair(const Program& program) {
  const std::optional<PlainPair> pair = most_frequent_pair(program, add_term_pairs);
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
std::optional<Program> share_a_factor_pair(const Program& program) {
  const std::optional<PlainPair> pair = most_frequent_pair(program, add_factor_pairs);
  if (!pair) return std::nullopt;
  return rewritten(program, [&](ProgramBuilder& builder, const Operation& op, int, const Moved& at) -> Made {
    if (op.kind != OpKind::product) return std::nullopt;
    Operands exponents = op.exponents;
    const std::size_t x = index_of(op.args, pair->x), y = index_of(op.args, pair->y);
    if (x == op.args.size() || y == op.args.size()) return std::nullopt;
    const int times = x == y ? exponents[x] / 2 : std::min(exponents[x], exponents[y]);
    if (times == 0) return std::nullopt;
    exponents[x] -= times;
    exponents[y] -= times;
    const auto mapped = [&](std::size_t i) { return at(op.args[i]); };
    Operands args{builder.product({mapped(x), mapped(y)}, {1, 1})};
    Operands powers{times};
    for (std::size_t i = 0; i < op.args.size(); ++i) {
      if (exponents[i] == 0) continue;
      args.push_back(mapped(i));
      powers.push_back(exponents[i]);
    }
    return builder.product(std::move(args), std::move(powers), op.name);
  });
}

// Terms of `sum` from which `factor` can be taken without computing anything twice.
std::vector<std::size_t> terms_with(const Program& program, const Operation& sum, int factor,
                                    const std::vector<int>& uses) {
  std::vector<std::size_t> terms;
  for (std::size_t i = 0; i < sum.args.size(); ++i) {
    const Operation& term = program.at(sum.args[i]);
    const bool own = uses[static_cast<std::size_t>(sum.args[i])] == 1;
    const bool contains = term.kind == OpKind::product && own && index_of(term.args, factor) < term.args.size();
    if (sum.args[i] == factor || contains) terms.push_back(i);
  }
  return terms;
}

struct Factoring {
  int sum = 0, factor = 0;
  std::vector<std::size_t> terms;
};

std::optional<Factoring> best_factoring(const Program& program) {
  const std::vector<int> uses = use_counts(program);
  std::optional<Factoring> best;
  for (std::size_t s = 0; s < program.ops.size(); ++s) {
    const Operation& sum = program.ops[s];
    if (uses[s] == 0 || sum.kind != OpKind::sum) continue;
    std::set<int> factors;
    for (const int arg : sum.args) {
      const Operation& term = program.at(arg);
      if (term.kind == OpKind::product) factors.insert(term.args.begin(), term.args.end());
    }
    for (const int factor : factors) {
      std::vector<std::size_t> terms = terms_with(program, sum, factor, uses);
      if (terms.size() >= 2 && (!best || terms.size() > best->terms.size())) {
        best = Factoring{static_cast<int>(s), factor, std::move(terms)};
      }
    }
  }
  return best;
}

// a x + b x = x (a + b)
std::optional<Program> take_out_a_factor(const Program& program) {
  const std::optional<Factoring> f = best_factoring(program);
  if (!f) return std::nullopt;
  return rewritten(program, [&](ProgramBuilder& builder, const Operation& op, int index, const Moved& at) -> Made {
    if (index != f->sum) return std::nullopt;
    Summands inner, outer;
    for (std::size_t i = 0; i < op.args.size(); ++i) {
      if (std::find(f->terms.begin(), f->terms.end(), i) == f->terms.end()) {
        outer.add(op.coefs[i], at(op.args[i]));
        continue;
      }
      const Operation& term = program.at(op.args[i]);
      Operands args, exponents;
      if (op.args[i] != f->factor) {
        for (std::size_t k = 0; k < term.args.size(); ++k) {
          const int left = term.exponents[k] - (term.args[k] == f->factor ? 1 : 0);
          if (left == 0) continue;
          args.push_back(at(term.args[k]));
          exponents.push_back(left);
        }
      }
      inner.add(op.coefs[i], builder.product(std::move(args), std::move(exponents)));
    }
    const int rest = builder.sum(std::move(inner));
    outer.add(Rational(1), builder.product({at(f->factor), rest}, {1, 1}));
    return builder.sum(std::move(outer), op.name);
  });
}

Program exhausted(Program program, std::optional<Program> (*pass)(const Program&)) {
  while (std::optional<Program> next = pass(program)) program = std::move(*next);
  return program;
}

}  // namespace

Program plainly_shared_terms(Program program) { return exhausted(std::move(program), share_a_term_pair); }
Program plainly_shared_factors(Program program) { return exhausted(std::move(program), share_a_factor_pair); }
Program plainly_taken_out(Program program) { return exhausted(std::move(program), take_out_a_factor); }

Program needed(const Program& program) {
  return rewritten(program, [](ProgramBuilder&, const Operation&, int, const Moved&) -> Made { return std::nullopt; });
}

}  // namespace cdot::derive
