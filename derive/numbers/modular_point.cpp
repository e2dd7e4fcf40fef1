#include "derive/numbers/modular_point.hpp"

namespace cdot::derive {
namespace {

// (1 - t^2, 2 t) / (1 + t^2); the divisor is never zero since -1 is no square.
Rotation rotation_of(Modular t) {
  const Modular inv = inverse(Modular(1) + t * t);
  return {(Modular(1) - t * t) * inv, (t + t) * inv};
}

}  // namespace

Rotation operator*(Rotation a, Rotation b) { return {a.c * b.c - a.s * b.s, a.s * b.c + a.c * b.s}; }

Rotation pow(Rotation r, std::int64_t exponent) {
  if (exponent < 0) return pow(Rotation{r.c, Modular(0) - r.s}, -exponent);
  Rotation result;
  for (; exponent > 0; exponent /= 2, r = r * r) {
    if (exponent % 2 == 1) result = result * r;
  }
  return result;
}

ModularPoint::ModularPoint(std::uint64_t seed) : random_(seed), salt_(random_.bits()) {
  unit_turn_ = any_rotation();
  base_ = any();
  // A turn by pi/4: of order 8 in the group of rotations, which has 2^61 elements.
  eighth_turn_ = any_rotation();
  for (int i = 0; i < 58; ++i) eighth_turn_ = eighth_turn_ * eighth_turn_;
  pi_ = any();
}

Rotation ModularPoint::any_rotation() { return rotation_of(any()); }

Modular ModularPoint::inverse(Modular x) const {
  if (x.is_zero()) throw UndefinedHere{};
  return derive::inverse(x);
}

Modular ModularPoint::call(Fn fn, std::span<const Modular> args) {
  const Modular x = args[0];
  switch (fn) {
    case Fn::sin: return turn(x).s;
    case Fn::cos: return turn(x).c;
    case Fn::exp: return exponential(x);
    case Fn::inverse:
    case Fn::pivot: return inverse(x);
    case Fn::sqrt:
    case Fn::abs:
    case Fn::select: break;
    // log and atan2 obey no law here.
    default: return arbitrary(6 + static_cast<int>(fn), x, args.back());
  }
  holds_for_reals_ = false;  // they ask for signs
  if (fn == Fn::select) return sign(x) == Modular(1) ? args[1] : args[2];
  return root(fn == Fn::abs ? x * x : x);
}

Modular ModularPoint::arbitrary(int kind, Modular x, Modular y) {
  holds_for_reals_ = false;
  return any_for(kind, x, y);
}

Modular ModularPoint::sign(Modular x) const {
  if (x.is_zero()) throw UndefinedHere{};
  return Modular(x.is_square() ? 1 : -1);
}

Modular ModularPoint::root(Modular x) const {
  if (!x.is_square()) throw UndefinedHere{};
  return pow(x, std::uint64_t{1} << 59);  // x^((p+1)/4), a square itself
}

Modular ModularPoint::any_for(int kind, Modular x, Modular y) const {
  Random random(salt_ ^ (x.value() * 3 + y.value() * 5 + static_cast<std::uint64_t>(kind)));
  return Modular::of_bits(random.bits());
}

Rotation ModularPoint::turn(Modular x) {
  for (int eighths = -16; eighths <= 16; ++eighths) {
    const Modular rest = x - Modular(eighths) * pi_ * derive::inverse(Modular(4));
    if (std::abs(rest.centred()) < small_bound) {
      return turn_by(rest.centred()) * pow(eighth_turn_, eighths);
    }
  }
  return rotation_of(arbitrary(3, x, x));
}

Modular ModularPoint::exponential(Modular x) {
  const std::int64_t whole = x.centred();
  if (std::abs(whole) >= small_bound) return arbitrary(4, x, x);
  const Modular power = pow(base_, static_cast<std::uint64_t>(std::abs(whole)));
  return whole < 0 ? inverse(power) : power;
}

}  // namespace cdot::derive
