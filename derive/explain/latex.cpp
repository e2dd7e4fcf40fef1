// The derivation as an article that compiles with amsmath alone.
#include <map>
#include <set>

#include "derive/explain/write.hpp"

namespace cdot::derive {
namespace {

constexpr std::size_t line_width = 70;  // of the text that a line of formulas stands for

std::string escaped(const std::string& s) {
  std::string out;
  for (const char c : s) {
    switch (c) {
      case '\\': out += "\\textbackslash{}"; break;
      case '^': out += "\\textasciicircum{}"; break;
      case '~': out += "\\textasciitilde{}"; break;
      case '&':
      case '%':
      case '$':
      case '#':
      case '_':
      case '{':
      case '}': out += '\\'; [[fallthrough]];
      default: out += c;
    }
  }
  return out;
}

// Signs beyond ASCII that the generator's own words contain; and `code` between backticks.
std::string prose(const std::string& s) {
  static const std::map<std::string, std::string> signs = {
      {"×", "$\\times$"}, {"·", "$\\cdot$"}, {"≥", "$\\ge$"}, {"≤", "$\\le$"}};
  std::string out = escaped(s);
  for (const auto& [sign, command] : signs) {
    for (std::size_t at = 0; (at = out.find(sign, at)) != std::string::npos; at += command.size()) {
      out.replace(at, sign.size(), command);
    }
  }
  bool code = false;
  for (std::size_t at = 0; (at = out.find('`', at)) != std::string::npos; code = !code) {
    out.replace(at, 1, code ? "}" : "\\texttt{");
  }
  return out;
}

std::string letter_of(const std::string& letter, bool vector) {
  static const std::set<std::string> greek = {"alpha", "beta",   "gamma", "delta", "theta", "lambda",
                                              "mu",    "varphi", "psi",   "omega", "pi"};
  const std::string name = letter == "phi" ? "varphi" : letter;
  if (greek.contains(name)) return "\\" + name;
  if (vector) return "\\mathbf{" + escaped(letter) + "}";
  return letter.size() == 1 ? letter : "\\mathit{" + escaped(letter) + "}";
}

class Latex : public FormulaWriter {
 public:
  explicit Latex(const std::vector<std::string>& bodies) : bodies_(bodies) {}

 protected:
  std::string name(const Formula& leaf) const override {
    const SpelledName s = spell(leaf.name, bodies_);
    std::string out = letter_of(s.letter, leaf.leaf && leaf.leaf->vector);
    if (s.dots > 0) out = (s.dots == 1 ? "\\dot{" : "\\ddot{") + out + "}";
    const bool word = s.index.size() > 1;
    if (!s.index.empty()) out += word ? "_{\\text{" + escaped(s.index) + "}}" : "_{" + s.index + "}";
    return s.inverse ? out + "^{-1}" : out;
  }
  std::string number(Rational value) const override {
    if (value.is_integer()) return value.text();
    return fraction(std::to_string(value.num()), std::to_string(value.den()));
  }
  std::string sign(bool minus, bool first) const override {
    return first ? (minus ? "-" : "") : (minus ? " - " : " + ");
  }
  std::string between(Shape shape) const override {
    return shape == Shape::dot ? " \\cdot " : shape == Shape::cross ? " \\times " : "\\, ";
  }
  std::string fraction(const std::string& above, const std::string& below) const override {
    return "\\frac{" + above + "}{" + below + "}";
  }
  std::string power(const std::string& base, int exponent) const override {
    return "{" + base + "}^{" + std::to_string(exponent) + "}";
  }
  std::string call(const std::string& f, const std::vector<std::string>& args) const override {
    std::string inner;
    for (std::size_t i = 0; i < args.size(); ++i) inner += (i ? ", " : "") + args[i];
    return "\\operatorname{" + f + "}" + parentheses(inner);
  }
  std::string norm(const std::string& arg) const override { return "\\left\\lvert " + arg + " \\right\\rvert"; }
  std::string component(const std::string& arg, const std::string& axis) const override {
    return "{" + arg + "}_{" + axis + "}";
  }
  std::string transpose(const std::string& arg) const override { return "{" + arg + "}^{\\mathsf T}"; }
  std::string identity() const override { return "E"; }
  std::string matrix(int columns, const std::vector<std::string>& entries) const override {
    std::string form, body;
    for (int i = 0; i < columns; ++i) form += i == 0 ? "c" : "|c";
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (i > 0) body += i % static_cast<std::size_t>(columns) == 0 ? " \\\\ " : " & ";
      body += entries[i];
    }
    return "\\left[\\begin{array}{" + form + "} " + body + " \\end{array}\\right]";
  }
  std::string parentheses(const std::string& inner) const override { return "\\left(" + inner + "\\right)"; }

