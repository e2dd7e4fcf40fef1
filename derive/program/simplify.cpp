// Passes from program to program. Each finds its best single rewriting, deterministically: the most frequent pair, the
// first of equals. Sharing and factoring compete, so they run in several orders and the cheapest program wins.
#include <algorithm>
#include <deque>
#include <optional>
#include <set>

#include "derive/program/rewrite.hpp"

namespace cdot::derive {
namespace {

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
std::optional<Program> take_out_factor(const Program& program) {
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
      std::vector<int> args, exponents;
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

// -x - y = -(x + y) and 2 x - 2 y = 2 (x - y): one factor for the sum, not one per term.
Program take_out_coefficients(const Program& program) {
  return rewritten(program, [&](ProgramBuilder& builder, const Operation& op, int, const Moved& at) -> Made {
    // Names of the spec survive.
    if (op.kind != OpKind::sum || op.args.size() < 2 || !op.name.empty()) return std::nullopt;
    const bool alike =
        std::all_of(op.coefs.begin(), op.coefs.end(), [&](Rational c) { return abs(c) == abs(op.coefs[0]); });
    const bool negative = std::all_of(op.coefs.begin(), op.coefs.end(), [](Rational c) { return c.sign() < 0; });
    const Rational factor = (negative ? Rational(-1) : Rational(1)) * (alike ? abs(op.coefs[0]) : Rational(1));
    if (factor == Rational(1)) return std::nullopt;
    Summands terms;
    for (std::size_t i = 0; i < op.args.size(); ++i) terms.add(op.coefs[i] / factor, at(op.args[i]));
    return builder.sum({{builder.sum(std::move(terms))}, {factor}});
  });
}

// (x + y) + z = x + y + z and -(x - y) = y - x, where the inner sum has no other user.
bool flattens(const Operation& outer, Rational coef, const Operation& inner, int uses) {
  if (inner.kind != OpKind::sum || uses != 1) return false;
  if (abs(coef) != Rational(1) && inner.args.size() > 1) return false;  // 2 (x + y) is cheaper
  const bool opens_with_minus = outer.args.size() == 1 && outer.coefs[0] == Rational(-1);
  const bool has_minus = std::any_of(inner.coefs.begin(), inner.coefs.end(), [](Rational c) { return c.sign() < 0; });
  return inner.name.empty() || (opens_with_minus && has_minus);
}

Program flatten_sums(const Program& program) {
  const std::vector<int> uses = use_counts(program);
  std::vector<bool> absorbed(program.ops.size());
  for (std::size_t i = 0; i < program.ops.size(); ++i) {
    if (uses[i] == 0 || program.ops[i].kind != OpKind::sum) continue;
    const Operation& outer = program.ops[i];
    for (std::size_t k = 0; k < outer.args.size(); ++k) {
      const auto a = static_cast<std::size_t>(outer.args[k]);
      absorbed[a] = flattens(outer, outer.coefs[k], program.ops[a], uses[a]);
    }
  }
  return rewritten(program, [&](ProgramBuilder& builder, const Operation& op, int index, const Moved& at) -> Made {
    if (absorbed[static_cast<std::size_t>(index)]) return builder.number(0);  // never read
    if (op.kind != OpKind::sum) return std::nullopt;
    Summands terms;
    const auto add = [&](auto&& self, const Operation& sum, Rational factor) -> void {
      for (std::size_t i = 0; i < sum.args.size(); ++i) {
        const int arg = sum.args[i];
        const Rational coef = factor * sum.coefs[i];
        if (absorbed[static_cast<std::size_t>(arg)]) self(self, program.at(arg), coef);
        else terms.add(coef, at(arg));
      }
    };
    add(add, op, Rational(1));
    return builder.sum(std::move(terms), op.name);
  });
}

// u + r = x_a - x_b where u = x_a - x_b - r: adding again what was subtracted costs an operation and digits.
// Returns the sum, and which of its terms is itself a sum.
using Cancelling = std::pair<std::size_t, std::size_t>;
std::optional<Cancelling> find_cancelling(const Program& program) {
  const std::vector<int> uses = use_counts(program);
  for (std::size_t s = 0; s < program.ops.size(); ++s) {
    const Operation& outer = program.ops[s];
    if (uses[s] == 0 || outer.kind != OpKind::sum) continue;
    for (std::size_t k = 0; k < outer.args.size(); ++k) {
      const Operation& inner = program.at(outer.args[k]);
      if (inner.kind != OpKind::sum) continue;
      for (std::size_t i = 0; i < inner.args.size(); ++i) {
        const std::size_t same = index_of(outer.args, inner.args[i]);
        if (same < outer.args.size() && outer.coefs[same] == -(outer.coefs[k] * inner.coefs[i])) {
          return Cancelling{s, k};
        }
      }
    }
  }
  return std::nullopt;
}

std::optional<Program> cancel_terms(const Program& program) {
  const std::optional<Cancelling> found = find_cancelling(program);
  if (!found) return std::nullopt;
  return rewritten(program, [&](ProgramBuilder& builder, const Operation& op, int index, const Moved& at) -> Made {
    if (index != static_cast<int>(found->first)) return std::nullopt;
    Summands terms;
    const auto add = [&](const Operation& sum, Rational factor, std::size_t but) {
      for (std::size_t i = 0; i < sum.args.size(); ++i) {
        if (i != but) terms.add(factor * sum.coefs[i], at(sum.args[i]));
      }
    };
    const Operation& inner = program.at(op.args[found->second]);
    add(inner, op.coefs[found->second], inner.args.size());
    add(op, Rational(1), found->second);
    return builder.sum(std::move(terms), op.name);
  });
}

using Pass = std::optional<Program> (*)(const Program&);

Program exhaust(Program program, Pass pass) {
  while (std::optional<Program> next = pass(program)) program = std::move(*next);
  return program;
}

// Orders of passes begin alike, and a search often repeats an earlier one: each step is made once.
struct Step {
  Program from;
  Pass pass;
  Program to;
};
const Program& after(const Program& from, Pass pass, std::deque<Step>& made) {
  for (const Step& step : made) {
    if (step.pass == pass && step.from == from) return step.to;
  }
  return made.emplace_back(Step{from, pass, flatten_sums(exhaust(from, pass))}).to;
}

// Cost in units of an addition; a division or root weighs as on current processors.
int weight(const Count& c) { return c.add + c.multiply + c.compare + 6 * (c.divide + c.root) + 40 * c.call; }

// The cheapest program that the passes find from here.
Program searched(const Program& program) {
  static constexpr Pass orders[][3] = {{share_factors, share_terms, take_out_factor},
                                       {take_out_factor, share_factors, share_terms},
                                       {share_terms, take_out_factor, share_factors},
                                       {share_terms, share_factors, take_out_factor},
                                       {take_out_factor, share_terms, share_factors}};
  std::deque<Step> steps;
  Program best = program;
  for (bool improved = true; improved;) {
    improved = false;
    const auto tidied = [](const Program& p, bool coefficients_out) {
      return flatten_sums(coefficients_out ? take_out_coefficients(p) : p);
    };
    const Program starts[] = {tidied(best, false), tidied(best, true)};
    for (const auto& order : orders) {
      for (const bool coefficients_out : {false, true}) {
        const Program* last = &starts[coefficients_out];
        for (const Pass pass : order) last = &after(*last, pass, steps);
        Program candidate = tidied(*last, coefficients_out);
        if (weight(count(candidate)) >= weight(count(best))) continue;
        best = std::move(candidate);
        improved = true;
      }
    }
  }
  // Of equals, x - w (2 y + z) rather than x + w (-2 y - z).
  Program positive = flatten_sums(take_out_coefficients(best));
  return weight(count(positive)) <= weight(count(best)) ? positive : best;
}

// 2 x y as a product with the factor 2, which then is shared and taken out as any other: (2 x) y + (2 x) z. Empty if
// there is no such number.
std::optional<Program> with_numbers_as_factors(const Program& program) {
  bool any = false;
  Program opened = rewritten(program, [&](ProgramBuilder& builder, const Operation& op, int, const Moved& at) -> Made {
    if (op.kind != OpKind::sum) return std::nullopt;
    Summands terms;
    for (std::size_t i = 0; i < op.args.size(); ++i) {
      const Rational size = abs(op.coefs[i]);
      if (size == Rational(1) || program.at(op.args[i]).kind == OpKind::number) {
        terms.add(op.coefs[i], at(op.args[i]));
        continue;
      }
      any = true;
      Operation number;
      number.kind = OpKind::factor;
      number.value = size;
      const int factor = builder.leaf(number), arg = at(op.args[i]);
      const Operation& product = builder.at(arg);
      const bool open = product.kind == OpKind::product && product.name.empty();
      std::vector<int> args = open ? product.args : std::vector{arg},
                       exponents = open ? product.exponents : std::vector{1};
      args.push_back(factor), exponents.push_back(1);
      terms.add(op.coefs[i] / size, builder.product(std::move(args), std::move(exponents)));
    }
    return builder.sum(std::move(terms), op.name);
  });
  return any ? std::optional(std::move(opened)) : std::nullopt;
}

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

// k (x + y) as k x + k y: what is taken out of the terms later may be shared. Empty if there is no such product.
std::optional<Program> distributed(const Program& program) {
  const std::vector<int> uses = use_counts(program);
  bool any = false;
  Program opened = rewritten(program, [&](ProgramBuilder& builder, const Operation& op, int, const Moved& at) -> Made {
    const std::size_t i = sum_among(program, op, uses);
    if (i == op.args.size()) return std::nullopt;
    any = true;
    const Operation& sum = program.at(op.args[i]);
    Summands terms;
    for (std::size_t k = 0; k < sum.args.size(); ++k) {
      std::vector<int> factors = op.args, exponents = op.exponents;
      factors[i] = sum.args[k];
      const Operation& term = program.at(sum.args[k]);
      if (term.kind == OpKind::product && term.name.empty()) {
        factors[i] = term.args[0], exponents[i] = term.exponents[0];
        factors.insert(factors.end(), term.args.begin() + 1, term.args.end());
        exponents.insert(exponents.end(), term.exponents.begin() + 1, term.exponents.end());
      }
      for (int& factor : factors) factor = at(factor);
      terms.add(sum.coefs[k], builder.product(std::move(factors), std::move(exponents)));
    }
    return builder.sum(std::move(terms), op.name);
  });
  return any ? std::optional(flatten_sums(opened)) : std::nullopt;
}

Program cheaper(Program a, Program b) { return weight(count(a)) <= weight(count(b)) ? std::move(a) : std::move(b); }

}  // namespace

Program simplify(const Program& program) {
  const Program start = exhaust(program, cancel_terms);
  Program best = searched(start);
  if (find_cancelling(program)) best = cheaper(std::move(best), searched(program));
  for (const std::optional<Program>& from : {std::optional(start), distributed(start)}) {
    const std::optional<Program> opened = from ? with_numbers_as_factors(*from) : std::nullopt;
    if (opened) best = cheaper(std::move(best), searched(*opened));
  }
  return best;
}

}  // namespace cdot::derive
