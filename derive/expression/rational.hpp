// Exact numbers of the generator: fractions of 64-bit integers that refuse to overflow, unless they may be rounded.
#pragma once

#include <compare>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace cdot::derive {

// Thrown on overflow. The caller that knows the source position reports it.
struct NumberTooLarge : std::runtime_error {
  NumberTooLarge() : std::runtime_error("the number does not fit a fraction of 64-bit integers") {}
};

// While one lives, its thread rounds results that do not fit to a fraction that does, nearer than doubles are to each
// other. A program that computes in doubles needs no more; a proof does.
class RoundedNumbers {
 public:
  RoundedNumbers();
  ~RoundedNumbers();
  RoundedNumbers(const RoundedNumbers&) = delete;
  RoundedNumbers& operator=(const RoundedNumbers&) = delete;

 private:
  bool before_;
};

class Rational {
 public:
  constexpr Rational(std::int64_t whole = 0) : num_(whole) {}
  Rational(std::int64_t num, std::int64_t den);

  std::int64_t num() const { return num_; }
  std::int64_t den() const { return den_; }  // always positive
  bool is_integer() const { return den_ == 1; }
  bool is_zero() const { return num_ == 0; }
  int sign() const { return num_ > 0 ? 1 : num_ < 0 ? -1 : 0; }
  double value() const { return static_cast<double>(num_) / static_cast<double>(den_); }
  std::string text() const;  // "3", "-1/2"

  Rational operator-() const;
  friend Rational operator+(Rational a, Rational b);
  friend Rational operator*(Rational a, Rational b);
  friend Rational operator-(Rational a, Rational b) { return a + -b; }
  friend Rational operator/(Rational a, Rational b);  // b must not be zero
  friend bool operator==(Rational a, Rational b) = default;
  friend std::strong_ordering operator<=>(Rational a, Rational b);

 private:
  std::int64_t num_ = 0, den_ = 1;
};

Rational abs(Rational a);
Rational pow(Rational a, int exponent);

}  // namespace cdot::derive
