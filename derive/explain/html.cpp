// The derivation as one page that needs nothing else: MathML, which browsers set themselves, and a
// style sheet for light and dark.
#include <map>

#include "derive/explain/write.hpp"

namespace cdot::derive {
namespace {

std::string escaped(const std::string& s) {
  std::string out;
  for (const char c : s) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      default: out += c;
    }
  }
  return out;
}

// `code` between backticks.
std::string prose(const std::string& s) {
  std::string out;
  bool code = false;
  for (const char c : escaped(s)) {
    if (c != '`') {
      out += c;
      continue;
    }
    out += code ? "</code>" : "<code>";
    code = !code;
  }
  return out;
}

std::string greek(const std::string& letter) {
  static const std::map<std::string, std::string> letters = {
      {"alpha", "α"}, {"beta", "β"}, {"gamma", "γ"}, {"delta", "δ"}, {"theta", "θ"}, {"lambda", "λ"},
      {"mu", "μ"},    {"phi", "φ"},  {"psi", "ψ"},   {"omega", "ω"}, {"pi", "π"}};
  const auto found = letters.find(letter);
  return found == letters.end() ? letter : found->second;
}

std::string row(const std::string& inner) { return "<mrow>" + inner + "</mrow>"; }
std::string sign_of(const std::string& s) { return "<mo>" + s + "</mo>"; }
std::string fence(const std::string& s) { return "<mo stretchy=\"true\" fence=\"true\">" + s + "</mo>"; }

class MathML : public FormulaWriter {
 public:
  explicit MathML(const std::vector<std::string>& bodies) : bodies_(bodies) {}

 protected:
  std::string name(const Formula& leaf) const override {
    const SpelledName s = spell(leaf.name, bodies_);
    std::string base = identifier(greek(s.letter), leaf.leaf && leaf.leaf->vector);
    if (s.dots > 0) {
      base = "<mover accent=\"true\">" + base + sign_of(s.dots == 1 ? "˙" : "¨") + "</mover>";
    }
    const std::string index = "<mtext>" + escaped(s.index) + "</mtext>";
    const std::string minus_one = row(sign_of("−") + "<mn>1</mn>");
    if (s.inverse) return "<msubsup>" + base + index + minus_one + "</msubsup>";
    return s.index.empty() ? base : "<msub>" + base + index + "</msub>";
  }
  std::string number(Rational value) const override {
    const auto whole = [](std::int64_t n) { return "<mn>" + std::to_string(n) + "</mn>"; };
    if (value.is_integer()) return whole(value.num());
    return fraction(whole(value.num()), whole(value.den()));
  }
  std::string sign(bool minus, bool first) const override { return minus ? sign_of("−") : first ? "" : sign_of("+"); }
  std::string between(Shape shape) const override {
    if (shape == Shape::product) return "<mspace width=\"0.17em\" />";
    return sign_of(shape == Shape::dot ? "·" : "×");
  }
  std::string fraction(const std::string& above, const std::string& below) const override {
    return "<mfrac>" + row(above) + row(below) + "</mfrac>";
  }
  std::string power(const std::string& base, int exponent) const override {
    const std::string magnitude = "<mn>" + std::to_string(std::abs(exponent)) + "</mn>";
    return "<msup>" + row(base) + (exponent < 0 ? row(sign_of("−") + magnitude) : magnitude) + "</msup>";
  }
  std::string call(const std::string& f, const std::vector<std::string>& args) const override {
    std::string inner;
    for (std::size_t i = 0; i < args.size(); ++i) inner += (i ? sign_of(",") : "") + args[i];
    return row("<mi mathvariant=\"normal\">" + f + "</mi>" + sign_of("&#8289;") + parentheses(inner));
  }
  std::string norm(const std::string& arg) const override { return row(fence("|") + arg + fence("|")); }
  std::string component(const std::string& arg, const std::string& axis) const override {
    return "<msub>" + row(arg) + "<mi>" + axis + "</mi></msub>";
  }
  std::string transpose(const std::string& arg) const override {
    return "<msup>" + row(arg) + "<mi mathvariant=\"normal\">T</mi></msup>";
  }
  std::string identity() const override { return "<mi mathvariant=\"normal\">E</mi>"; }
  std::string matrix(int columns, const std::vector<std::string>& entries) const override {
    std::string rows;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const std::size_t column = i % static_cast<std::size_t>(columns);
      if (column == 0) rows += i == 0 ? "<mtr>" : "</mtr><mtr>";
      rows += "<mtd>" + entries[i] + "</mtd>";
    }
    return row(fence("[") + "<mtable class=\"matrix\">" + rows + "</mtr></mtable>" + fence("]"));
  }
  std::string parentheses(const std::string& inner) const override { return row(fence("(") + inner + fence(")")); }

 private:
  static std::string identifier(const std::string& letter, bool vector) {
    if (vector) return "<mi mathvariant=\"normal\" class=\"vector\">" + escaped(letter) + "</mi>";
    return "<mi>" + escaped(letter) + "</mi>";
  }

  const std::vector<std::string>& bodies_;
};

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
math { font-size: 1.08em; }
mi.vector { font-weight: bold; }
.matrix mtd { padding: .15em .5em; }
)";

std::string math(const std::string& inner) { return "<math>" + row(inner) + "</math>"; }

std::string chain_html(const Chain& chain, const MathML& formula) {
  std::string out = "<div class=\"chain\"><table>\n";
  for (std::size_t i = 0; i < chain.links.size(); ++i) {
    const Link& link = chain.links[i];
    out += "<tr><td class=\"left\">" + (i == 0 ? math(formula.write(chain.left)) : "") + "</td><td>" +
           math(sign_of("=") + formula.write(link.formula)) + "</td><td class=\"rule\">" + escaped(link.rule) +
           "</td></tr>\n";
  }
  return out + "</table></div>\n";
}

class Page {
 public:
  explicit Page(const Explanation& explanation) : formula_(explanation.bodies) {
    const std::string title = escaped(explanation.title);
    out_ =
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\" />\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\" />\n<title>" +
        title + "</title>\n<style>" + style + "</style>\n</head>\n<body>\n<h1>" + title + "</h1>\n";
    int number = 0;
    for (const Step& step : explanation.steps) {
      out_ += "<h2>" + std::to_string(++number) + ". " + escaped(step.heading) + "</h2>\n";
      for (const Item& item : step.items) add(item);
      close_list();
    }
    out_ += "</body>\n</html>\n";
  }

  const std::string& text() const { return out_; }

 private:
  void add(const Item& item) {
    if (item.kind != Item::Kind::bullet) close_list();
    if (item.kind == Item::Kind::chain) {
      out_ += chain_html(item.chain, formula_);
      return;
    }
    const std::string words = fill(item.words, prose, [this](const Formula& f) { return math(formula_.write(f)); });
    if (item.kind == Item::Kind::paragraph) {
      out_ += "<p>" + words + "</p>\n";
      return;
    }
    if (!in_list_) out_ += "<ul>\n";
    in_list_ = true;
    out_ += "<li>" + words + "</li>\n";
  }

  void close_list() {
    if (in_list_) out_ += "</ul>\n";
    in_list_ = false;
  }

  MathML formula_;
  std::string out_;
  bool in_list_ = false;
};

}  // namespace

std::string explanation_html(const Explanation& explanation) { return Page(explanation).text(); }

}  // namespace cdot::derive
