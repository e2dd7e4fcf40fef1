// Sines and cosines of time, with their rates.
#pragma once

#include <cmath>

#include <cdot/profile.hpp>

namespace cdot::test {

// a + b sin(w t)
inline Profile sine(double a, double b, double w) {
  return Profile::function([=](double t) -> ProfileValue {
    return {a + b * std::sin(w * t), b * w * std::cos(w * t), -b * w * w * std::sin(w * t)};
  });
}

// a + b cos(w t)
inline Profile cosine(double a, double b, double w) {
  return Profile::function([=](double t) -> ProfileValue {
    return {a + b * std::cos(w * t), -b * w * std::sin(w * t), -b * w * w * std::cos(w * t)};
  });
}

}  // namespace cdot::test
