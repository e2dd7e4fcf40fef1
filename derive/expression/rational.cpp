#include "derive/expression/rational.hpp"

#include <limits>
#include <numeric>
#include <utility>

namespace cdot::derive {
namespace {

__extension__ using Wide = __int128;

Rational reduced(Wide num, Wide den) {
  constexpr Wide limit = std::numeric_limits<std::int64_t>::max();
  const auto fit = [&] { return -limit <= num && num <= limit && den <= limit; };
  if (!fit()) {
    Wide a = num < 0 ? -num : num, b = den;
    while (b != 0) a = std::exchange(b, a % b);
    num /= a, den /= a;
  }
  if (!fit()) throw NumberTooLarge();
  return {static_cast<std::int64_t>(num), static_cast<std::int64_t>(den)};
}

}  // namespace

Rational::Rational(std::int64_t num, std::int64_t den) {
  if (den == 0) throw NumberTooLarge();
  if (num == std::numeric_limits<std::int64_t>::min()) throw NumberTooLarge();
  if (den == std::numeric_limits<std::int64_t>::min()) throw NumberTooLarge();
  const std::int64_t divisor = den == 1 ? 1 : std::gcd(num, den);
  num_ = (den < 0 ? -num : num) / divisor;
  den_ = (den < 0 ? -den : den) / divisor;
}

std::string Rational::text() const {
  return den_ == 1 ? std::to_string(num_) : std::to_string(num_) + "/" + std::to_string(den_);
}

Rational Rational::operator-() const {
  Rational r = *this;
  r.num_ = -r.num_;
  return r;
}

Rational operator+(Rational a, Rational b) {
  return reduced(Wide(a.num_) * b.den_ + Wide(b.num_) * a.den_, Wide(a.den_) * b.den_);
}

Rational operator*(Rational a, Rational b) { return reduced(Wide(a.num_) * b.num_, Wide(a.den_) * b.den_); }

Rational operator/(Rational a, Rational b) {
  if (b.num_ == 0) throw NumberTooLarge();
  const int sign = b.num_ < 0 ? -1 : 1;
  return reduced(Wide(a.num_) * b.den_ * sign, Wide(a.den_) * b.num_ * sign);
}

std::strong_ordering operator<=>(Rational a, Rational b) {
  const Wide left = Wide(a.num_) * b.den_, right = Wide(b.num_) * a.den_;
  return left < right   ? std::strong_ordering::less
         : left > right ? std::strong_ordering::greater
                        : std::strong_ordering::equal;
}

Rational abs(Rational a) { return a.sign() < 0 ? -a : a; }

Rational pow(Rational a, int exponent) {
  Rational result(1);
  for (int i = 0; i < (exponent < 0 ? -exponent : exponent); ++i) result = result * a;
  return exponent < 0 ? Rational(1) / result : result;
}

}  // namespace cdot::derive
