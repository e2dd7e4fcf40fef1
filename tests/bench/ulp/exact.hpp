// A number of CLN with 60 decimal digits, as a scalar of the kernels: the exact values for all other scalars.
#pragma once

#include <cln/complex.h>
#include <cln/float.h>
#include <cln/lfloat.h>
#include <cln/real.h>

#include <cdot/kernel.hpp>

namespace exact {

class Exact {
 public:
  Exact() : value_(zero()) {}
  Exact(float x) : Exact(static_cast<double>(x)) {}
  Exact(int x) : Exact(static_cast<double>(x)) {}
  Exact(double x) : value_(x == 0 ? zero() : cln::cl_float(cln::cl_DF(x), digits())) {}
  explicit Exact(const cln::cl_F& x) : value_(cln::cl_float(x, digits())) {}
  explicit operator double() const { return cln::double_approx(value_); }
  const cln::cl_F& value() const { return value_; }

  friend Exact operator+(const Exact& a, const Exact& b) { return Exact(a.value_ + b.value_); }
  friend Exact operator-(const Exact& a, const Exact& b) { return Exact(a.value_ - b.value_); }
  friend Exact operator-(const Exact& a) { return Exact(-a.value_); }
  friend Exact operator*(const Exact& a, const Exact& b) { return Exact(a.value_ * b.value_); }
  friend Exact operator/(const Exact& a, const Exact& b) { return Exact(a.value_ / b.value_); }
  friend bool operator<(const Exact& a, const Exact& b) { return a.value_ < b.value_; }
  friend bool operator>(const Exact& a, const Exact& b) { return a.value_ > b.value_; }
  friend bool operator<=(const Exact& a, const Exact& b) { return a.value_ <= b.value_; }
  friend bool operator>=(const Exact& a, const Exact& b) { return a.value_ >= b.value_; }

 private:
  static cln::float_format_t digits() {
    static const cln::float_format_t format = cln::float_format(60);
    return format;
  }
  static const cln::cl_F& zero() {
    static const cln::cl_F none = cln::cl_float(0, digits());
    return none;
  }
  cln::cl_F value_;
};

inline Exact of_real(const cln::cl_R& x) { return Exact(cln::cl_float(x, cln::float_format(60))); }
inline Exact abs(const Exact& a) { return Exact(cln::abs(a.value())); }
inline Exact sqrt(const Exact& a) { return Exact(cln::sqrt(a.value())); }
inline Exact sin(const Exact& a) { return Exact(cln::sin(a.value())); }
inline Exact cos(const Exact& a) { return Exact(cln::cos(a.value())); }
inline Exact tan(const Exact& a) { return Exact(cln::tan(a.value())); }
inline Exact exp(const Exact& a) { return Exact(cln::exp(a.value())); }
inline Exact log(const Exact& a) { return of_real(cln::ln(a.value())); }
// CLN's atan takes its arguments in reverse order and refuses (0, 0).
inline Exact atan2(const Exact& y, const Exact& x) {
  if (cln::zerop(y.value()) && cln::zerop(x.value())) return Exact(0);
  return of_real(cln::atan(cln::cl_R(x.value()), cln::cl_R(y.value())));
}
inline Exact asin(const Exact& a) { return of_real(cln::realpart(cln::asin(a.value()))); }
inline Exact inverse(const Exact& a) { return cln::zerop(a.value()) ? Exact(0) : Exact(1) / a; }
// Only a number that is zero to almost all digits is not a pivot here.
inline Exact pivot(const Exact& d, const Exact& k) { return d > Exact(1e-45) * abs(k) ? Exact(1) / d : Exact(0); }

}  // namespace exact

template <>
struct cdot::ScalarOf<exact::Exact> {
  using type = double;
};
