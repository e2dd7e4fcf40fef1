// Where K is singular. By Cauchy-Binet, det K is a sum over choices of columns of J: (minor of J)^2 times the inverse
// masses of the columns. No term is negative, so K is singular exactly where the terms of every product of inverse
// masses vanish. K is regular if one of these terms is a sum of squares that cannot vanish.
#include "derive/check/mass.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <set>

#include "derive/check/parts.hpp"
#include "derive/proof/words.hpp"

namespace cdot::derive {
namespace {

// Beyond the first number of minors, algebra is too expensive and numbers at the random poses decide.
constexpr double most_minors_by_algebra = 250, most_minors = 20000;

// Powers of the inverse masses: m of the first body, its I, m of the second, ...
using Monomial = std::vector<int>;

struct Coefficient {
  Monomial monomial;
  ex value;                  // sum of the squares of the minors
  std::vector<double> seen;  // at the random poses
  bool never_zero = false;
  // It is zero where one of these is: "ratio", "cross(ra, n)"; empty if no closed form was found.
  std::vector<std::string> factors;
};

// A quantity with a name, and its values at the random poses.
struct Candidate {
  Expr e;
  std::vector<double> seen;
};

class MassCheck {
 public:
  MassCheck(const Subject& subject, Findings& findings)
      : subject_(subject), joint_(subject.joint), findings_(findings), names_(subject.joint, Algebra::Route::names) {}

  void run() {
    if (subject_.block.rows.empty()) return;
    const double minors = number_of_choices(width_ * joint_.bodies.size(), subject_.block.rows.size());
    if (minors > most_minors) {
      return add(fmt::format("singular poses of K were not searched: J has {:.0f} minors, more than {:.0f}", minors,
                             most_minors));
    }
    by_algebra_ = minors <= most_minors_by_algebra;
    expand();
    find_candidates();
    for (Coefficient& c : coefficients_) describe(c);
    if (coefficients_.empty()) return;  // said by the law of the rank
    report_all();
    for (std::size_t b = 0; joint_.bodies.size() > 1 && b < joint_.bodies.size(); ++b) {
      report_while("nothing but " + joint_.bodies[b] + " can move", [&](std::size_t i) { return i / 2 == b; });
    }
    report_while("nothing can turn", [](std::size_t i) { return i % 2 == 0; });
  }

 private:
  // Sums the squares of the minors by their product of inverse masses.
  void expand() {
    std::vector<std::vector<ex>> J;
    for (const ScalarRow& row : subject_.block.rows) {
      names_.shorten(row.kind == RowKind::velocity ? row.Cdot : row.C);
      J.emplace_back();
      for (const Expr entry : columns_of(row.J)) J.back().push_back(by_algebra_ ? names_.of(entry) : ex(0));
    }
    std::vector<std::vector<std::vector<double>>> seen;
    for (const Sample& sample : subject_.anywhere) seen.push_back(jacobian_at(subject_.block, sample));
    std::map<Monomial, Coefficient> by_monomial;
    const std::size_t rows = J.size(), width = J[0].size();
    Minors minors(std::move(J));
    std::vector<std::size_t> columns;
    const auto choose = [&](auto&& self, std::size_t from) -> void {
      if (columns.size() == rows) return add_minor(minors, seen, columns, by_monomial);
      for (std::size_t c = from; c < width; ++c) {
        columns.push_back(c);
        self(self, c + 1);
        columns.pop_back();
      }
    };
    choose(choose, 0);
    for (auto& [monomial, coefficient] : by_monomial) {
      const auto& at = coefficient.seen;
      const double largest = *std::max_element(at.begin(), at.end());
      const bool zero = largest < 1e-18 && (!by_algebra_ || names_.vanishes(coefficient.value));
      if (!zero) coefficients_.push_back(std::move(coefficient));
    }
  }

  void add_minor(Minors& minors, const std::vector<std::vector<std::vector<double>>>& seen,
                 const std::vector<std::size_t>& columns, std::map<Monomial, Coefficient>& sums) {
    const ex minor = by_algebra_ ? minors.of(columns) : ex(1);
    if (minor.is_zero()) return;
    Monomial monomial(2 * joint_.bodies.size());
    for (const std::size_t c : columns) {
      ++monomial[2 * (c / width_) + (c % width_ >= linear_ ? 1 : 0)];
    }
    Coefficient& sum = sums[monomial];
    sum.monomial = monomial;
    sum.value += minor * minor;
    sum.seen.resize(seen.size());
    for (std::size_t k = 0; k < seen.size(); ++k) {
      const double value = determinant(seen[k], columns);
      sum.seen[k] += value * value;
    }
  }

