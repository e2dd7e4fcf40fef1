// Functions of <cmath> in the arithmetic of compiled headers, beside those of the C library.
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>

#include <cdot/pack.hpp>

#include "tailgate_euler.hpp"

namespace {

using cdot::scenes::Exponential, cdot::scenes::Logarithm;
constexpr double endless = std::numeric_limits<double>::infinity();

// In units in the last place of the exact number.
template <class T>
double error(T found, double exact) {
  const T rounded = static_cast<T>(exact);
  return std::abs(double(found) - exact) / double(std::nextafter(std::abs(rounded), T(endless)) - std::abs(rounded));
}

template <class T>
void is_exact(T most, T least, double within) {
  double of_exp = 0, of_log = 0;
  for (int k = -20000; k <= 20000; ++k) {
    const T x = most * static_cast<T>(k) / 20000, y = std::exp(x);
    of_exp = std::max(of_exp, error(Exponential{}(x), double(std::exp((long double)(x)))));
    if (k != 0) of_log = std::max(of_log, error(Logarithm{}(y), double(std::log((long double)(y)))));
  }
  EXPECT_LT(of_exp, within);
  EXPECT_LT(of_log, within);
  EXPECT_LT(error(Logarithm{}(least), double(std::log((long double)(least)))), within) << "below the smallest normal";
}

TEST(OwnFunctions, AreThoseOfTheLibraryToAUnitInTheLastPlace) {
  is_exact<double>(708, 5e-324, 1.01);
  is_exact<float>(87, 1e-45F, 1.01);
}

// The largest error over angles up to the limit, many of them beside multiples of pi/2, where one of both is small.
template <class T, class Error>
double largest_error(double limit, Error error) {
  double most = 0;
  for (int k = -40000; k <= 40000; ++k) {
    const double quarters = std::round(k * (k % 7) / 240000.0 * limit / std::acos(0.0));
    for (const T angle : {T(limit * k / 40000), T(quarters * std::acos(0.0)), T(1e-4 * k)}) {
      T s, c;
      cdot::scenes::sin_cos(angle, s, c);
      if (angle != 0) most = std::max(most, error(s, double(std::sin((long double)(angle)))));
      most = std::max(most, error(c, double(std::cos((long double)(angle)))));
    }
  }
  return most;
}

TEST(OwnFunctions, TurnAngles) {
  EXPECT_LE(largest_error<double>(1e5, error<double>), 2) << "units in the last place";
  EXPECT_LT(largest_error<float>(1e4, [](float found, double exact) { return std::abs(found - exact); }), 1e-7);
}

TEST(OwnFunctions, KnowWhatHasNoNumber) {
  EXPECT_EQ(Exponential{}(0.0), 1);
  EXPECT_EQ(Exponential{}(1000.0), endless);
  EXPECT_EQ(Exponential{}(endless), endless);
  EXPECT_EQ(Exponential{}(-endless), 0);
  EXPECT_NEAR(Exponential{}(-745.0), 5e-324, 0) << "below the smallest normal";
  EXPECT_TRUE(std::isnan(Exponential{}(std::nan(""))));
  EXPECT_EQ(Logarithm{}(1.0), 0);
  EXPECT_EQ(Logarithm{}(0.0), -endless);
  EXPECT_EQ(Logarithm{}(endless), endless);
  EXPECT_TRUE(std::isnan(Logarithm{}(-1.0)));
  EXPECT_TRUE(std::isnan(Logarithm{}(std::nan(""))));
}

template <class T, int width>
void lanes_are_as_alone() {
  for (int k = -300; k < 300; k += width) {
    cdot::Pack<T, width> x(0);
    for (int lane = 0; lane < width; ++lane) x.set(lane, T(0.29) * static_cast<T>(k + lane));
    const cdot::Pack<T, width> y = Exponential{}(x), z = Logarithm{}(y);
    for (int lane = 0; lane < width; ++lane) {
      const T alone[] = {Exponential{}(x[lane]), Logarithm{}(y[lane])}, together[] = {y[lane], z[lane]};
      ASSERT_EQ(std::memcmp(alone, together, sizeof alone), 0) << x[lane];
    }
  }
}

TEST(OwnFunctions, HaveTheSameBitsInALane) {
  lanes_are_as_alone<double, 4>();
  lanes_are_as_alone<double, 8>();
  lanes_are_as_alone<float, 8>();
}

}  // namespace
