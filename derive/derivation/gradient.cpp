#include "derive/derivation/gradient.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "derive/expression/components.hpp"
#include "derive/expression/symbols.hpp"
#include "derive/language/operators.hpp"

namespace cdot::derive {
namespace {

bool is_gradient(Expr e) {
  return e->kind == Kind::sum && e->args.size() > 1 &&
         std::any_of(e->args.begin(), e->args.end(), [](Expr arg) { return arg->kind == Kind::scale; });
}

// Names of the spec, and of the components and rates of its vectors.
std::set<std::string> names_in(const Joint& joint) {
  std::set<std::string> names(joint.bodies.begin(), joint.bodies.end());
  for (const Parameter& p : joint.parameters) {
    names.insert(p.name);
    if (p.symbol) names.insert(p.symbol->symbol);
    for (const Expr axis : p.axes) names.insert(axis->symbol);
  }
  for (const Let& let : joint.lets) names.insert(let.name);
  for (const Row& row : joint.rows) names.insert(row.name);
  for (const auto* coordinates : {&joint.coordinates, &joint.dropped}) {
    for (const Coordinate& c : *coordinates) names.insert(c.name);
  }
  return names;
}

// -n rather than n, where n has more components without any positive term.
bool opens_with_minus(Expr n) {
  const auto negatives = [](Expr v) {
    Components components;
    const std::vector<Expr> all = components.of_vector(v);
    return std::ranges::count_if(all, [](Expr e) {
      return e->kind == Kind::sum && std::ranges::all_of(e->coefs, [](Rational c) { return c.sign() < 0; });
    });
  };
  return negatives(n) > negatives(-n);
}

// A product times -1, with the sign in a sum among its factors: -(x - y) u = (y - x) u. Empty without such a factor.
Expr with_opposite_factor(Expr e) {
  if (e->kind != Kind::product && e->kind != Kind::scale) return {};
  if (e->kind == Kind::scale && e->args[0]->kind == Kind::product) {
    const Expr factor = with_opposite_factor(e->args[0]);
    return factor ? factor * e->args[1] : Expr();
  }
  for (std::size_t i = 0; i < e->args.size(); ++i) {
    const Expr factor = e->args[i];
    const bool odd = e->kind == Kind::scale || e->exponents[i] == 1;
    if (factor->vector || factor->kind != Kind::sum || !factor->name.empty() || !odd) continue;
    std::vector<Expr> args = e->args;
    args[i] = -factor;
    return rebuild(e, args);
  }
  return {};
}

// The first of n_row, n_row_1, n_row_2, ... that no other quantity of the joint has.
std::string free_name(const Joint& joint, const std::string& wish) {
  const std::set<std::string> taken = names_in(joint);
  const auto is_free = [&](const std::string& name) {
    if (is_symbol_of_tool(name) || is_operator(name) || is_word_of_cpp(name)) return false;
    return !std::any_of(taken.begin(), taken.end(), [&](const std::string& known) {
      return known == name || known == name + "_x" || known == name + "_y" || known == name + "_z" ||
             known == name + "_dot";
    });
  };
  std::string name = wish;
  for (int k = 1; !is_free(name); ++k) name = wish + "_" + std::to_string(k);
  return name;
}

class Gradients {
 public:
  Gradients(const Joint& joint, ScalarRow& row) : joint_(joint), row_(row) {}

  void name() {
    find_carrier();
    for (std::size_t b = 0; b < row_.J.size(); ++b) find(b);
    if (found_.empty()) return;
    for (const auto& [e, body] : found_) {
      if (e->name.empty()) {
        const Expr negative = -e;
        const std::string suffix = found_.size() > 1 ? "_" + joint_.bodies[body] : "";
        e->pool->name(e, free_name_of_row(joint_, row_, {"n", "n_", "grad_", suffix}), true);
        named_.emplace(&*negative, -e);
      }
      row_.gradients.push_back(e);
    }
    if (carrier_) named_[&*row_.J[*carrier_].v] = others_than_the_carrier();
    for (JacobianEntry& entry : row_.J) {
      entry.v = substitute(entry.v, named_);
      entry.w = by_levers(substitute(entry.w, named_));
    }
  }

 private:
  // The body whose factor of v is the negative of all others: it carries the curve or surface. Its row of levers has
  // the most terms.
  void find_carrier() {
    std::size_t most = 0;
    for (std::size_t b = 0; b < row_.J.size(); ++b) {
      const std::size_t levers = terms_of(row_.J[b].w).size();
      if (!is_gradient(row_.J[b].v) || levers < most) continue;
      most = levers;
      carrier_ = b;
    }
    if (carrier_ && row_.J[*carrier_].v != others_than_the_carrier()) carrier_.reset();
  }