  // A vector stands for its length.
  void add_candidate(Expr e) {
    if (e->vector) e = norm(e);
    if (e->kind == Kind::number) return;
    e = split_coefficient(e).e;
    for (const Candidate& c : candidates_) {
      if (c.e == e) return;
    }
    Candidate candidate{e, {}};
    for (const Sample& sample : subject_.anywhere) {
      candidate.seen.push_back(Numbers(sample).scalar(e));
    }
    candidates_.push_back(std::move(candidate));
  }

  // A component along an axis of the world means nothing to a joint.
  static bool of_world(Expr e) {
    return is_world_axis(e) || (e->kind == Kind::cross && std::any_of(e->args.begin(), e->args.end(), is_world_axis));
  }

  // An axis brings the other axes of its frame, which are orthogonal to it.
  void add_vector(Expr e, std::vector<Expr>& vectors) {
    const Pool::Axis axis = joint_.pool->axis_of(e);
    for (const Expr v : axis.triad ? std::vector<Expr>(axis.triad->begin(), axis.triad->end()) : std::vector<Expr>{e}) {
      if (std::find(vectors.begin(), vectors.end(), v) != vectors.end()) continue;
      vectors.push_back(v);
      if (!v->unit_length) add_candidate(norm(v));
    }
  }

  // Parameters, entries of J, lengths, and products of the vectors that J is made of.
  void find_candidates() {
    std::vector<Expr> entries, vectors;
    for (const ScalarRow& row : subject_.block.rows) {
      for (const JacobianEntry& entry : row.J) entries.insert(entries.end(), {entry.w, entry.v});
    }
    for (const Expr e : leaves_of(entries)) {
      if (e->role == Role::parameter && !e->vector) add_candidate(e);
    }
    for (const Expr e : entries) {
      if (!e->vector || joint_.dimension == 3) add_candidate(e);
    }
    for (const Expr e : topological(entries)) {
      if (!e->vector || e->role == Role::position || e->kind == Kind::perp) continue;
      if (e->kind == Kind::scale || is_zero(e) || vectors.size() > 12 || of_world(e)) continue;
      add_vector(e, vectors);
    }
    for (std::size_t i = 0; i < vectors.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        add_candidate(cross(vectors[k], vectors[i]));
        add_candidate(dot(vectors[k], vectors[i]));
      }
    }
    // The shortest words for the same thing.
    std::stable_sort(candidates_.begin(), candidates_.end(), [&](const Candidate& a, const Candidate& b) {
      return spec_text(a.e, joint_).size() < spec_text(b.e, joint_).size();
    });
  }

  // A simple factor with c = factor * s^2 at every random pose, if there is one.
  std::optional<ex> factor_of(const Coefficient& c, const std::vector<double>& s) {
    const double ratio = c.seen[0] / (s[0] * s[0]);
    const double twelfths = std::round(12 * ratio);
    if (!(std::fabs(12 * ratio - twelfths) < 1e-6) || twelfths == 0) return std::nullopt;
    for (std::size_t k = 0; k < s.size(); ++k) {
      if (!(std::fabs(c.seen[k] - ratio * s[k] * s[k]) <= 1e-8 * c.seen[k])) return std::nullopt;
    }
    return numeric(static_cast<long>(twelfths)) / 12;
  }

