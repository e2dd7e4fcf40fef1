// The precisions of a World: float, double, or extended precision, which is long double. A long double has 64 or more
// bits of mantissa, a double 53. On some compilers and machines long double equals double.
#pragma once

#include <limits>
#include <type_traits>

namespace cdot {

template <class T>
inline constexpr bool is_extended = std::is_same_v<T, long double>;

// The number type in which K is formed and factored: at least double.
template <class T>
using ExactNumber = std::conditional_t<std::is_same_v<T, float>, double, T>;

// A threshold of round-off, given for doubles. For finer numbers it shrinks in proportion to their epsilon.
template <class T>
constexpr double by_precision(double of_doubles) {
  return of_doubles * static_cast<double>(std::numeric_limits<T>::epsilon() / std::numeric_limits<double>::epsilon());
}
// The same with a threshold of its own for floats.
template <class T>
constexpr double by_precision(double of_floats, double of_doubles) {
  return std::is_same_v<T, float> ? of_floats : by_precision<T>(of_doubles);
}

}  // namespace cdot
