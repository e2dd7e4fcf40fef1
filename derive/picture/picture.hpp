// A joint at a pose as a drawing: outlines of bodies with their axes, points, vectors and frames, by the names of the
// spec.
#pragma once

#include <string>
#include <vector>

#include "derive/picture/marks.hpp"

namespace cdot::derive {

// A point of the paper: x to the right, y up, in metres. A picture in space is seen from the front, the right and
// above, without perspective.
struct OnPaper {
  double x = 0, y = 0;
};
OnPaper projected(const Triple<double>& p, int dimension);

// One SVG element for each pose, all at one scale. A page with them needs `picture_style`.
std::vector<std::string> pictures_of(const Joint& joint, const std::vector<Sample>& poses);

// "x(a) = (0, 1)", "l = 2": all numbers of a pose, one line each; what is fixed in a body along its axes.
std::vector<std::string> numbers_of(const Joint& joint, const Sample& pose);

extern const char* const picture_style;

}  // namespace cdot::derive
