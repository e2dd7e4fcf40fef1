// The law of momentum, and which terms of a row break it.
#include <algorithm>
#include <bit>
#include <fmt/format.h>
#include <set>

#include "derive/proof/laws.hpp"
#include "derive/proof/words.hpp"

namespace cdot::derive {

Felt felt_by(const std::vector<JacobianEntry>& J, const Joint& joint) {
  Felt felt{zero_vector(*joint.pool), zero_spin(*joint.pool)};
  for (std::size_t b = 0; b < J.size(); ++b) {
    felt.translation = felt.translation + J[b].v;
    felt.rotation = felt.rotation + J[b].w + cross(body_symbols(joint, static_cast<int>(b)).x, J[b].v);
  }
  return felt;
}

namespace {

// Where C = 0, a centre of mass with a numeric factor in C is a function of the other variables. Substituting it
// applies `pa = pb`.
GiNaC::exmap on_the_constraint(const Joint& joint, Algebra& names) {
  GiNaC::exmap solved;
  const auto put = [&](const ex& C) {
    const ex rest = substituted(C, solved);
    for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
      const auto q = names.coordinates(static_cast<int>(b));
      for (int k = 0; k < joint.dimension; ++k) {
        const ex& x = q[static_cast<std::size_t>(k)];
        const ex slope = names.constant_slope(rest, x);
        if (slope.is_zero()) continue;
        const ex value = -substituted(rest, {{x, 0}}) / slope;
        for (auto& [symbol, earlier] : solved) earlier = substituted(earlier, {{x, value}});
        solved[x] = value;
        return;
      }
    }
  };
  for (const Row& row : joint.rows) {
    if (row.kind != RowKind::equality) continue;
    if (!row.C->vector) {
      put(names.of(row.C));
    } else {
      for (const Expr component : components_of(row.C)) put(names.of(component));
    }
  }
  return solved;
}

// Terms of a row that feel a common motion, and what they feel.
struct Guilty {
  std::vector<Expr> terms;
  Felt felt;
};

class Momentum {
 public:
  Momentum(const Joint& joint, Algebra& names)
      : joint_(joint), names_(names), on_constraint_(on_the_constraint(joint, names)) {}

  bool vanishes(const ex& e) {
    if (is_zero(e)) return true;
    if (!is_zero(substituted(e, on_constraint_))) return false;
    only_on_constraint_ = true;
    return true;
  }
  bool translation_vanishes(const Felt& felt) { return all_vanish(components_of(felt.translation)); }
  bool rotation_vanishes(const Felt& felt) { return all_vanish(components_of(felt.rotation)); }
  // A vector C that rotates with the bodies has dC/dt = w x C. Its components along world axes e change by e . (w x C)
  // = w . (C x e), which vanishes where C = 0.
  bool turns_with_the_bodies(const ScalarRow& row, const Felt& felt) {
    if (row.component < 0 || row.kind != RowKind::equality) return false;
    const Expr axis = world_axes(*joint_.pool)[static_cast<std::size_t>(row.component)];
    for (const Expr e : components_of(felt.rotation - cross(row.row->C, axis))) {
      if (names_.is_zero(names_.of(e)) != Algebra::Zero::yes) return false;
    }
    only_on_constraint_ = true;
    return true;
  }
  bool only_on_constraint() const { return only_on_constraint_; }
  bool proved() const { return proved_; }
  bool undecided() const { return undecided_; }

