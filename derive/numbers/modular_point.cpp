#include "derive/numbers/modular_point.hpp"

#include <algorithm>
#include <iterator>

namespace cdot::derive {
namespace {

// (1 - t^2, 2 t) / (1 + t^2); the divisor is never zero since -1 is no square.
Rotation rotation_of(Modular t) {
  const Modular inv = inverse(Modular(1) + t * t);
  return {(Modular(1) - t * t) * inv, (t + t) * inv};
}

// (p+1)/4 halves the exponent: the root of a square that is a square itself. Of other numbers, the root of -x.
Modular root_of_square(Modular x) { return pow(x, (Modular::prime + 1) / 4); }

// (sqrt(6) + sqrt(2))/4, (sqrt(6) - sqrt(2))/4
Rotation turn_by_twelfth_of_pi() {
  const Modular root_2 = root_of_square(Modular(2)), root_6 = root_of_square(Modular(6));
  const Modular quarter = inverse(Modular(4));
  return {(root_6 + root_2) * quarter, (root_6 - root_2) * quarter};
}

}  // namespace

std::uint64_t Draws::seed_of(std::string_view leaf) const {
  const auto found = draws_.find(leaf);
  std::uint64_t mixed = Random(seed_ ^ (found == draws_.end() ? 0 : found->second << 32)).bits();
  for (const char letter : leaf) mixed = (mixed ^ static_cast<unsigned char>(letter)) * 0x100000001B3u;  // FNV-1a
  return mixed;
}

const std::string& Draws::choice(const Leaves& of_root, const Leaves& of_others) const {
  Leaves free;
  std::ranges::set_difference(of_root, of_others, std::inserter(free, free.end()));
  const Leaves& leaves = free.empty() ? of_root : free;
  std::uint64_t round = 0;
  for (const auto& [leaf, times] : draws_) round += times;
  const auto place = static_cast<std::ptrdiff_t>(Random(seed_ ^ round).bits() % leaves.size());
  return *of_root.find(*std::next(leaves.begin(), place));
}

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
  const Modular root = root_of_square(x);
  if (x.is_zero() || !(root * root == x)) throw UndefinedHere{};
  return root;
}

Modular ModularPoint::any_for(int kind, Modular x, Modular y) const {
  Random random(salt_ ^ (x.value() * 3 + y.value() * 5 + static_cast<std::uint64_t>(kind)));
  return Modular::of_bits(random.bits());
}

Rotation ModularPoint::turn(Modular x) {
  constexpr int most = 48;
  static const Modular one_twelfth = derive::inverse(Modular(12));
  static const Rotation by_twelfth = turn_by_twelfth_of_pi();
  const Modular twelfth = pi_ * one_twelfth;
  Modular below = x, above = x;  // x less so many twelfths of pi, and more
  for (int twelfths = 0; twelfths <= most; ++twelfths, below = below - twelfth, above = above + twelfth) {
    if (is_small(below)) return turn_by(below.centred()) * pow(by_twelfth, twelfths);
    if (is_small(above)) return turn_by(above.centred()) * pow(by_twelfth, -twelfths);
  }
  return rotation_of(arbitrary(3, x, x));
}

Modular ModularPoint::exponential(Modular x) {
  const std::int64_t whole = x.centred();
  if (!is_small(x)) return arbitrary(4, x, x);
  const Modular power = pow(base_, static_cast<std::uint64_t>(std::abs(whole)));
  return whole < 0 ? inverse(power) : power;
}

}  // namespace cdot::derive
