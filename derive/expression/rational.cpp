#include "derive/expression/rational.hpp"

#include <limits>
#include <numeric>
#include <utility>

namespace cdot::derive {
namespace {

__extension__ using Wide = __int128;

constexpr Wide limit = std::numeric_limits<std::int64_t>::max();
thread_local bool rounds = false;

struct Fraction {
  Wide num, den;
  bool fits() const { return -limit <= num && num <= limit && den <= limit; }
};

// The last convergent p/q of the continued fraction that fits. With the next one P/Q it is off by less than 1/(q Q), a
// share of 1/(p Q) = 1/(P q), and P or Q is above `limit`.
Fraction rounded(Fraction of) {
  const bool negative = of.num < 0;
  if (negative) of.num = -of.num;
  Fraction before{0, 1}, now{1, 0};
  while (of.den != 0) {
    const Wide whole = of.num / of.den;
    if (whole > limit) break;
    const Fraction next{whole * now.num + before.num, whole * now.den + before.den};
    if (!next.fits()) break;
    before = std::exchange(now, next);
    of = {of.den, of.num % of.den};
  }
  if (now.den == 0 || now.num == 0) throw NumberTooLarge();
  return {negative ? -now.num : now.num, now.den};
}

Rational reduced(Wide num, Wide den) {
  Fraction exact{num, den};
  if (!exact.fits()) {
    Wide a = num < 0 ? -num : num, b = den;
    while (b != 0) a = std::exchange(b, a % b);
    exact = {num / a, den / a};
  }
  if (!exact.fits() && rounds) exact = rounded(exact);
  if (!exact.fits()) throw NumberTooLarge();
  return {static_cast<std::int64_t>(exact.num), static_cast<std::int64_t>(exact.den)};
}

}  // namespace

RoundedNumbers::RoundedNumbers() : before_(std::exchange(rounds, true)) {}
RoundedNumbers::~RoundedNumbers() { rounds = before_; }

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

// Most numbers of a program are 1 or -1, and a product by one of these is known as it stands.
Rational operator*(Rational a, Rational b) {
  if (a.den_ == 1 && (a.num_ == 1 || a.num_ == -1)) std::swap(a, b);
  if (b.den_ == 1 && (b.num_ == 1 || b.num_ == -1)) return b.num_ == 1 ? a : -a;
  return reduced(Wide(a.num_) * b.num_, Wide(a.den_) * b.den_);
}

Rational operator/(Rational a, Rational b) {
  if (b.num_ == 0) throw NumberTooLarge();
  if (b.den_ == 1 && (b.num_ == 1 || b.num_ == -1)) return a * b;
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