  // The fewest terms of a row without which a common motion no longer changes it.
  Guilty breaking_terms(const std::vector<Expr>& terms, const std::vector<Felt>& felt_by_term) {
    constexpr std::size_t most_terms = 8;
    std::vector<unsigned> subsets;
    for (unsigned s = 1; terms.size() <= most_terms && s < 1u << terms.size(); ++s) subsets.push_back(s);
    std::stable_sort(subsets.begin(), subsets.end(),
                     [](unsigned a, unsigned b) { return std::popcount(a) < std::popcount(b); });
    Guilty guilty;
    for (const unsigned subset : subsets) {
      guilty = {{}, none()};
      Felt rest = none();
      for (std::size_t i = 0; i < terms.size(); ++i) {
        Felt& sum = subset >> i & 1 ? guilty.felt : rest;
        sum = {sum.translation + felt_by_term[i].translation, sum.rotation + felt_by_term[i].rotation};
        if (subset >> i & 1) guilty.terms.push_back(terms[i]);
      }
      if (translation_vanishes(rest) && rotation_vanishes(rest)) return guilty;
    }
    guilty = {terms, none()};
    for (const Felt& felt : felt_by_term)
      guilty.felt = {guilty.felt.translation + felt.translation, guilty.felt.rotation + felt.rotation};
    return guilty;
  }

 private:
  Felt none() const { return {zero_vector(*joint_.pool), zero_spin(*joint_.pool)}; }
  bool is_zero(const ex& e) {
    const Algebra::Zero zero = names_.is_zero(e);
    proved_ = proved_ && zero != Algebra::Zero::shown;
    undecided_ = undecided_ || zero == Algebra::Zero::undecided;
    return zero <= Algebra::Zero::shown;
  }
  bool all_vanish(const std::vector<Expr>& scalars) {
    return std::all_of(scalars.begin(), scalars.end(), [&](Expr e) { return vanishes(names_.of(e)); });
  }

