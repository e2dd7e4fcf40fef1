// What a World computes in, and what depends on that: float, double, or extended precision, which is long double. That
// has 64 or more bits where double has 53, or, with some compilers and machines, is double under another name.
#pragma once

#include <limits>
#include <type_traits>

namespace cdot {

template <class T>
inline constexpr bool is_extended = std::is_same_v<T, long double>;

// What K is formed and factored in: never less than double.
template <class T>
using ExactNumber = std::conditional_t<std::is_same_v<T, float>, double, T>;

// A threshold of round-off: what it is for doubles and, for numbers that are finer, as much smaller as these are finer.
template <class T>
constexpr double by_precision(double of_doubles) {
  return of_doubles * static_cast<double>(std::numeric_limits<T>::epsilon() / std::numeric_limits<double>::epsilon());
}
// Floats have their own.
template <class T>
constexpr double by_precision(double of_floats, double of_doubles) {
  return std::is_same_v<T, float> ? of_floats : by_precision<T>(of_doubles);
}

}  // namespace cdot
