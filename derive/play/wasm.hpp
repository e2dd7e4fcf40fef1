// Included before every file that is compiled to WebAssembly. The page computes in doubles alone; the standard library
// of Debian's emscripten (libc++ 13) lacks parts of C++20.
#pragma once

#include <algorithm>
#include <charconv>
#include <compare>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <ranges>
#include <string>
#include <utility>
#include <vector>

#if defined(_LIBCPP_VERSION) && _LIBCPP_VERSION < 15000
namespace std {

template <class To, class From>
To bit_cast(const From& from) noexcept {
  static_assert(sizeof(To) == sizeof(From));
  To to;
  __builtin_memcpy(&to, &from, sizeof(To));
  return to;
}

template <class T>
requires is_floating_point_v<T> from_chars_result from_chars(const char* first, const char* last, T& value,
                                                             chars_format format = chars_format::general) {
  const string text = (format == chars_format::hex ? "0x" : "") + string(first, last);
  char* end = nullptr;
  const T number = static_cast<T>(strtod(text.c_str(), &end));
  const auto used = end - text.c_str() - (format == chars_format::hex ? 2 : 0);
  if (used <= 0) return {first, errc::invalid_argument};
  value = number;
  return {first + used, errc{}};
}

template <class A, class B>
constexpr auto operator<=>(const pair<A, B>& a, const pair<A, B>& b) {
  const auto first = a.first <=> b.first;
  return first != 0 ? first : a.second <=> b.second;
}
inline strong_ordering operator<=>(const string& a, const string& b) { return a.compare(b) <=> 0; }

namespace ranges {

// find_if(range, is), and find_if(range, is, of): of each element's part or value.
template <class Range, class Is, class Of = identity>
constexpr auto find_if(Range&& range, Is is, Of of = {}) {
  return std::find_if(begin(range), end(range), [&](auto&& x) -> bool { return std::invoke(is, std::invoke(of, x)); });
}
template <class Range, class T, class Of = identity>
constexpr auto find(Range&& range, const T& value, Of of = {}) {
  return ranges::find_if(
      range, [&](const auto& x) { return x == value; }, of);
}
template <class Range, class Is, class Of = identity>
constexpr bool any_of(Range&& range, Is is, Of of = {}) {
  return ranges::find_if(range, is, of) != end(range);
}
template <class Range, class Is, class Of = identity>
constexpr bool none_of(Range&& range, Is is, Of of = {}) {
  return !ranges::any_of(range, is, of);
}
template <class Range, class Is, class Of = identity>
constexpr bool all_of(Range&& range, Is is, Of of = {}) {
  return !ranges::any_of(
      range, [&](auto&& x) -> bool { return !std::invoke(is, x); }, of);
}
template <class Range, class Is, class Of = identity>
constexpr auto count_if(Range&& range, Is is, Of of = {}) {
  return std::count_if(begin(range), end(range), [&](auto&& x) -> bool { return std::invoke(is, std::invoke(of, x)); });
}
template <class Range, class T, class Of = identity>
constexpr auto count(Range&& range, const T& value, Of of = {}) {
  return ranges::count_if(
      range, [&](const auto& x) { return x == value; }, of);
}
template <class Range, class T>
constexpr void replace(Range&& range, const T& from, const T& to) {
  std::replace(begin(range), end(range), from, to);
}
template <class Range>
constexpr void reverse(Range&& range) {
  std::reverse(begin(range), end(range));
}
// The order of a projection.
template <class Less, class Of>
constexpr auto by(Less less, Of of) {
  return [=](auto&& a, auto&& b) -> bool { return std::invoke(less, std::invoke(of, a), std::invoke(of, b)); };
}
template <class Range, class Less = std::less<>, class Of = identity>
constexpr void sort(Range&& range, Less less = {}, Of of = {}) {
  std::sort(begin(range), end(range), by(less, of));
}
template <class Range, class Less = std::less<>, class Of = identity>
constexpr void stable_sort(Range&& range, Less less = {}, Of of = {}) {
  std::stable_sort(begin(range), end(range), by(less, of));
}
template <class Range, class Less = std::less<>, class Of = identity>
constexpr auto max_element(Range&& range, Less less = {}, Of of = {}) {
  return std::max_element(begin(range), end(range), by(less, of));
}
template <class Range, class Less = std::less<>, class Of = identity>
constexpr auto minmax_element(Range&& range, Less less = {}, Of of = {}) {
  struct MinMax {
    decltype(begin(range)) min, max;
  };
  const auto [min, max] = std::minmax_element(begin(range), end(range), by(less, of));
  return MinMax{min, max};
}
template <class Range, class T, class Less = std::less<>, class Of = identity>
constexpr auto lower_bound(Range&& range, const T& value, Less less = {}, Of of = {}) {
  return std::lower_bound(begin(range), end(range), value,
                          [&](auto&& x, const T& y) -> bool { return std::invoke(less, std::invoke(of, x), y); });
}
template <class A, class B, class Equal = std::equal_to<>>
constexpr bool equal(A&& a, B&& b, Equal equal = {}) {
  return std::equal(begin(a), end(a), begin(b), end(b), equal);
}
template <class A, class B, class Out>
constexpr auto set_difference(A&& a, B&& b, Out out) {
  return std::set_difference(begin(a), end(a), begin(b), end(b), out);
}

}  // namespace ranges
}  // namespace std
#endif

#include <cdot/spaces.hpp>
#undef CDOT_FOR_EACH_EXTENDED_SPACE
#define CDOT_FOR_EACH_EXTENDED_SPACE(declaration)
#undef CDOT_FOR_EACH_SPACE
#define CDOT_FOR_EACH_SPACE(declaration) declaration(Planar<double>) declaration(Spatial<double>)
#undef CDOT_FOR_EACH_NUMBER
#define CDOT_FOR_EACH_NUMBER(declaration) declaration(double)
