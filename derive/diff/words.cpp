#include "derive/diff/words.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <regex>

#include "derive/diff/terms.hpp"
#include "derive/expression/matrix.hpp"

namespace cdot::derive {
namespace {

// Longer formulas do not fit a sentence; the lines below show them.
constexpr std::size_t longest_formula = 120;

// Penalty for an explanation that is less specific than a missing term, a sign or a single factor.
constexpr std::size_t unspecific = 500;

struct Explained {
  std::string kind, sentence;
  std::size_t effort = 0;  // to read: the explanation with the least is given
};

// The name of e, or its text if it has none.
std::string spoken(Expr e) { return e->name.empty() ? text(e) : e->name; }

// A name given by the entry, with its definition: "theta_initial = -phi".
std::string introduced(Expr e, const Joint& joint) {
  constexpr std::size_t longest_value = 40;
  const bool of_spec =
      std::any_of(joint.lets.begin(), joint.lets.end(), [&](const Let& let) { return let.name == e->name; });
  const std::string value = text(e);
  if (e->name.empty() || !e->named_by_let || of_spec || value.size() > longest_value) return spoken(e);
  return fmt::format("{} = {}", e->name, value);
}

// The published terms, and those that belong there.
std::string instead(const std::string& has, const std::string& lacks) {
  if (has.size() + lacks.size() > longest_formula || has == lacks) return not_generated;
  return fmt::format("it has {} where {} belongs", has, lacks);
}

std::string where_from(const Contribution& source, const Joint& joint) {
  const std::string body = joint.bodies[static_cast<std::size_t>(source.leaf->body)];
  const std::string& s = source.leaf->symbol;
  if (source.leaf->role == Role::body_vector) {
    return fmt::format("{0} turns with {1} (d{0}/dt = w_{1} x {0}), so the product rule has a term for it", s, body);
  }
  return fmt::format("{} moves with {}", s, body);
}

// The symbols of one body by class: masses, inertias, velocities.
std::vector<std::vector<Expr>> symbols_by_class(const Joint& joint, std::size_t body) {
  const BodySymbols s = body_symbols(joint, static_cast<int>(body));
  std::vector<Expr> inertia = {s.inv_I};
  if (is_tensor(s.inv_I)) {
    const Matrix components = tensor_matrix(s.inv_I);
    inertia.insert(inertia.end(), components.entries.begin(), components.entries.end());
  }
  return {{s.inv_m}, inertia, {s.w}, {s.v}};
}

// One for the other, the other for the one, or both exchanged.
void add_exchanges(const std::vector<Expr>& ours, const std::vector<Expr>& theirs, std::vector<Exchange>& all) {
  Exchange forth, back;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    forth.replacements.emplace(&*ours[i], theirs[i]);
    back.replacements.emplace(&*theirs[i], ours[i]);
  }
  const std::string &one = ours[0]->symbol, &other = theirs[0]->symbol;
  forth.words = fmt::format("{} stands where {} belongs", one, other);
  back.words = fmt::format("{} stands where {} belongs", other, one);
  Exchange both = forth;
  both.replacements.insert(back.replacements.begin(), back.replacements.end());
  both.words = fmt::format("{} and {} are exchanged", one, other);
  all.insert(all.end(), {forth, back, both});
}

// Names a confusion of bodies that explains the difference; empty if none does.
std::string of_another_body(Expr hand, Expr generated, const Joint& joint, const Poses& poses) {
  for (const Exchange& exchange : exchanges(joint)) {
    if (poses.equal(substitute(hand, exchange.replacements, KeepNames::no), generated)) return exchange.words;
  }
  return "";
}

std::optional<Explained> whole_entry(const Place& place, Expr hand, Expr generated, const Poses& poses) {
  if (poses.equal(hand, -generated)) return Explained{"sign", "the sign is wrong"};
  const std::string exchanged = of_another_body(hand, generated, *place.joint, poses);
  if (!exchanged.empty()) return Explained{"wrong body", exchanged};
  for (const Expr other : place.elsewhere) {
    if (is_zero(other)) continue;
    if (poses.equal(hand, other) || poses.equal(hand, -other)) {
      return Explained{"wrong body", fmt::format("{} is what belongs to another body's column", text(hand))};
    }
  }
  const Expr zero = hand->pool->number(0);
  if (poses.equal(hand, zero)) return Explained{"missing term", "nothing stands here"};
  if (poses.equal(generated, zero)) return Explained{"extra term", "nothing belongs here"};
  if (const std::optional<double> k = poses.constant_ratio(hand, generated)) {
    return Explained{"factor", fmt::format("it is {:.6g} times what it should be", *k)};
  }
  return std::nullopt;
}

// Explains the difference by one moving leaf: its contribution to this entry, once or twice.
std::optional<Explained> single_source(const Place& place, Expr difference, const Poses& poses) {
  for (const Contribution& source : place.sources) {
    if (is_zero(source.term)) continue;
    const std::string term = text(source.term), why = where_from(source, *place.joint);
    if (poses.equal(difference, -source.term)) {
      return Explained{"missing term", fmt::format("the hand derivation lacks {}: {}", term, why)};
    }
    if (poses.equal(difference, Rational(-2) * source.term)) {
      return Explained{"sign", fmt::format("the term {} has the wrong sign: {}", term, why)};
    }
    if (poses.equal(difference, source.term)) {
      return Explained{"extra term", fmt::format("{} is counted twice: {}", term, why)};
    }
  }
  return std::nullopt;
}

// Explains leftover terms of both sides that differ by one factor.
std::optional<Explained> by_factor(const Leftover& left, Expr has, Expr lacks, const Poses& poses) {
  if (left.hand.size() != left.generated.size()) return std::nullopt;
  for (const Term& theirs : left.generated) {
    const Factors f = leftover_factors(left.hand[0], theirs);
    if (f.rest->kind == Kind::number || !poses.equal(has * f.generated, lacks * f.hand)) continue;
    const Factors inside = leftover_factors({Rational(1), f.hand}, {Rational(1), f.generated});  // of a let
    const Expr missing = is_one(inside.hand) ? inside.generated : f.generated * pow(f.hand, -1);
    if (f.hand->named_by_let && missing->kind == Kind::symbol)
      return Explained{"factor", fmt::format("the factor {} is missing in {}", spoken(missing), f.hand->name)};
    const std::string ours = spoken(f.hand), right = spoken(f.generated), where = spoken(has);
    const std::string at = where.size() > longest_formula ? "" : " in " + where;
    if (is_one(f.hand)) return Explained{"factor", fmt::format("the factor {} is missing{}", right, at)};
    if (is_one(f.generated)) return Explained{"factor", fmt::format("the factor {} does not belong{}", ours, at)};
    if (ours.size() + right.size() > longest_formula) return std::nullopt;
    return Explained{"factor", fmt::format("the factor {} stands where {} belongs", ours, right), unspecific};
  }
  return std::nullopt;
}

Explained by_terms(const Place& place, Expr hand, Expr generated, const Poses& poses, Opened opened) {
  Pool& pool = *hand->pool;
  const Leftover left = leftover_terms(hand, generated, *place.joint, opened);
  const Expr has = sum_of(left.hand, pool), lacks = sum_of(left.generated, pool);
  const std::string ours = spoken(has), theirs = spoken(lacks);
  const bool brief = ours.size() + theirs.size() <= longest_formula;
  const std::size_t effort = ours.size() + theirs.size();
  if (is_zero(has)) {
    return {"missing term", fmt::format("the hand derivation lacks {}", brief ? theirs : "terms"), effort};
  }
  if (is_zero(lacks)) {
    return {"extra term", brief ? fmt::format("{} does not belong here", ours) : "it has terms that do not belong here",
            effort};
  }
  const std::string sentence = instead(introduced(has, *place.joint), theirs);
  if (poses.equal(has, -lacks)) return {"sign", sentence, effort};
  const std::string other = of_another_body(has, lacks, *place.joint, poses);
  if (!other.empty()) return {"wrong body", fmt::format("{}: {}", sentence, other), effort};
  if (std::optional<Explained> factor = by_factor(left, has, lacks, poses)) {
    factor->effort += std::min(effort, factor->sentence.size());
    return *factor;
  }
  return {"factor", sentence, effort + 2 * unspecific};
}

Explained explained(const Place& place, Expr hand, Expr generated, Expr difference, const Poses& poses) {
  if (const auto whole = whole_entry(place, hand, generated, poses)) return *whole;
  if (const auto source = single_source(place, difference, poses)) return *source;
  std::optional<Explained> best;
  for (const Opened opened : all_openings) {
    Explained next = by_terms(place, hand, generated, poses, opened);
    if (!best || next.effort < best->effort) best = std::move(next);
  }
  return *best;
}

}  // namespace

