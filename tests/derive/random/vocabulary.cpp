#include "tests/derive/random/vocabulary.hpp"

#include <algorithm>

namespace cdot::test {

Vocabulary::Vocabulary(std::uint64_t seed, int dimension, int count) : random_(seed), dimension_(dimension) {
  for (int i = 0; i < count; ++i) bodies.push_back(std::string(1, static_cast<char>('a' + i)));
}

std::string Vocabulary::literal() {
  static const std::vector<std::string> literals = {"2", "3", "0.5", "1.25", "7", "pi", "1e-3", "0.1"};
  return one_of(literals);
}

std::string Vocabulary::number(int depth) {
  if (depth <= 0) return numbers.empty() || chance(0.3) ? literal() : one_of(numbers);
  const int less = depth - 1;
  switch (pick(9)) {
    case 0: return number(less) + "*" + number(less);
    case 1: return "(" + number(less) + (chance(0.5) ? " + " : " - ") + number(less) + ")";
    case 2: return "(" + number(less) + ")^" + std::to_string(2 + pick(3));
    case 3: return "dot(" + direction(less) + ", " + direction(less) + ")";
    case 4: return length(less) + "/(1 [m])";
    case 5: return "sin(" + angle(less) + ")";
    case 6: return "cos(" + angle(less) + ")";
    case 7: return "(" + number(less) + ")/(1 + (" + number(less) + ")^2)";
    default: return function_of_number(less);
  }
}

std::string Vocabulary::function_of_number(int depth) {
  const std::string x = number(depth);
  switch (pick(8)) {
    case 0: return "sqrt(1 + (" + x + ")^2)";
    case 1: return "exp(-(" + x + ")^2)";
    case 2: return "log(2 + (" + x + ")^2)";
    case 3: return "abs(" + x + ")";
    case 4: return "tan(" + x + ")";
    case 5: return "sinh(" + x + "/4)";
    case 6: return "cosh(" + x + "/4)";
    default: return "norm(" + direction(depth) + " - " + direction(depth) + ")";
  }
}

std::string Vocabulary::length(int depth) {
  if (depth <= 0) return lengths.empty() ? "norm(" + difference_of_points() + ")" : one_of(lengths);
  const int less = depth - 1;
  switch (pick(7)) {
    case 0: return "norm(" + displacement(less) + ")";
    case 1: return "dot(" + direction(less) + ", " + displacement(less) + ")";
    case 2: return number(less) + "*" + length(less);
    case 3: return "(" + length(less) + (chance(0.5) ? " + " : " - ") + length(less) + ")";
    case 4: return "sqrt((" + length(less) + ")^2 + (" + length(less) + ")^2)";
    case 5:
      return planar() ? "cross(" + direction(less) + ", " + displacement(less) + ")"
                      : "dot(cross(" + direction(less) + ", " + direction(less) + "), " + displacement(less) + ")";
    default: return "local(" + displacement(less) + ", " + (frames.empty() ? body() : frame()) + ").x";
  }
}

std::string Vocabulary::angle(int depth) {
  if (depth <= 0) {
    if (!angles.empty() && chance(0.5)) return one_of(angles);
    if (planar()) return "(angle(" + bodies.back() + ") - angle(" + bodies[pick(bodies.size() - 1)] + "))";
    return frames.empty() ? "angle(" + unit_vector() + ", " + unit_vector() + ")"
                          : "swing(" + frame() + ", " + frame() + ")";
  }
  const int less = depth - 1;
  switch (pick(5)) {
    case 0: return "(" + angle(less) + (chance(0.5) ? " + " : " - ") + angle(less) + ")";
    case 1: return "angle(" + direction(less) + ", " + direction(less) + ")";
    case 2: return "atan2(" + length(less) + ", " + length(less) + ")";
    case 3: return "atan2(" + number(less) + ", 2 + (" + number(less) + ")^2)";
    default:
      if (planar() || frames.empty()) return angle(less);
      return chance(0.5) ? "twist(" + frame() + ", " + frame() + ")"
                         : "angle(" + direction(less) + ", " + direction(less) + ", " + frame() + ".z)";
  }
}

std::string Vocabulary::difference_of_points() {
  const std::size_t first = pick(points.size()), second = pick(points.size() - 1);
  return "(" + points[first] + " - " + points[second + (second >= first ? 1 : 0)] + ")";
}

std::string Vocabulary::displacement(int depth) {
  if (depth <= 0) return displacements.empty() || chance(0.4) ? difference_of_points() : one_of(displacements);
  const int less = depth - 1;
  switch (pick(6)) {
    case 0: return number(less) + "*" + displacement(less);
    case 1: return "(" + displacement(less) + (chance(0.5) ? " + " : " - ") + displacement(less) + ")";
    case 2: return length(less) + "*" + direction(less);
    case 3:
      return planar() ? "perp(" + displacement(less) + ")"
                      : "cross(" + direction(less) + ", " + displacement(less) + ")";
    case 4: return "arm(" + one_of(points) + ")";
    default: return vectors.empty() ? difference_of_points() : one_of(vectors);
  }
}

std::string Vocabulary::unit_vector() {
  if (!units.empty() && chance(0.6)) return one_of(units);
  const std::string axis = std::string(".") + "xyz"[pick(planar() ? 2 : 3)];
  return (frames.empty() ? body() : frame()) + axis;
}

std::pair<std::string, std::string> Vocabulary::two_bodies() {
  const std::size_t one = pick(bodies.size()), other = pick(bodies.size() - 1);
  return {bodies[one], bodies[other + (other >= one ? 1 : 0)]};
}

std::string Vocabulary::axis_of(const std::string& body) {
  const bool unit = std::ranges::find(units, "t" + body) != units.end();
  return unit && chance(0.5) ? "t" + body : body + "." + "xyz"[pick(planar() ? 2 : 3)];
}

std::string Vocabulary::direction(int depth) {
  if (depth <= 0) return unit_vector();
  const int less = depth - 1;
  switch (pick(5)) {
    case 0: return "unit(" + displacement(less) + ")";
    case 1:
      return planar() ? "perp(" + direction(less) + ")" : "cross(" + direction(less) + ", " + direction(less) + ")";
    case 2: return "(" + direction(less) + (chance(0.5) ? " + " : " - ") + number(less) + "*" + direction(less) + ")";
    case 3: return displacement(less) + "/(1 [m])";
    default: return unit_vector();
  }
}

}  // namespace cdot::test
