// The derivation as an article that compiles with amsmath alone.
#include <map>
#include <set>

#include "derive/explain/formats/write.hpp"

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

std::string name(const Formula& leaf, const std::vector<std::string>& bodies) {
  const SpelledName s = spell(leaf.name, bodies);
  std::string out = letter_of(s.letter, leaf.leaf && leaf.leaf->vector);
  if (s.dots > 0) out = (s.dots == 1 ? "\\dot{" : "\\ddot{") + out + "}";
  const bool word = s.index.size() > 1;
  if (!s.index.empty()) out += word ? "_{\\text{" + escaped(s.index) + "}}" : "_{" + s.index + "}";
  return s.inverse ? out + "^{-1}" : out;
}

// clang-format off
const FormulaStyle style = {
    .name = name, .opening_minus = "-", .minus = " - ", .plus = " + ",
    .product = "\\, ", .dot = " \\cdot ", .cross = " \\times ", .comma = ", ",
    .integer = "#1", .negative = "-#1", .fraction = "\\frac{#1}{#2}", .power = "{#1}^{#2}",
    .call = "\\operatorname{#1}\\left(#2\\right)", .norm = "\\left\\lvert #1 \\right\\rvert",
    .component = "{#1}_{#2}", .transpose = "{#1}^{\\mathsf T}", .identity = "E", .parentheses = "\\left(#1\\right)",
    .matrix = "\\left[\\begin{array}{#2} #1 \\end{array}\\right]",
    .entry = "#1", .next_entry = " & ", .next_row = " \\\\ "};
// clang-format on

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

std::string chain(const Chain& chain, const FormulaWriter& formula) {
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

std::string head(const std::string& title) {
  return "\\documentclass[a4paper]{article}\n\\usepackage{amsmath}\n\\allowdisplaybreaks\n"
         "\\setlength{\\parindent}{0pt}\n\\title{" +
         escaped(title) + "}\n\\author{}\n\\date{}\n\\begin{document}\n\\maketitle\n";
}

std::string item(const std::string& words, bool bullet) { return filled(bullet ? "\\item #1\n" : "\n#1\n\n", words); }

}  // namespace

std::string chain_latex(const Chain& chain, const std::vector<std::string>& bodies) {
  const FormulaWriter formula(style, bodies);
  std::string out = formula.write(chain.left);
  for (const Link& link : chain.links) out += " = " + formula.write(link.formula);
  return out;
}

std::string explanation_latex(const Explanation& explanation) {
  return written(explanation, {style, head, "\\end{document}\n", "\n\\section{#2}\n", "\\begin{itemize}\n",
                               "\\end{itemize}\n", "$#1$", escaped, prose, item, chain});
}

}  // namespace cdot::derive