  const Joint& joint_;
  Algebra& names_;
  GiNaC::exmap on_constraint_;
  bool only_on_constraint_ = false;
  bool proved_ = true;      // nothing has been shown by points alone
  bool undecided_ = false;  // something is zero to 60 digits, and more is not known
};

// The terms of a scalar row, each with its sign.
std::vector<Expr> terms_of_row(const ScalarRow& row, Expr written) {
  Expr whole = row.row == nullptr ? written : row.row->C;
  std::vector<Expr> terms;
  for (const Term& term : terms_of(whole)) {
    const Expr e = term.coef * term.e;
    terms.push_back(!e->vector ? e : components_of(e)[static_cast<std::size_t>(row.component)]);
  }
  return terms;
}

// Spellings in the spec of the quantities in these terms that a common motion changes.
std::set<std::string> spellings(const std::vector<Expr>& terms, const Joint& joint, bool rotation) {
  std::set<std::string> words;
  const std::vector<Expr> leaves = leaves_of(terms);
  const auto guilty = [&](Expr leaf) {
    if (rotation) return leaf->role == Role::angle || is_world_axis(leaf);
    return leaf->role == Role::position;
  };
  for (const Expr leaf : leaves) {
    if (!guilty(leaf)) continue;
    const std::string body = leaf->body < 0 ? "" : joint.bodies[static_cast<std::size_t>(leaf->body)];
    if (leaf->role == Role::angle) words.insert("angle(" + body + ")");
    else if (leaf->role == Role::position) words.insert("x(" + body + ")");
    else words.insert({".x", ".y", ".z"});
    for (const Let& let : joint.lets) {
      const std::vector<Expr> inside = leaves_of(std::span(&let.value, 1));
      if (std::find(inside.begin(), inside.end(), leaf) != inside.end()) words.insert(let.name);
    }
    for (const Parameter& p : joint.parameters) {
      const bool point = p.kind == ParameterKind::point && p.body == leaf->body;
      if (point && leaf->role == Role::position) words.insert(p.name);
    }
  }
  return words;
}

std::string sentence(const ScalarRow& row, const Felt& felt, bool rotation, const Joint& joint) {
  const char* const changes = row.kind == RowKind::velocity ? " gives " : " changes C by ";
  if (rotation) {
    return "angular momentum is not conserved: " + row.name + " resists a common rotation of all bodies, which" +
           changes + brief_spec_text(felt.rotation, joint) + " per radian";
  }
  return "momentum is not conserved: " + row.name + " resists a common translation of all bodies, which" + changes +
         brief_spec_text(felt.translation, joint) + " per metre";
}

// A velocity row of one body, as of a sleigh, acts against the ground: the ground has to stand in it.
std::string against_ground(const ScalarRow& row, const Joint& joint) {
  const std::string differences = "use differences of points, or say which point is fixed in the world";
  if (row.kind != RowKind::velocity || joint.bodies.size() != 1) return differences;
  std::string point = "x(a)", rate = "v(a)";
  for (const Parameter& p : joint.parameters)
    if (p.kind == ParameterKind::point && p.body == 0) point = p.name, rate = "v(" + p.name + ")";
  return "against the ground, declare `point ground on world = " + point + "` and write " + rate +
         " - v(ground) in place of " + rate;
}

std::string relative_directions(const std::vector<Expr>& guilty, const Joint& joint) {
  const std::string relative = "use angles and directions of bodies relative to each other, or to the world: ";
  for (const Expr leaf : leaves_of(guilty)) {
    if (leaf->role != Role::angle) continue;
    const std::string angle = "angle(" + joint.bodies[static_cast<std::size_t>(leaf->body)] + ")";
    return relative + angle + " - angle(world) in place of " + angle;
  }
  return relative + "a direction declared `on world`";
}

void fail(Law& law, const Joint& joint, const Block& block, const ScalarRow& row, bool rotation, Momentum& momentum) {
  if (momentum.undecided()) {
    law.verdict = Verdict::undecided;
    law.row = row.row;
    law.text = fmt::format(
        "{}: a common {} of all bodies changes C by 0 to 60 digits at random poses, but that is not "
        "proved",
        row.name, rotation ? "rotation" : "translation");
    return;
  }
  Expr written;
  Span where;
  for (const Coordinate& c : joint.coordinates) {
    if (c.name == block.name) written = c.value, where = c.where;
  }
  if (row.row != nullptr) where = row.row->where;
  const std::vector<Expr> terms = terms_of_row(row, written);
  std::vector<Felt> felt_by_term;
  for (const Expr term : terms) {
    const bool velocity = row.kind == RowKind::velocity;
    felt_by_term.push_back(felt_by(isolate_velocities(velocity ? term : time_derivative(term, joint), joint), joint));
  }
  const Guilty guilty = momentum.breaking_terms(terms, felt_by_term);
  law.verdict = Verdict::fails;
  law.row = row.row;
  law.text = sentence(row, guilty.felt, rotation, joint);
  std::vector<std::string> parts;
  for (const Expr term : guilty.terms) parts.push_back(brief_spec_text(term, joint));
  if (terms.size() > 1) law.text += "; the cause is " + listed(parts);
  law.fix = rotation ? relative_directions(guilty.terms, joint) : against_ground(row, joint);
  if (joint.file) law.parts = occurrences(*joint.file, where, spellings(guilty.terms, joint, rotation));
}

}  // namespace

// The world takes any impulse from the rows that name a quantity of it, and from no other.
void conserves_momentum(Law& law, const Joint& joint, const Block& block, Algebra& names) {
  law.verdict = Verdict::does_not_apply;
  if (block.immovable >= 0 || std::ranges::all_of(block.rows, &ScalarRow::of_world)) return;
  Momentum momentum(joint, names);
  for (const ScalarRow& row : block.rows) {
    if (row.of_world) continue;
    const Felt felt = felt_by(row.J, joint);
    if (!momentum.translation_vanishes(felt)) return fail(law, joint, block, row, false, momentum);
    if (!momentum.turns_with_the_bodies(row, felt) && !momentum.rotation_vanishes(felt))
      return fail(law, joint, block, row, true, momentum);
  }
  law.verdict = momentum.proved() ? Verdict::holds : Verdict::shown;
  if (momentum.only_on_constraint()) law.text = "where C = 0";
}

}  // namespace cdot::derive
