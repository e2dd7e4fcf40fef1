// A let of the entry that stands for something else than the spec's: all differences come from that one name.
#include "derive/diff/slips/slips.hpp"

namespace cdot::derive {
namespace {

constexpr std::size_t most_pairs = 1000, longest_formula = 60;

// The lets of the entry, and what the generated matrix has of their kind.
std::vector<Expr> own_lets(const Whole& whole) {
  std::vector<Expr> own;
  for (const Expr node : topological(whole.hand.entries)) {
    const bool of_spec = std::ranges::any_of(whole.entry.joint.lets, [&](const Let& l) { return l.value == node; });
    if (node->named_by_let && !of_spec && !is_tensor(node)) own.push_back(node);
  }
  return own;
}

// The difference between the value of a let and what belongs there, in words.
Slip in_name(const Whole& whole, Expr stands, Expr belongs) {
  const auto column = [](const std::vector<Expr>& e) { return Matrix{static_cast<int>(e.size()), 1, e}; };
  const bool vector = stands->vector;
  const Matrix published = column(vector ? components_of(stands) : std::vector{stands});
  const Matrix generated = column(vector ? components_of(belongs) : std::vector{belongs});
  const Place place{"in " + stands->name, "", "", {}, {}, &whole.entry.joint};
  const Sides sides{place.what, published, generated, {{0, published.rows, ""}}, {{}}};
  std::vector<bool> wrong(published.entries.size());
  const auto in_words_of = [&](int r, int) {
    return describe_difference(place, published.at(r, 0), generated.at(r, 0), whole.entry.poses());
  };
  const std::vector<Difference> told = differences_of(whole.entry, sides, in_words_of, wrong);
  const auto in_words = [&](Expr e) { return in_names_of_spec(text(e), whole.entry.joint); };
  const Expr negative = -belongs;  // of a name: what it stands for
  Slip slip{"factor", "", negative->name.empty() ? in_words(belongs) : "-(" + in_words(negative) + ")",
            in_words(stands), in_words(stands - belongs)};
  const bool explained = told.size() == 1 && told[0].sentence.find(not_generated) == std::string::npos &&
                         told[0].sentence.find("it has " + stands->name + " where") == std::string::npos;
  if (explained) slip.kind = told[0].kind, slip.sentence = told[0].sentence;
  else if (slip.generated.size() <= longest_formula && slip.generated != stands->name)
    slip.sentence = fmt::format("{} stands where {} belongs", stands->name, slip.generated);
  else slip.sentence = fmt::format("in {}: {}", stands->name, not_generated);
  return slip;
}

// belongs or -belongs, whichever is nearer to what stands there: a J has either sign.
Expr nearer_sign(const Whole& whole, Expr stands, Expr belongs) {
  double apart = 0;
  for (const Sample& sample : whole.samples()) {
    const List is = values_at(components_of(stands), sample), right = values_at(components_of(belongs), sample);
    for (std::size_t i = 0; i < is.size(); ++i) apart += std::abs(is[i] - right[i]) - std::abs(is[i] + right[i]);
  }
  return apart > 0 ? -belongs : belongs;
}

}  // namespace

std::optional<Slip> slip_of_name(const Whole& whole) {
  if (!whole.part) return {};  // a claim has both sides: its words tell more
  const std::vector<Expr> own = own_lets(whole), nodes = topological(whole.mine.entries);
  if (own.size() * nodes.size() > most_pairs) return {};
  for (const Expr stands : own)
    for (const Expr belongs : nodes) {
      if (belongs->vector != stands->vector || is_tensor(belongs) || belongs->kind == Kind::number) continue;
      for (const Rational sign : {Rational(1), Rational(-1)})
        if (whole.is_right_with({{&*stands, sign * belongs}}))
          return in_name(whole, stands, whole.what == "J" ? nearer_sign(whole, stands, belongs) : sign * belongs);
    }
  return {};
}

}  // namespace cdot::derive
