// Precedence of written formulas, and names taken apart.
#include "derive/explain/write.hpp"

#include <algorithm>

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

std::vector<std::string> FormulaWriter::pieces(const Formula& f) const {
  if (f.shape != Shape::sum) return {write(f)};
  std::vector<std::string> out;
  for (std::size_t i = 0; i < f.args.size(); ++i) {
    out.push_back(sign(f.minus[i], i == 0) + write(f.args[i], !f.minus[i] ? Place::term
                                                              : i == 0    ? Place::opening_minus
                                                                          : Place::negated));
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
    case Shape::quotient: return fraction_encloses() ? place == Place::base : place >= Place::factor;
    case Shape::power:
    case Shape::transpose:
    case Shape::number: return place == Place::base && (f.shape != Shape::number || !f.number.is_integer());
    default: return false;
  }
}

std::string FormulaWriter::write(const Formula& f, Place place) const {
  return needs_parentheses(f, place) ? parentheses(bare(f)) : bare(f);
}

std::string FormulaWriter::joined(const Formula& f, Place inner) const {
  std::string out;
  for (std::size_t i = 0; i < f.args.size(); ++i) {
    out += (i == 0 ? "" : between(f.shape)) + write(f.args[i], inner);
  }
  return out;
}

std::string FormulaWriter::fraction_of(const Formula& f) const {
  const bool enclosed = fraction_encloses();
  const Formula& below = f.args[1];
  return fraction(write(f.args[0], enclosed ? Place::whole : Place::factor),
                  write(below, enclosed                      ? Place::whole
                               : below.shape == Shape::power ? Place::factor
                                                             : Place::base));
}

std::string FormulaWriter::bare(const Formula& f) const {
  std::vector<std::string> args;
  switch (f.shape) {
    case Shape::leaf: return name(f);
    case Shape::number: return number(f.number);
    case Shape::sum: {
      std::string out;
      for (const std::string& piece : pieces(f)) out += piece;
      return out;
    }
    case Shape::product: return joined(f, Place::factor);
    case Shape::dot:
    case Shape::cross: return joined(f, Place::operand);
    case Shape::quotient: return fraction_of(f);
    case Shape::power: return power(write(f.args[0], Place::base), f.exponent);
    case Shape::norm: return norm(write(f.args[0]));
    case Shape::component: return component(write(f.args[0], Place::base), f.name);
    case Shape::transpose: return transpose(write(f.args[0], Place::base));
    case Shape::identity: return identity();
    case Shape::perp: return call("perp", {write(f.args[0])});
    case Shape::unit: return call("unit", {write(f.args[0])});
    case Shape::skew: return call("S", {write(f.args[0])});
    case Shape::call:
      for (const Formula& arg : f.args) args.push_back(write(arg));
      return call(f.name, args);
    case Shape::matrix:
      for (const Formula& arg : f.args) args.push_back(write(arg));
      return matrix(f.columns, args);
  }
  return "";
}

}  // namespace cdot::derive
