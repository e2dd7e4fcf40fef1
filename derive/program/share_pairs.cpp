// The passes that share pairs of terms or of factors.
#include <string>

#include "derive/program/pair_table.hpp"
#include "derive/program/rewrite.hpp"

namespace cdot::derive {
namespace {

// The places of x and of y among the operands, if the operation contains the pair.
using Places = std::optional<std::pair<std::size_t, std::size_t>>;

Places terms_in(const Operation& op, const Pair& pair) {
  if (op.kind != OpKind::sum) return std::nullopt;
  const std::size_t x = index_of(op.args, pair.x), y = index_of(op.args, pair.y);
  if (x == op.args.size() || y == op.args.size() || op.coefs[y] / op.coefs[x] != pair.ratio) {
    return std::nullopt;
  }
  return std::pair(x, y);
}

// How often a product contains a pair of factors.
int times_in(const Operation& op, std::size_t x, std::size_t y) {
  return x == y ? op.exponents[x] / 2 : std::min(op.exponents[x], op.exponents[y]);
}

Places factors_in(const Operation& op, const Pair& pair) {
  if (op.kind != OpKind::product) return std::nullopt;
  const std::size_t x = index_of(op.args, pair.x), y = index_of(op.args, pair.y);
  if (x == op.args.size() || y == op.args.size() || times_in(op, x, y) == 0) return std::nullopt;
  return std::pair(x, y);
}

std::vector<int> users_of(const Graph& graph, const Pair& pair, Places (*find)(const Operation&, const Pair&)) {
  std::vector<int> users;
  const bool fewer = graph.users(pair.x).size() <= graph.users(pair.y).size();
  for (const int user : graph.users(fewer ? pair.x : pair.y)) {
    if (graph.is_needed(user) && find(graph.at(user), pair)) users.push_back(user);
  }
  return users;
}

// The name of x + ratio y in the spec, of several the first; empty if it has none.
SharedText name_of(const Graph& graph, const Pair& pair) {
  int named = -1;
  for (const int user : graph.users(pair.x)) {
    const Operation& op = graph.at(user);
    if (op.kind != OpKind::sum || op.args.size() != 2 || op.name.empty()) continue;
    const std::size_t x = index_of(op.args, pair.x), y = 1 - x;
    if (op.args[y] != pair.y || op.coefs[x] != Rational(1) || op.coefs[y] != pair.ratio) continue;
    if (named < 0 || graph.place(user) < graph.place(named)) named = user;
  }
  return named < 0 ? SharedText() : graph.at(named).name;
}

}  // namespace

// x + y once for all sums that contain it.
Passed share_terms(const Program& program, Effort& effort) {
  Graph graph(program, effort);
  PairTable pairs(graph, OpKind::sum, effort);
  for (std::optional<Pair> pair; !effort.spent() && (pair = pairs.most_frequent()); pairs.follow()) {
    const SharedText name = name_of(graph, *pair);
    graph.rewrite(users_of(graph, *pair, terms_in), [&](Graph& builder, const Operation& op) -> Made {
      const auto [x, y] = *terms_in(op, *pair);
      const auto mapped = [&](std::size_t i) { return builder.now(op.args[i]); };
      Summands terms{{builder.sum({{mapped(x), mapped(y)}, {Rational(1), pair->ratio}}, name)}, {op.coefs[x]}};
      for (std::size_t i = 0; i < op.args.size(); ++i) {
        if (i != x && i != y) terms.add(op.coefs[i], mapped(i));
      }
      return builder.sum(std::move(terms), op.name);
    });
  }
  return graph.result();
}

// x y once for all products that contain it.
Passed share_factors(const Program& program, Effort& effort) {
  Graph graph(program, effort);
  PairTable pairs(graph, OpKind::product, effort);
  for (std::optional<Pair> pair; !effort.spent() && (pair = pairs.most_frequent()); pairs.follow()) {
    graph.rewrite(users_of(graph, *pair, factors_in), [&](Graph& builder, const Operation& op) -> Made {
      const auto [x, y] = *factors_in(op, *pair);
      const int times = times_in(op, x, y);
      Operands exponents = op.exponents;
      exponents[x] -= times;
      exponents[y] -= times;
      const auto mapped = [&](std::size_t i) { return builder.now(op.args[i]); };
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
  return graph.result();
}

}  // namespace cdot::derive
