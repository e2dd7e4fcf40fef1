#include "derive/syntax/parse_law.hpp"

namespace cdot::derive {
namespace {

// "[" expression "," expression "]", after the word before it
void range(Parser& p, StatementAst& s) {
  if (p.failed()) return;
  p.take();
  if (!p.expect("[", "before the lower bound")) return;
  s.lower = p.expression();
  if (!p.expect(",", "between the lower and the upper bound")) return;
  s.upper = p.expression();
  p.expect("]", "after the upper bound");
}

bool at_rate(const Parser& p, int ahead) { return p.at_word("rate", ahead) && p.at_symbol("(", ahead + 1); }

// "rate" "(" NAME ")" "=" expression
RateAst rate(Parser& p) {
  p.take(), p.take();
  RateAst rate{p.name("the coordinate"), {}};
  const std::string name = rate.coordinate.text;
  p.expect(")", "after the coordinate");
  if (!p.failed() && !p.accept("="))
    p.fail(p.peek().where, "`=` is missing after `rate(" + name + ")`: " + p.found(),
           "write rate(" + name + ") = ..., force in [-most, most]");
  rate.value = p.expression();
  return rate;
}

// "norm" "(" "force" ")" "<=" expression
void norm_of_force(Parser& p, StatementAst& s) {
  if (!p.at_word("norm") || !p.at_symbol("(", 1) || !p.at_word("force", 2) || !p.at_symbol(")", 3) ||
      !p.at_symbol("<=", 4))
    return p.fail(p.peek().where, "one bound of the force along all these coordinates must follow: " + p.found(),
                  "write norm(force) <= most");
  for (int k = 0; k < 5; ++k) p.take();
  s.upper = p.expression();
}

void prescribed_rates(Parser& p, StatementAst& s) {
  RateAst first = rate(p);
  s.bounded = std::move(first.coordinate), s.left = std::move(first.value);
  while (!p.failed() && p.at_symbol(",") && at_rate(p, 1)) {
    p.take();
    s.across.push_back(rate(p));
  }
  if (p.failed()) return;
  const bool bounded = p.at_symbol(",") && !p.at_word("after", 1) && !p.at_word("until", 1);
  if (bounded) p.take();
  if (!s.across.empty()) return norm_of_force(p, s);
  if (!bounded) return;
  if (!p.at_word("force") || !p.at_word("in", 1))
    return p.fail(p.peek().where, "the bounds of the force must follow: " + p.found(), "write force in [-most, most]");
  p.take();
  range(p, s);
}

// ( "after" | "until" ) expression ( ">=" | "<=" ) expression
void event(Parser& p, StatementAst& s) {
  const Token first = p.peek();
  if (!p.at_word("after") && !p.at_word("until"))
    return p.fail(first.where, "an event must follow: " + p.found(), "write after time >= 2 [s], or until ...");
  std::optional<ConditionAst>& condition = p.at_word("after") ? s.after : s.until;
  if (condition)
    return p.fail(first.where, "the row has two events " + quote(first.text), "write one, of the first of both",
                  {condition->where});
  p.take();
  condition.emplace();
  condition->left = p.expression();
  if (p.failed()) return;
  condition->at_least = p.at_symbol(">=");
  if (!p.accept(">=") && !p.accept("<="))
    return p.fail(p.peek().where, "`>=` or `<=` is missing in the condition: " + p.found(),
                  "write " + std::string(first.text) + " time >= 2 [s]");
  condition->right = p.expression();
  condition->where = p.from(first);
}

// "joint" "," "until" condition
void rows_of_joint(Parser& p, StatementAst& s) {
  p.take();
  s.of_joint = true;
  if (!p.accept(","))
    return p.fail(p.peek().where, "the event that breaks the joint must follow: " + p.found(),
                  "write bond: joint, until load(bond) >= strength");
  event(p, s);
}

}  // namespace

void parse_law(Parser& p, StatementAst& s) {
  const std::string word(p.take().text);
  s.torque = word == "torque";
  if (word != "energy") {
    if (!p.at_word("on"))
      p.fail(p.peek().where, "`on` is missing after " + quote(word) + ": " + p.found(),
             s.torque ? "write torque on a = ..." : "write force on NAME = ..., with a coordinate or a point");
    else p.take();
    s.label = p.name(s.torque ? "the body" : "the coordinate or the point");
  }
  if (!p.failed() && !p.accept("=") && word != "energy")
    p.fail(p.peek().where, "`=` is missing after " + quote(word + " on " + s.label.text) + ": " + p.found());
  s.left = p.expression();
  if (word != "force" || p.failed() || !p.accept(",")) return;
  if (p.at_word("within")) return range(p, s);
  p.fail(p.peek().where, "the limits of the force must follow: " + p.found(), "write within [-most, most]");
}

// A name and its colon may come first.
bool at_bounded_row(const Parser& p) {
  const int first = p.at_name() && p.at_symbol(":", 1) ? 2 : 0;
  if (at_rate(p, first) || p.at_word("joint", first)) return true;
  const auto then = [&](std::string_view symbol) { return p.at_symbol(symbol, first + 1); };
  return p.at_name(first) && (then(">=") || then("<=") || p.at_word("in", first + 1));
}

void parse_bounded_row(Parser& p, StatementAst& s) {
  if (p.at_symbol(":", 1)) {
    s.label = p.name("the name of the row");
    p.take();
  }
  s.relation_where = p.peek().where;
  s.of_rate = at_rate(p, 0);
  if (p.at_word("joint")) return rows_of_joint(p, s);
  if (!s.of_rate) s.bounded = p.name("the coordinate");
  if (s.of_rate) prescribed_rates(p, s);
  else if (p.accept(">=")) s.lower = p.expression();
  else if (p.accept("<=")) s.upper = p.expression();
  else range(p, s);
  while (!p.failed() && p.accept(",")) event(p, s);
}

}  // namespace cdot::derive