  Expr others_than_the_carrier() const {
    Expr total = zero_vector(*joint_.pool);
    for (std::size_t b = 0; b < row_.J.size(); ++b) {
      if (b != *carrier_) total = total - substitute(row_.J[b].v, named_);
    }
    return total;
  }

  // A factor that is new, or the negative of one that has a name.
  void find(std::size_t body) {
    const Expr v = split_coefficient(row_.J[body].v).e;
    if (!is_gradient(v) || body == carrier_) return;
    const Expr negative = -v;
    for (const auto& [known, of] : found_) {
      if (known == v || known == negative) return;
    }
    const bool opposite = !negative->name.empty() || (v->name.empty() && opens_with_minus(v));
    if (!negative->name.empty()) named_.emplace(&*v, -negative);
    found_.emplace_back(opposite ? negative : v, body);
  }

  Expr by_levers(Expr w) const {
    if (w->kind != Kind::sum || !w->name.empty()) return w;
    std::vector<Term> terms;
    for (const Term& term : terms_of(w)) {
      const Term plain = split_coefficient(term.e);  // of a name for -(u × f)
      terms.push_back({term.coef * plain.coef, plain.e});
    }
    for (const Expr n : row_.gradients) {
      for (const Expr lever : levers_in(terms)) collect(terms, lever, n);
    }
    return sum(*w->pool, terms, w->vector);
  }

  // The operands of all products u × f, u · f.
  static std::vector<Expr> levers_in(const std::vector<Term>& terms) {
    std::vector<Expr> levers;
    for (const Term& term : terms) {
      std::vector<Expr> factors{term.e};
      if (term.e->kind == Kind::product || term.e->kind == Kind::scale) factors = term.e->args;
      for (const Expr factor : factors) {
        if (factor->kind != Kind::cross && factor->kind != Kind::dot) continue;
        for (const Expr u : factor->args) {
          if (std::find(levers.begin(), levers.end(), u) == levers.end()) levers.push_back(u);
        }
      }
    }
    return levers;
  }

  // Replaces the terms of u × n by it, if all are there.
  static void collect(std::vector<Term>& terms, Expr u, Expr n) {
    Expr expanded = u->pool->dimension() == 2 ? u->pool->number(0) : zero_vector(*u->pool);
    for (const Term& part : terms_of(n)) expanded = expanded + part.coef * cross(u, part.e);
    const std::vector<Term> wanted = terms_of(expanded);
    // A single term, as of u × (u - h t), is worth it beside another lever of n.
    const bool beside = std::any_of(terms.begin(), terms.end(), [&](const Term& t) {
      return t.e->kind == Kind::cross && (t.e->args[0] == n || t.e->args[1] == n);
    });
    if (is_zero(expanded) || (wanted.size() < 2 && !beside)) return;
    std::vector<Term> rest = terms;
    std::optional<Rational> sign;
    for (const Term& term : wanted) {
      const Expr opposite = with_opposite_factor(term.e);
      const auto at = std::find_if(rest.begin(), rest.end(),
                                   [&](const Term& t) { return t.e == term.e || (opposite && t.e == opposite); });
      if (at == rest.end()) return;
      const Rational ratio = (at->e == term.e ? Rational(1) : Rational(-1)) * (at->coef / term.coef);
      if (abs(ratio) != Rational(1) || (sign && *sign != ratio)) return;
      sign = ratio;
      rest.erase(at);
    }
    rest.push_back({*sign, cross(u, n)});
    terms = std::move(rest);
  }

  const Joint& joint_;
  ScalarRow& row_;
  std::optional<std::size_t> carrier_;
  std::vector<std::pair<Expr, std::size_t>> found_;  // gradients, and the body whose factor each is
  std::map<const Node*, Expr> named_;                // sums that are written by these
};

}  // namespace

std::string free_name_of_row(const Joint& joint, const ScalarRow& row, NamesOfRow names) {
  const bool unnamed = row.name.size() > 1 && row.name[0] == 'C' && row.name[1] >= '0' && row.name[1] <= '9';
  const bool alone = row.row != nullptr && joint.rows.size() == 1 && row.component < 0;
  const std::string prefix = row.row == nullptr ? names.of_coordinate : names.of_row;  // n_x is a component of n
  const std::string name = alone ? names.alone : prefix + (unnamed ? row.name.substr(1) : row.name);
  return free_name(joint, name + names.suffix);
}

void name_gradients(const Joint& joint, ScalarRow& row) { Gradients(joint, row).name(); }

}  // namespace cdot::derive
