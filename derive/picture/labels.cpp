#include "derive/picture/labels.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cdot::derive {
namespace {

constexpr double letter_width = 0.62, line_height = 1.1;  // in font sizes, of a sans-serif font
constexpr int directions = 16;

double overlap(const LabelBox& a, const LabelBox& b) {
  const double w = std::min(a.x1, b.x1) - std::max(a.x0, b.x0), h = std::min(a.y1, b.y1) - std::max(a.y0, b.y0);
  return w > 0 && h > 0 ? w * h : 0;
}

// The length of a line within a box, by sampling.
double within(const LabelBox& box, OnPaper from, OnPaper to) {
  const double length = std::hypot(to.x - from.x, to.y - from.y);
  const int steps = 1 + static_cast<int>(length / 2);
  int inside = 0;
  for (int i = 0; i <= steps; ++i) {
    const double x = from.x + (to.x - from.x) * i / steps, y = from.y + (to.y - from.y) * i / steps;
    inside += x > box.x0 && x < box.x1 && y > box.y0 && y < box.y1;
  }
  return 2.0 * inside;
}

}  // namespace

double Labels::cost(const LabelBox& box) const {
  double sum = 0;
  for (const LabelBox& other : taken_) sum += 2 * overlap(box, other);
  for (const Line& line : lines_) sum += 6 * within(box, line.from, line.to);
  const double outside = std::max({0.0, -box.x0, -box.y0, box.x1 - width_, box.y1 - height_});
  return sum + 200 * outside;
}

// The cheapest of places around the mark: near ones and ones to the upper right come first.
LabelBox Labels::place(OnPaper at, const std::string& text, double font) {
  const double w = letter_width * font * static_cast<double>(text.size()), h = line_height * font;
  LabelBox best;
  double least = HUGE_VAL;
  for (const double gap : {6.0, 10.0, 16.0, 26.0, 38.0}) {
    for (int k = 0; k < directions; ++k) {
      const double angle = std::numbers::pi * (0.25 + 2.0 * k / directions);
      const double cx = at.x + std::cos(angle) * (gap + w / 2), cy = at.y - std::sin(angle) * (gap + h / 2);
      const LabelBox box{cx - w / 2, cy - h / 2, cx + w / 2, cy + h / 2};
      const double total = cost(box) + gap;
      if (total < least - 1e-6) least = total, best = box;
    }
  }
  taken_.push_back(best);
  return best;
}

}  // namespace cdot::derive
