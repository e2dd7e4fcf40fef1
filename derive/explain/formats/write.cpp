// Precedence of written formulas, names taken apart, and the parts of a document in their order.
#include "derive/explain/formats/write.hpp"

#include <algorithm>
#include <cstdlib>

namespace cdot::derive {

SpelledName spell(const std::string& name, const std::vector<std::string>& bodies) {
  SpelledName s{name, "", 0, name.starts_with("inv_m_") || name.starts_with("inv_I_")};
  if (s.inverse) s.letter = name.substr(4);
  if (const std::size_t bracket = name.find('['); bracket != std::string::npos) {
    return {name.substr(0, bracket), name.substr(bracket + 1, name.size() - bracket - 2), 0, false};
  }
  while (s.letter.ends_with("_dot")) {
    s.letter.resize(s.letter.size() - 4);
    ++s.dots;
  }
  const std::size_t underscore = s.letter.find('_', 1);
  if (underscore != std::string::npos) {
    s.index = s.letter.substr(underscore + 1);
    s.letter.resize(underscore);
  } else if (s.letter.size() == 2) {
    // ra is the arm on a, p1 the first point.
    const std::string last = s.letter.substr(1);
    const bool digit = last[0] >= '0' && last[0] <= '9';
    if (digit || std::find(bodies.begin(), bodies.end(), last) != bodies.end()) {
      s.index = last;
      s.letter.resize(1);
    }
  }
  if (s.letter == "Cdot") s.letter = "C", ++s.dots;
  std::replace(s.index.begin(), s.index.end(), '_', ' ');
  return s;
}

std::string filled(std::string_view pattern, std::string_view first, std::string_view second) {
  std::string out;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    const std::string_view part = pattern.substr(i, 2);
    if (part != "#1" && part != "#2") {
      out += pattern[i];
      continue;
    }
    out += part == "#1" ? first : second;
    ++i;
  }
  return out;
}

std::vector<std::string> FormulaWriter::pieces(const Formula& f) const {
  if (f.shape != Shape::sum) return {write(f)};
  std::vector<std::string> out;
  for (std::size_t i = 0; i < f.args.size(); ++i) {
    const bool first = i == 0, minus = f.minus[i];
    const std::string_view sign = minus ? (first ? style_.opening_minus : style_.minus) : first ? "" : style_.plus;
    const Place place = !minus ? Place::term : first ? Place::opening_minus : Place::negated;
    out.push_back(std::string(sign) + write(f.args[i], place));
  }
  return out;
}

bool FormulaWriter::needs_parentheses(const Formula& f, Place place) const {
  switch (f.shape) {
    case Shape::sum: return place != Place::whole;
    // -(ra × t), but v_b - w_b × rb; a dot product needs it only if a sum opens it.
    case Shape::cross:
    case Shape::dot: {
      const bool opened_by_sum = f.args[0].shape == Shape::sum;
      return place >= Place::factor || (place >= Place::negated && opened_by_sum) ||
             (place == Place::opening_minus && f.shape == Shape::cross);
    }
    case Shape::product: return place >= Place::operand;
    case Shape::quotient: return style_.fraction_encloses ? place == Place::base : place >= Place::factor;
    case Shape::power:
    case Shape::transpose:
    case Shape::number: return place == Place::base && (f.shape != Shape::number || !f.number.is_integer());
    default: return false;
  }
}

std::string FormulaWriter::write(const Formula& f, Place place) const {
  return needs_parentheses(f, place) ? filled(style_.parentheses, bare(f)) : bare(f);
}

std::string FormulaWriter::joined(const Formula& f, std::string_view between, Place inner) const {
  std::string out;
  for (const Formula& arg : f.args) out += (&arg == &f.args[0] ? "" : std::string(between)) + write(arg, inner);
  return out;
}

std::string FormulaWriter::integer(std::int64_t n) const { return filled(style_.integer, std::to_string(n)); }

std::string FormulaWriter::fraction_of(const Formula& f) const {
  const Formula& below = f.args[1];
  if (style_.fraction_encloses) return filled(style_.fraction, write(f.args[0]), write(below));
  return filled(style_.fraction, write(f.args[0], Place::factor),
                write(below, below.shape == Shape::power ? Place::factor : Place::base));
}

std::string FormulaWriter::matrix_of(const Formula& f) const {
  const auto columns = static_cast<std::size_t>(f.columns);
  std::string entries, form;
  for (std::size_t i = 0; i < columns; ++i) form += i == 0 ? "c" : "|c";
  for (std::size_t i = 0; i < f.args.size(); ++i) {
    if (i > 0) entries += i % columns == 0 ? style_.next_row : style_.next_entry;
    entries += filled(style_.entry, write(f.args[i]));
  }
  return filled(style_.matrix, entries, form);
}

std::string FormulaWriter::bare(const Formula& f) const {
  const auto call = [this](std::string_view function, const std::string& args) {
    return filled(style_.call, function, args);
  };
  switch (f.shape) {
    case Shape::leaf: return style_.name(f, bodies_);
    case Shape::number:
      if (f.number.is_integer()) return integer(f.number.num());
      return filled(style_.fraction, integer(f.number.num()), integer(f.number.den()));
    case Shape::sum: {
      std::string out;
      for (const std::string& piece : pieces(f)) out += piece;
      return out;
    }
    case Shape::product: return joined(f, style_.product, Place::factor);
    case Shape::dot: return joined(f, style_.dot, Place::operand);
    case Shape::cross: return joined(f, style_.cross, Place::operand);
    case Shape::quotient: return fraction_of(f);
    case Shape::power: {
      const std::string magnitude = integer(std::abs(f.exponent));
      return filled(style_.power, write(f.args[0], Place::base),
                    f.exponent < 0 ? filled(style_.negative, magnitude) : magnitude);
    }
    case Shape::norm: return filled(style_.norm, write(f.args[0]));
    case Shape::component: return filled(style_.component, write(f.args[0], Place::base), f.name);
    case Shape::transpose: return filled(style_.transpose, write(f.args[0], Place::base));
    case Shape::identity: return std::string(style_.identity);
    case Shape::perp: return call("perp", write(f.args[0]));
    case Shape::unit: return call("unit", write(f.args[0]));
    case Shape::skew: return call("S", write(f.args[0]));
    case Shape::call: return call(f.name, joined(f, style_.comma, Place::whole));
    case Shape::matrix: return matrix_of(f);
  }
  return "";
}

std::string written(const Explanation& explanation, const Format& format) {
  const FormulaWriter formula(format.formula, explanation.bodies);
  // The words with each {} replaced by its formula.
  const auto words = [&](const Words& w) {
    std::string out;
    std::size_t at = 0;
    for (const Formula& f : w.formulas) {
      const std::size_t next = w.text.find("{}", at);
      out += format.prose(w.text.substr(at, next - at)) + filled(format.inline_formula, formula.write(f));
      at = next + 2;
    }
    return out + format.prose(w.text.substr(at));
  };
  std::string out = format.head(explanation.title);
  int number = 0;
  for (const Step& step : explanation.steps) {
    out += filled(format.section, std::to_string(++number), format.escaped(step.heading));
    bool in_list = false;
    for (const Item& item : step.items) {
      const bool bullet = item.kind == Item::Kind::bullet;
      if (bullet != in_list) out += bullet ? format.list_begin : format.list_end;
      in_list = bullet;
      const bool chain = item.kind == Item::Kind::chain;
      out += chain ? format.chain(item.chain, formula) : format.item(words(item.words), bullet);
    }
    if (in_list) out += format.list_end;
  }
  return out += format.foot;
}

}  // namespace cdot::derive
