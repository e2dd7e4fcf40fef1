// The derivation as one page that needs nothing else: MathML, which browsers set themselves, and a
// style sheet for light and dark.
#include "runtime/text/html.hpp"

#include <map>
#include <utility>

#include "derive/explain/formats/mathml.hpp"
#include "derive/explain/formats/write.hpp"

namespace cdot::derive {

std::string html_prose(const std::string& s) {
  std::string out;
  bool code = false;
  for (const char c : text::html_escaped(s)) {
    if (c != '`') {
      out += c;
      continue;
    }
    out += code ? "</code>" : "<code>";
    code = !code;
  }
  return out;
}

namespace {

std::string greek(const std::string& letter) {
  static const std::map<std::string, std::string> letters = {
      {"alpha", "α"}, {"beta", "β"}, {"gamma", "γ"}, {"delta", "δ"}, {"theta", "θ"}, {"lambda", "λ"},
      {"mu", "μ"},    {"phi", "φ"},  {"psi", "ψ"},   {"omega", "ω"}, {"pi", "π"}};
  const auto found = letters.find(letter);
  return found == letters.end() ? letter : found->second;
}

std::string name(const Formula& leaf, const std::vector<std::string>& bodies) {
  const SpelledName s = spell(leaf.name, bodies);
  const bool vector = leaf.leaf && leaf.leaf->vector;
  std::string base = filled(vector ? "<mi mathvariant=\"normal\" class=\"vector\">#1</mi>" : "<mi>#1</mi>",
                            text::html_escaped(greek(s.letter)));
  if (s.dots > 0) base = filled("<mover accent=\"true\">#1<mo>#2</mo></mover>", base, s.dots == 1 ? "˙" : "¨");
  const std::string index = "<mtext>" + text::html_escaped(s.index) + "</mtext>";
  if (s.inverse) base = filled("<msubsup>#1#2<mrow><mo>−</mo><mn>1</mn></mrow></msubsup>", base, index);
  else if (!s.index.empty()) base = filled("<msub>#1#2</msub>", base, index);
  // For scripts: the name as the spec has it.
  return base.insert(base.find_first_of(" >"), " data-name=\"" + text::html_escaped(leaf.name) + "\"");
}

#define FENCE(sign) "<mo stretchy=\"true\" fence=\"true\">" sign "</mo>"
// clang-format off
const FormulaStyle mathml = {
    .name = name, .opening_minus = "<mo>−</mo>", .minus = "<mo>−</mo>", .plus = "<mo>+</mo>",
    .product = "<mspace width=\"0.17em\" />", .dot = "<mo>·</mo>", .cross = "<mo>×</mo>", .comma = "<mo>,</mo>",
    .integer = "<mn>#1</mn>", .negative = "<mrow><mo>−</mo>#1</mrow>",
    .fraction = "<mfrac><mrow>#1</mrow><mrow>#2</mrow></mfrac>", .power = "<msup><mrow>#1</mrow>#2</msup>",
    .call = "<mrow><mi mathvariant=\"normal\">#1</mi><mo>&#8289;</mo>"
            "<mrow>" FENCE("(") "#2" FENCE(")") "</mrow></mrow>",
    .norm = "<mrow>" FENCE("|") "#1" FENCE("|") "</mrow>", .component = "<msub><mrow>#1</mrow><mi>#2</mi></msub>",
    .transpose = "<msup><mrow>#1</mrow><mi mathvariant=\"normal\">T</mi></msup>",
    .identity = "<mi mathvariant=\"normal\">E</mi>", .parentheses = "<mrow>" FENCE("(") "#1" FENCE(")") "</mrow>",
    .matrix = "<mtable class=\"matrix\"><mtr>#1</mtr></mtable>",  // its brackets are borders: only fonts for formulas stretch
    .entry = "<mtd>#1</mtd>", .next_entry = "", .next_row = "</mtr><mtr>"};
// clang-format on
#undef FENCE

// Where indices and exponents stand. A browser takes this from the table MATH of the first font of a formula, and fonts
// for text have none: indices then stand on the baseline. This font, of our own, has that table, with the proportions
// of TeX, and no letter but the space: the letters come from the next font of the list.
// As WOFF2, in base64:
constexpr const char* math_font =
    "d09GMgABAAAAAAGMAAsAAAAAA3QAAAFCAAEAAAAAAAAAAAAAAAAAAAAAAAAAAAAAH4FyBmAANAocNgE2AiQDCAsGAAQgBWYHIBvD"
    "AhAeB3ZzTquwa7X4MJDi4b/9aPfNzKoB8YNn9+RJXLsl0SjWCIm0CbPToW1EpXiBq3P8jeOJBqIbJ9yXFQYd8Zo2eyIZcnE43egh"
    "6DwINeuFBBq902eeyTXdNd2uEAOIXtI1vCa24jqxgxiInfiF68RWjMcpPMQp0lLiAekOsYx0H0eJAdhDWoqHuEec7fwIHMVIRMRq"
    "rK0YOhKXeEbRj79vMRlAN4AcN+KcGoVhAKaVQaXK1f/x5MpDgOhNUIGEjG5ZoFtRoSgC1f//2fj/ewEggYJAQQ2ggKA0tdQ0jzzn"
    "HBAIPjz7e03b5K/1kfvg5FAlI0ezLIFgZ1R8wcY4JwAAKb4Q8xFIigAJAADFWAFCAwIkdRpkURqETu2wSatBszbuOfgYp2vWxs2y"
    "0R4HVeZb56Ctlthki0N2Wme/zAAA";

constexpr const char* style = R"(
:root {
  color-scheme: light dark;
  --ink: #1c1c1e; --paper: #fdfdfb; --soft: #6a6a70; --line: #dcdcd6; --block: #f3f3ee;
}
@media (prefers-color-scheme: dark) {
  :root { --ink: #e8e8e3; --paper: #17181a; --soft: #9a9aa2; --line: #34363a; --block: #202225; }
}
body {
  margin: 0 auto; max-width: 60rem; padding: 2rem 1.2rem 4rem;
  color: var(--ink); background: var(--paper);
  font: 1.05rem/1.55 Georgia, "Times New Roman", serif;
}
h1 { font-size: 1.9rem; margin: 0 0 1rem; }
h2 { font-size: 1.25rem; margin: 2.2rem 0 .6rem; padding-top: .8rem; }
h2 { border-top: 1px solid var(--line); }
ul { padding-left: 1.3rem; }
li { margin: .25rem 0; }
code {
  font: .92em/1.4 ui-monospace, Menlo, Consolas, monospace;
  background: var(--block); padding: .1em .3em; border-radius: 3px;
}
.chain {
  overflow-x: auto; margin: .35rem 0; padding: .3rem 0 .3rem 1rem;
  border-left: 3px solid var(--line);
}
.chain table { border-collapse: collapse; }
.chain td { padding: .12rem .3rem; vertical-align: baseline; }
.chain td.left { text-align: right; white-space: nowrap; }
.chain td.rule {
  color: var(--soft); font-size: .86rem; font-style: italic;
  padding-left: 1.4rem; min-width: 12rem;
}
math {
  font-size: 1.08em;
  font-family: "Latin Modern Math", "STIX Two Math", "Cambria Math", "DejaVu Math TeX Gyre", "Cdot Math", serif;
}
mi.vector { font-weight: bold; }
.matrix mtd { padding: .15em .5em; }
.matrix {
  --bar: linear-gradient(currentcolor 0 0) no-repeat;
  margin: 0 .15em; border: solid; border-width: 0 .08em;
  background: var(--bar) 0 0 / .35em .08em, var(--bar) 0 100% / .35em .08em,
    var(--bar) 100% 0 / .35em .08em, var(--bar) 100% 100% / .35em .08em;
}
)";

constexpr std::string_view math = "<math><mrow>#1</mrow></math>";

std::string item(const std::string& words, bool bullet) {
  return filled(bullet ? "<li>#1</li>\n" : "<p>#1</p>\n", words);
}

std::string chain(const Chain& chain, const FormulaWriter& formula) {
  std::string out = "<div class=\"chain\"><table>\n", left = filled(math, formula.write(chain.left));
  for (const Link& link : chain.links) {
    out += "<tr><td class=\"left\">" + std::exchange(left, "") + "</td><td>" +
           filled(math, "<mo>=</mo>" + formula.write(link.formula)) + "</td><td class=\"rule\">" +
           text::html_escaped(link.rule) + "</td></tr>\n";
  }
  return out + "</table></div>\n";
}

std::string head(const std::string& title) { return html_head(title); }

}  // namespace

std::string html_head(const std::string& plain_title, std::string_view more_style) {
  const std::string title = text::html_escaped(plain_title);
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\" />\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\" />\n<title>" +
         title + "</title>\n<style>\n@font-face { font-family: \"Cdot Math\"; src: url(data:font/woff2;base64," +
         math_font + "); }" + style + std::string(more_style) + "</style>\n</head>\n<body>\n<h1>" + title + "</h1>\n";
}

std::string in_mathml(const Formula& formula, const std::vector<std::string>& bodies) {
  return filled(math, FormulaWriter(mathml, bodies).write(formula));
}

std::string explanation_html(const Explanation& explanation) {
  return written(explanation, {mathml, head, html_foot, "<h2>#1. #2</h2>\n", "<ul>\n", "</ul>\n", math,
                               text::html_escaped, html_prose, item, chain});
}

}  // namespace cdot::derive
