// Random expressions in the language of specs, by the kind of quantity that they give.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "derive/numbers/numeric.hpp"

namespace cdot::test {

// Names that a spec has declared so far, and expressions over them. Each function gives an expression of at most
// `depth` nested operators that has brackets where it needs them.
class Vocabulary {
 public:
  Vocabulary(std::uint64_t seed, int dimension, int bodies);

  std::string number(int depth);        // without a unit
  std::string length(int depth);        // [m]
  std::string angle(int depth);         // [rad]
  std::string displacement(int depth);  // a vector [m]
  std::string direction(int depth);     // a vector without a unit, often of length 1
  std::string difference_of_points();
  std::string unit_vector();  // fixed in a body
  std::string axis_of(const std::string& body);
  std::pair<std::string, std::string> two_bodies();
  std::string frame() { return one_of(frames); }

  std::size_t pick(std::size_t size) { return static_cast<std::size_t>(random_.bits() % size); }
  bool chance(double share) { return random_.between(0, 1) < share; }
  const std::string& one_of(const std::vector<std::string>& words) { return words[pick(words.size())]; }
  std::string body() { return one_of(bodies); }
  bool planar() const { return dimension_ == 2; }

  std::vector<std::string> bodies, points, vectors, units, frames, numbers, lengths, angles, displacements;

 private:
  std::string literal();
  std::string function_of_number(int depth);

  derive::Random random_;
  int dimension_;
};

}  // namespace cdot::test