std::vector<Exchange> exchanges(const Joint& joint) {
  std::vector<Exchange> all;
  for (std::size_t a = 0; a < joint.bodies.size(); ++a) {
    for (std::size_t b = a + 1; b < joint.bodies.size(); ++b) {
      const auto ours = symbols_by_class(joint, a), theirs = symbols_by_class(joint, b);
      for (std::size_t c = 0; c < ours.size(); ++c) add_exchanges(ours[c], theirs[c], all);
    }
  }
  std::vector<Expr> arms;
  for (const Parameter& p : joint.parameters) {
    if (p.kind == ParameterKind::point && p.body >= 0) arms.push_back(p.symbol);
  }
  for (std::size_t i = 0; i < arms.size(); ++i) {
    for (std::size_t j = i + 1; j < arms.size(); ++j) add_exchanges({arms[i]}, {arms[j]}, all);
  }
  return all;
}

std::string name_of(const Place& place) {
  const auto is_digit = [](const std::string& s) { return s.find_first_not_of("0123456789") == s.npos; };
  std::string s = place.what;
  if (!place.row.empty()) s += ", row " + place.row;
  if (!place.column.empty()) s += (is_digit(place.column) ? ", column " : ", ") + place.column;
  return s;
}

std::string in_names_of_spec(std::string text, const Joint& joint) {
  if (joint.dimension == 2) return text;
  std::vector<std::string> frames;
  for (const Parameter& p : joint.parameters) {
    if (p.kind == ParameterKind::frame) frames.push_back(p.name);
  }
  for (const std::string& body : joint.bodies) frames.push_back("axis_" + body);
  for (const std::string& frame : frames) {
    if (text.find(frame + "_") == text.npos) continue;  // to make a regex takes longer
    const std::string name = frame.starts_with("axis_") ? frame.substr(5) : frame;
    text = std::regex_replace(text, std::regex("\\b" + frame + "_([xyz])\\b"), name + ".$1");
  }
  return text;
}

Difference describe_difference(const Place& place, Expr hand, Expr generated, const Poses& poses) {
  const Expr difference = difference_of(hand, generated, *place.joint);
  const Explained why = explained(place, hand, generated, difference, poses);
  Difference d;
  d.what = place.what;
  d.row = place.row;
  d.column = place.column;
  d.kind = why.kind;
  d.generated = brief_text(generated, *place.joint);
  d.hand = brief_text(hand, *place.joint);
  if (d.hand == d.generated) d.hand = text_unnamed(hand), d.generated = text_unnamed(generated);  // one name for both
  d.difference = text(difference);
  d.sentence = fmt::format("{}: {}", name_of(place), why.sentence);
  return d;
}

}  // namespace cdot::derive
