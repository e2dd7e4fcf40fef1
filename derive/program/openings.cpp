// Products and numbers opened: costlier by themselves, but from there the search may find a cheaper program.
#include <algorithm>
#include <map>
#include <set>

#include "derive/program/rewrite.hpp"

namespace cdot::derive {
namespace {

// The factor of a product that is a sum of its own, say s in k s = k x + k y; none: the number of factors.
std::size_t sum_among(const Program& program, const Operation& product, const std::vector<int>& uses) {
  std::size_t i = 0;
  for (; product.kind == OpKind::product && i < product.args.size(); ++i) {
    const Operation& sum = program.at(product.args[i]);
    const bool own =
        sum.kind == OpKind::sum && sum.name.empty() && uses[static_cast<std::size_t>(product.args[i])] == 1;
    const auto is_position = [&](int arg) { return program.at(arg).is_position; };
    if (own && product.exponents[i] == 1 && std::ranges::none_of(sum.args, is_position)) return i;
  }
  return product.args.size();
}

// The operands whose squares are terms of a sum, or of a sum in it.
std::set<int> squares_in(const Program& program, const Operation& sum) {
  std::set<int> squares;
  for (const int arg : sum.args) {
    const Operation& term = program.at(arg);
    if (term.kind == OpKind::sum) squares.merge(squares_in(program, term));
    if (term.kind == OpKind::product && term.args.size() == 1 && term.exponents[0] == 2) squares.insert(term.args[0]);
  }
  return squares;
}

// The factor of a product that is a sum with one of these in each term; none: the number of factors.
std::size_t sum_with(const std::set<int>& wanted, const Program& program, const Operation& product) {
  const auto has = [&](int arg) {
    const Operation& term = program.at(arg);
    return term.kind == OpKind::product && std::ranges::any_of(term.args, [&](int f) { return wanted.contains(f); });
  };
  std::size_t i = 0;
  for (; product.kind == OpKind::product && i < product.args.size(); ++i) {
    const Operation& sum = program.at(product.args[i]);
    if (sum.kind == OpKind::sum && product.exponents[i] <= 2 && std::ranges::all_of(sum.args, has)) return i;
  }
  return product.args.size();
}

// Products to open: by which factor, and beside which squares. Sums of a single user among the terms lose their names,
// for flattening.
struct Opening {
  std::size_t factor;
  std::set<int> squares;
};
struct Openings {
  std::map<int, Opening> products;
  std::set<int> unnamed;
};

Openings beside_squares(const Program& program) {
  const std::vector<int> uses = use_counts(program);
  Openings found;
  for (std::size_t s = 0; s < program.ops.size(); ++s) {
    const Operation& sum = program.ops[s];
    if (uses[s] == 0 || sum.kind != OpKind::sum) continue;
    const std::set<int> squares = squares_in(program, sum);
    for (const int arg : sum.args) {
      if (squares.empty() || uses[static_cast<std::size_t>(arg)] > 1) continue;
      const Operation& term = program.at(arg);
      const std::size_t factor = sum_with(squares, program, term);
      if (term.kind == OpKind::sum) found.unnamed.insert(arg);
      if (term.kind == OpKind::product && factor < term.args.size())
        found.products.emplace(arg, Opening{factor, squares});
    }
  }
  return found;
}

// k (t_x u_x) as (t_x k) u_x: a gradient has t_x k as well.
int opened_term(ProgramBuilder& builder, const Operation& product, const Operation& term, const Opening& opening,
                const Moved& at) {
  Operands args, powers;
  int square = -1;
  const auto add = [&](int arg, int power) {
    if (power > 0) args.push_back(at(arg)), powers.push_back(power);
  };
  for (std::size_t f = 0; f < term.args.size(); ++f) {
    const bool taken = square < 0 && opening.squares.contains(term.args[f]);
    if (taken) square = at(term.args[f]);
    add(term.args[f], term.exponents[f] - (taken ? 1 : 0));
  }
  for (std::size_t f = 0; f < product.args.size(); ++f)
    add(product.args[f], product.exponents[f] - (f == opening.factor ? 1 : 0));
  return builder.product({builder.product(std::move(args), std::move(powers)), square}, {1, 1});
}

// 2 x, but not -x.
bool costs_a_number(const Program& program, const Operation& sum, std::size_t term) {
  return abs(sum.coefs[term]) != Rational(1) && program.at(sum.args[term]).kind != OpKind::number;
}

template <class Opens>
bool opens_none(const Program& program, Opens opens) {
  for (std::size_t op = 0; op < program.ops.size(); ++op)
    if (opens(op)) return false;
  return true;
}

}  // namespace

std::optional<Program> with_numbers_as_factors(const Program& program) {
  const std::vector<int> uses = use_counts(program);
  const auto opens = [&](std::size_t op) {
    const Operation& sum = program.ops[op];
    bool any = false;
    for (std::size_t i = 0; sum.kind == OpKind::sum && i < sum.args.size(); ++i)
      any = any || costs_a_number(program, sum, i);
    return any && uses[op] > 0;
  };
  if (opens_none(program, opens)) return std::nullopt;
  return rewritten(program, [&](ProgramBuilder& builder, const Operation& op, int, const Moved& at) -> Made {
    if (op.kind != OpKind::sum) return std::nullopt;
    Summands terms;
    for (std::size_t i = 0; i < op.args.size(); ++i) {
      if (!costs_a_number(program, op, i)) {
        terms.add(op.coefs[i], at(op.args[i]));
        continue;
      }
      const Rational size = abs(op.coefs[i]);
      Operation number;
      number.kind = OpKind::factor;
      number.value = size;
      const int factor = builder.leaf(number), arg = at(op.args[i]);
      const Operation& product = builder.at(arg);
      const bool open = product.kind == OpKind::product && product.name.empty();
      Operands args = open ? product.args : Operands{arg}, exponents = open ? product.exponents : Operands{1};
      args.push_back(factor), exponents.push_back(1);
      terms.add(op.coefs[i] / size, builder.product(std::move(args), std::move(exponents)));
    }
    return builder.sum(std::move(terms), op.name);
  });
}

std::optional<Program> distributed(const Program& program) {
  const std::vector<int> uses = use_counts(program);
  const auto opens = [&](std::size_t op) {
    return uses[op] > 0 && sum_among(program, program.ops[op], uses) < program.ops[op].args.size();
  };
  if (opens_none(program, opens)) return std::nullopt;
  return rewritten(program, [&](ProgramBuilder& builder, const Operation& op, int, const Moved& at) -> Made {
    const std::size_t i = sum_among(program, op, uses);
    if (i == op.args.size()) return std::nullopt;
    const Operation& sum = program.at(op.args[i]);
    Summands terms;
    for (std::size_t k = 0; k < sum.args.size(); ++k) {
      Operands factors = op.args, exponents = op.exponents;
      factors[i] = sum.args[k];
      const Operation& term = program.at(sum.args[k]);
      if (term.kind == OpKind::product && term.name.empty()) {
        factors[i] = term.args[0], exponents[i] = term.exponents[0];
        factors.append(term.args.begin() + 1, term.args.size() - 1);
        exponents.append(term.exponents.begin() + 1, term.exponents.size() - 1);
      }
      for (int& factor : factors) factor = at(factor);
      terms.add(sum.coefs[k], builder.product(std::move(factors), std::move(exponents)));
    }
    return builder.sum(std::move(terms), op.name);
  });
}

std::optional<Program> with_products_beside_squares_opened(const Program& program) {
  const Openings openings = beside_squares(program);
  if (openings.products.empty()) return std::nullopt;
  return rewritten(program, [&](ProgramBuilder& builder, const Operation& op, int index, const Moved& at) -> Made {
    const auto opening = openings.products.find(index);
    const bool opens = opening != openings.products.end();
    if (!opens && !openings.unnamed.contains(index)) return std::nullopt;
    const Operation& sum = opens ? program.at(op.args[opening->second.factor]) : op;
    Summands terms;
    for (std::size_t k = 0; k < sum.args.size(); ++k)
      terms.add(sum.coefs[k],
                opens ? opened_term(builder, op, program.at(sum.args[k]), opening->second, at) : at(sum.args[k]));
    return builder.sum(std::move(terms));
  });
}

}  // namespace cdot::derive
