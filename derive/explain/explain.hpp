// The derivation of a joint as a good teacher writes it: steps with headings, chains of equal formulas, and the rule
// that leads from each to the next. One source of steps, one writer for each format.
#pragma once

#include <string>
#include <vector>

#include "derive/derivation/forms.hpp"
#include "derive/explain/formula.hpp"

namespace cdot::derive {

// Words with a formula for each `{}`.
struct Words {
  std::string text;
  std::vector<Formula> formulas;
};

// "= formula", and the rule that led to it.
struct Link {
  Formula formula;
  std::string rule;
};

struct Chain {
  Formula left;
  std::vector<Link> links;
};

struct Item {
  enum class Kind { paragraph, bullet, chain };
  Kind kind = Kind::paragraph;
  Words words;  // of a paragraph or bullet
  Chain chain;
};

struct Step {
  std::string heading;
  std::vector<Item> items;

  void say(std::string text, std::vector<Formula> formulas = {});
  void list(std::string text, std::vector<Formula> formulas = {});
  void show(Chain chain);
};

struct Explanation {
  std::string title;
  std::vector<std::string> bodies;  // for writers that set `ra` as r with index a
  std::vector<Step> steps;
};

// In space J by w in world axes, and in another form of velocity besides if that is asked for.
Explanation explain(const Derivation& derivation, Form form = Form::global);

std::string explanation_text(const Explanation& explanation);
std::string explanation_html(const Explanation& explanation);   // one file, no links to elsewhere
std::string explanation_latex(const Explanation& explanation);  // an article that needs amsmath only

// The names, C, J and K of the joint, then of each of its coordinates, without the way to them.
std::vector<std::vector<Chain>> summarise(const Derivation& derivation);
// For a terminal or a comment: one or more whole lines.
std::string chain_text(const Chain& chain, std::size_t page_width);
// "\mathbf{u} = …" without its rules, for a page that sets formulas.
std::string chain_latex(const Chain& chain, const std::vector<std::string>& bodies);

// C, Cdot, dC/dt, J, K and gamma as plain infix expressions for other programs; explain/formats/json.cpp gives the
// schema.
std::string explanation_json(const Derivation& derivation);

}  // namespace cdot::derive