  // Writes it as the square of one candidate, or of a product of two.
  bool recognise(Coefficient& c) {
    for (const Candidate& s : candidates_) {
      if (!is_square_of(c, s.seen, [&] { return names_.of(s.e); })) continue;
      c.factors = factors_of(s.e);
      return true;
    }
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        const Candidate &s = candidates_[k], &t = candidates_[i];
        std::vector<double> product = t.seen;
        for (std::size_t p = 0; p < product.size(); ++p) product[p] *= s.seen[p];
        if (!is_square_of(c, product, [&] { return names_.of(t.e) * names_.of(s.e); })) continue;
        c.factors = {spec_text(s.e, joint_), spec_text(t.e, joint_)};
        return true;
      }
    }
    return false;
  }

  // Without algebra, the numbers have decided already.
  template <class Root>
  bool is_square_of(const Coefficient& c, const std::vector<double>& seen, Root root_of) {
    const std::optional<ex> factor = factor_of(c, seen);
    if (!factor || !by_algebra_) return factor.has_value();
    const ex root = root_of();
    return names_.vanishes(c.value - *factor * root * root);
  }

  std::vector<std::string> factors_of(Expr e) const {
    std::vector<std::string> names;
    const bool product = e->kind == Kind::product && e->name.empty();
    for (const Expr factor : product ? e->args : std::vector<Expr>{e}) {
      const Expr e = factor->kind == Kind::norm && factor->name.empty() ? factor->args[0] : factor;
      names.push_back(spec_text(e->vector ? e : with_leading_sign(e), joint_));
    }
    return names;
  }

  static bool is_constant(const std::vector<double>& seen) {
    return std::all_of(seen.begin(), seen.end(), [&](double x) { return std::fabs(x - seen[0]) <= 1e-9 * seen[0]; });
  }

  // Without algebra, numbers decide; with it, a number that the coefficient equals everywhere.
  bool is_number(const Coefficient& c) {
    if (!is_constant(c.seen) || !by_algebra_) return is_constant(c.seen);
    const std::optional<ex> number = factor_of(c, std::vector<double>(c.seen.size(), 1));
    return number && names_.vanishes(c.value - *number);
  }

  void describe(Coefficient& c) {
    c.never_zero = is_number(c);
    if (c.never_zero) return;
    if (!by_algebra_) {
      recognise(c);
      return;
    }
    const std::optional<ex> numerator = names_.numerator(c.value, true);
    const auto positive = [&](const ex& p) { return is_positive(p, names_.symbols_in(p)); };
    if (numerator && (positive(*numerator) || positive(names_.other_coordinates(*numerator)))) {
      c.never_zero = true;
    } else if (!recognise(c) && numerator) {
      c.factors = names_.factors_of(*numerator);
    }
  }

  using Choice = std::vector<const Coefficient*>;

  // The coefficients that remain if all other inverse masses are zero.
  template <class Allowed>
  Choice chosen(Allowed allowed) const {
    Choice out;
    for (const Coefficient& c : coefficients_) {
      bool all = true;
      for (std::size_t i = 0; i < c.monomial.size(); ++i) all = all && (c.monomial[i] == 0 || allowed(i));
      if (all) out.push_back(&c);
    }
    return out;
  }

  static bool any_never_zero(const Choice& choice) { return std::ranges::any_of(choice, &Coefficient::never_zero); }

  static std::string all_zero(const Choice& choice) {
    std::vector<std::vector<std::string>> factors;
    for (const Coefficient* c : choice) factors.push_back(c->factors);
    return where_all_vanish(factors);
  }

  Way way_of(const Monomial& monomial) const {
    Way way;
    for (std::size_t b = 0; b < joint_.bodies.size(); ++b) {
      if (monomial[2 * b] > 0) way.move.insert(joint_.bodies[b]);
      if (monomial[2 * b + 1] > 0) way.turn.insert(joint_.bodies[b]);
    }
    return way;
  }

  void report_all() {
    const Choice all = chosen([](std::size_t) { return true; });
    if (!any_never_zero(all)) return add("K is singular " + all_zero(all));
    std::vector<Way> ways;
    for (const Coefficient* c : all) {
      const Way way = way_of(c->monomial);
      const bool least = std::none_of(all.begin(), all.end(), [&](const Coefficient* other) {
        const Way less = way_of(other->monomial);
        return other->never_zero && less != way && std::ranges::includes(way.move, less.move) &&
               std::ranges::includes(way.turn, less.turn);
      });
      const bool known = std::find(ways.begin(), ways.end(), way) != ways.end();
      if (c->never_zero && least && !known) ways.push_back(way);
    }
    add("K is regular at every pose while " + in_words(ways));
  }

  template <class Allowed>
  void report_while(const std::string& condition, Allowed allowed) {
    const Choice choice = chosen(allowed);
    if (!any_never_zero(choice)) add("while " + condition + ", K is singular " + all_zero(choice));
  }

  void add(std::string message) {
    findings_.add(Level::note, "singular", joint_.rows.front().where, std::move(message));
  }

  const Subject& subject_;
  const Joint& joint_;
  Findings& findings_;
  Algebra names_;
  // Inertia counts as a number in space, too: a positive definite tensor changes no rank.
  std::size_t linear_ = static_cast<std::size_t>(joint_.dimension);
  std::size_t width_ = columns_per_body(joint_.dimension);
  bool by_algebra_ = true;
  std::vector<Coefficient> coefficients_;
  std::vector<Candidate> candidates_;
};

}  // namespace

void check_mass(const Subject& subject, Findings& findings) try {
  MassCheck(subject, findings).run();
} catch (const GiNaC::pole_error&) {
  findings.add(Level::note, "singular", subject.joint.rows.front().where,
               "singular poses of K were not searched: J divides by zero");
}

}  // namespace cdot::derive