 private:
  const std::vector<std::string>& bodies_;
};

// About how wide a formula is set: commands count as one sign.
std::size_t set_width(const std::string& latex) {
  std::size_t width = 0;
  for (std::size_t i = 0; i < latex.size(); ++i, ++width) {
    if (latex[i] == '\\') {
      while (i + 1 < latex.size() && std::isalpha(static_cast<unsigned char>(latex[i + 1]))) ++i;
    }
  }
  return width;
}

// Rules stand under their formula, one a line, where they never run off the page.
std::vector<std::string> rule_lines(const std::string& rules) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < rules.size();) {
    const std::size_t end = std::min(rules.find("; ", at), rules.size());
    lines.push_back((at == 0 ? "(" : "") + rules.substr(at, end - at) + (end == rules.size() ? ")" : ";"));
    at = end + 2;
  }
  return lines;
}

std::string chain_latex(const Chain& chain, const Latex& formula) {
  std::string out = "\\begin{align*}\n  " + formula.write(chain.left);
  for (std::size_t i = 0; i < chain.links.size(); ++i) {
    const Link& link = chain.links[i];
    out += (i == 0 ? " &= " : " \\\\\n  &= ");
    std::size_t used = 0;
    for (const std::string& piece : formula.pieces(link.formula)) {
      const std::size_t width = set_width(piece);
      if (used > 0 && used + width > line_width) {
        out += " \\\\\n  &\\quad ";
        used = 0;
      }
      out += piece;
      used += width;
    }
    for (const std::string& line : rule_lines(link.rule)) {
      out += " \\\\\n  &\\quad \\text{\\small " + prose(line) + "}";
    }
  }
  return out + "\n\\end{align*}\n";
}

}  // namespace

std::string explanation_latex(const Explanation& explanation) {
  const Latex formula(explanation.bodies);
  std::string out =
      "\\documentclass[a4paper]{article}\n\\usepackage{amsmath}\n\\allowdisplaybreaks\n"
      "\\setlength{\\parindent}{0pt}\n\\title{" +
      escaped(explanation.title) + "}\n\\author{}\n\\date{}\n\\begin{document}\n\\maketitle\n";
  for (const Step& step : explanation.steps) {
    out += "\n\\section{" + escaped(step.heading) + "}\n";
    bool in_list = false;
    for (const Item& item : step.items) {
      const bool bullet = item.kind == Item::Kind::bullet;
      if (bullet != in_list) out += bullet ? "\\begin{itemize}\n" : "\\end{itemize}\n";
      in_list = bullet;
      if (item.kind == Item::Kind::chain) {
        out += chain_latex(item.chain, formula);
        continue;
      }
      out += (bullet ? "\\item " : "\n") +
             fill(item.words, prose, [&formula](const Formula& f) { return "$" + formula.write(f) + "$"; }) +
             (bullet ? "\n" : "\n\n");
    }
    if (in_list) out += "\\end{itemize}\n";
  }
  return out + "\\end{document}\n";
}

}  // namespace cdot::derive
