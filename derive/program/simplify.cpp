// Passes from program to program. Each finds its best single rewriting, deterministically: the most frequent pair, the
// first of equals. Sharing and factoring compete, so they run in several orders and the cheapest program wins.
#include <algorithm>
#include <deque>
#include <optional>
#include <set>

#include "derive/program/rewrite.hpp"

namespace cdot::derive {
namespace {

// Programs of builders are in normal form: where all is needed and a pass finds nothing, a copy would be the same.
bool all_needed(const std::vector<int>& uses) { return std::ranges::find(uses, 0) == uses.end(); }

// The factor that all terms of a sum have in common, with the sign that makes one of them positive. Sums with a name of
// the spec keep their terms.
Rational coefficient_of(const Operation& op) {
  if (op.kind != OpKind::sum || op.args.size() < 2 || !op.name.empty()) return Rational(1);
  const bool alike = std::ranges::all_of(op.coefs, [&](Rational c) { return abs(c) == abs(op.coefs[0]); });
  const bool negative = std::ranges::all_of(op.coefs, [](Rational c) { return c.sign() < 0; });
  return (negative ? Rational(-1) : Rational(1)) * (alike ? abs(op.coefs[0]) : Rational(1));
}

// -x - y = -(x + y) and 2 x - 2 y = 2 (x - y): one factor for the sum, not one per term.
Passed take_out_coefficients(const Program& program, Effort&) {
  const auto has_none = [](const Operation& op) { return coefficient_of(op) == Rational(1); };
  if (std::ranges::all_of(program.ops, has_none) && all_needed(use_counts(program))) return std::nullopt;
  return rewritten(program, [&](ProgramBuilder& builder, const Operation& op, int, const Moved& at) -> Made {
    const Rational factor = coefficient_of(op);
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

Passed flatten_sums(const Program& program, Effort&) {
  const std::vector<int> uses = use_counts(program);
  std::vector<bool> absorbed(program.ops.size());
  bool any = !all_needed(uses);
  for (std::size_t i = 0; i < program.ops.size(); ++i) {
    if (uses[i] == 0 || program.ops[i].kind != OpKind::sum) continue;
    const Operation& outer = program.ops[i];
    for (std::size_t k = 0; k < outer.args.size(); ++k) {
      const auto a = static_cast<std::size_t>(outer.args[k]);
      absorbed[a] = flattens(outer, outer.coefs[k], program.ops[a], uses[a]);
      any = any || absorbed[a];
    }
  }
  if (!any) return std::nullopt;
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

// k (x y) = k x y, where the inner product has no other user: any two of the factors may then be shared.
Passed flatten_products(const Program& program, Effort&) {
  const std::vector<int> uses = use_counts(program);
  const auto absorbed = [&](int arg, int exponent) {
    const Operation& inner = program.at(arg);
    return inner.kind == OpKind::product && exponent == 1 && inner.name.empty() &&
           uses[static_cast<std::size_t>(arg)] == 1;
  };
  const auto absorbs = [&](const Operation& op) {
    if (op.kind != OpKind::product) return false;
    for (std::size_t i = 0; i < op.args.size(); ++i)
      if (absorbed(op.args[i], op.exponents[i])) return true;
    return false;
  };
  if (std::ranges::none_of(program.ops, absorbs) && all_needed(uses)) return std::nullopt;
  return rewritten(program, [&](ProgramBuilder& builder, const Operation& op, int, const Moved& at) -> Made {
    if (!absorbs(op)) return std::nullopt;
    Operands args, exponents;
    const auto add = [&](auto&& self, const Operation& product) -> void {
      for (std::size_t i = 0; i < product.args.size(); ++i) {
        if (absorbed(product.args[i], product.exponents[i])) self(self, program.at(product.args[i]));
        else args.push_back(at(product.args[i])), exponents.push_back(product.exponents[i]);
      }
    };
    add(add, op);
    return builder.product(std::move(args), std::move(exponents), op.name);
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

Program without_cancelling(Program program, Effort& effort) {
  for (std::optional<Program> next; !effort.spent() && (next = cancel_terms(program)); program = std::move(*next)) {
    effort.spend(8 * program.ops.size());
  }
  return program;
}

// Cost in units of an addition; a division or root weighs as on current processors.
int weight(const Count& c) { return c.add + c.multiply + c.compare + 6 * (c.divide + c.root) + 40 * c.call; }

using Pass = Passed (*)(const Program&, Effort&);

// Looks for the cheapest program that the passes find. Orders of passes begin alike, most passes leave a program as it
// is, and many ways lead to the same one: each program is kept once, and each step from it is made once.
class Search {
 public:
  explicit Search(Effort& effort) : effort_(effort) {}

  // The cheapest program from here.
  Program from(const Program& program);

 private:
  struct Step {
    const Program *from, *to;
    Pass pass;
  };
  const Program* kept(Program program);
  const Program* after(const Program* from, Pass pass);
  const Program* tidied(const Program* program, bool coefficients_out);
  const Program* costly_step(const Program* from, Pass pass);

  Effort& effort_;
  std::deque<Program> programs_;
  std::deque<Step> steps_;
};

const Program* Search::kept(Program program) {
  const auto known = std::ranges::find(programs_, program);
  return known != programs_.end() ? &*known : &programs_.emplace_back(std::move(program));
}

const Program* Search::after(const Program* from, Pass pass) {
  for (const Step& step : steps_)
    if (step.pass == pass && step.from == from) return step.to;
  Passed passed = pass(*from, effort_);
  return steps_.emplace_back(Step{from, passed ? kept(std::move(*passed)) : from, pass}).to;
}

const Program* Search::tidied(const Program* program, bool coefficients_out) {
  if (coefficients_out) program = after(program, take_out_coefficients);
  return after(after(program, flatten_products), flatten_sums);
}

const Program* Search::costly_step(const Program* from, Pass pass) {
  effort_.spend(8 * from->ops.size());
  return after(after(from, pass), flatten_sums);
}

Program Search::from(const Program& program) {
  static constexpr Pass orders[][3] = {{share_factors, share_terms, take_out_factors},
                                       {take_out_factors, share_factors, share_terms},
                                       {share_terms, take_out_factors, share_factors},
                                       {share_terms, share_factors, take_out_factors},
                                       {take_out_factors, share_terms, share_factors}};
  const Program* best = kept(program);
  int least = weight(count(*best));
  std::set<const Program*> weighed;
  for (bool improved = true; improved && !effort_.spent();) {
    improved = false;
    const Program* const start[] = {tidied(best, false), tidied(best, true)};
    for (const auto& order : orders) {
      for (const bool coefficients_out : {false, true}) {
        const Program* last = start[coefficients_out];
        for (const Pass pass : order) last = costly_step(last, pass);
        last = tidied(last, coefficients_out);
        if (!weighed.insert(last).second) continue;
        const int last_weight = weight(count(*last));
        if (last_weight >= least) continue;
        best = last, least = last_weight;
        improved = true;
      }
    }
  }
  // Of equals, x - w (2 y + z) rather than x + w (-2 y - z).
  const Program* positive = after(after(best, take_out_coefficients), flatten_sums);
  return weight(count(*positive)) <= least ? *positive : *best;
}

Program cheaper(Program a, Program b) { return weight(count(a)) <= weight(count(b)) ? std::move(a) : std::move(b); }

}  // namespace

Program simplify(const Program& program, Effort& effort) {
  const Program start = without_cancelling(program, effort);
  const auto searched = [&](const Program& from) { return Search(effort).from(from); };
  const auto passed = [&](const Program& from, Pass pass) { return pass(from, effort).value_or(from); };
  Program best = searched(start);
  if (find_cancelling(program)) best = cheaper(std::move(best), searched(program));
  const auto try_from = [&](const std::optional<Program>& from) {
    if (from && !effort.spent()) best = cheaper(std::move(best), searched(*from));
  };
  const auto with_numbers = [&](const std::optional<Program>& from) {
    return from ? with_numbers_as_factors(passed(*from, flatten_sums)) : std::nullopt;
  };
  // h^2 + k h^2 is one product.
  const Program factored = passed(passed(passed(start, take_out_factors), flatten_sums), take_out_coefficients);
  const std::optional<Program> beside = with_products_beside_squares_opened(passed(factored, flatten_sums));
  for (const std::optional<Program>& from : {std::optional(start), distributed(start), beside})
    try_from(with_numbers(from));
  try_from(beside);
  try_from(with_products_beside_squares_opened(best));
  return best;
}

Program simplify(const Program& program) {
  Effort effort{most_effort};
  return simplify(program, effort);
}

}  // namespace cdot::derive
