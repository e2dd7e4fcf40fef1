// A joint at a pose as marks in the world: bodies, points and arrows, by the names of the spec.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "derive/language/joint.hpp"
#include "derive/numbers/numeric.hpp"

namespace cdot::derive {

struct BodyMark {
  std::string name;
  Triple<double> centre;
  std::vector<Triple<double>> axes;     // two or three, of length 1
  std::vector<Triple<double>> corners;  // the centre, and every point that is fixed in the body
};

struct PointMark {
  std::string name;  // "pa, pb" where two points coincide
  int body = -1;     // of the first of them; -1: the world
  Triple<double> at;
};

// A vector of a `let` has no body: -2.
constexpr int of_no_body = -2;

struct ArrowMark {
  std::string name;
  int body = -1;
  Triple<double> from, along;  // in metres; of a direction without a length in metres `along` has length 1
  bool direction = false;
  bool is_zero() const;
};

struct Marks {
  std::vector<BodyMark> bodies;
  std::vector<PointMark> points;
  std::vector<ArrowMark> arrows;
};

// The pose has a value for each parameter of the joint.
Marks marks_of(const Joint& joint, const Sample& pose);

}  // namespace cdot::derive
