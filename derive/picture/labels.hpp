// Places for the labels of a drawing: each beside its mark, off other labels, points and lines.
#pragma once

#include <string>
#include <vector>

#include "derive/picture/picture.hpp"

namespace cdot::derive {

struct LabelBox {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

// In pixels, y down.
class Labels {
 public:
  Labels(double width, double height) : width_(width), height_(height) {}

  // The places that labels keep off.
  void avoid(OnPaper from, OnPaper to) { lines_.push_back({from, to}); }
  // The box of a label of this text beside `at`, taken from now on.
  LabelBox place(OnPaper at, const std::string& text, double font);

 private:
  struct Line {
    OnPaper from, to;
  };
  double cost(const LabelBox& box) const;

  double width_, height_;
  std::vector<Line> lines_;
  std::vector<LabelBox> taken_;
};

}  // namespace cdot::derive
