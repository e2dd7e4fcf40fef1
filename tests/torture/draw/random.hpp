// Random numbers from a 64-bit seed, equal on every machine; the standard library's distributions are not.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace cdot::torture {

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  // splitmix64 (S. Vigna)
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  double unit() { return double(next() >> 11) * 0x1p-53; }  // 0 <= x < 1
  double between(double low, double high) { return low + (high - low) * unit(); }
  // Uniform in the logarithm.
  double log_between(double low, double high) { return low * std::exp(std::log(high / low) * unit()); }
  double either_sign(double x) { return next() & 1 ? x : -x; }
  bool chance(double probability) { return unit() < probability; }
  int below(int count) { return static_cast<int>(next() % static_cast<std::uint64_t>(count)); }
  template <class T>
  const T& of(const std::vector<T>& all) {
    return all[static_cast<std::size_t>(below(static_cast<int>(all.size())))];
  }
  // A point in the cube with that half side; in the plane z = 0.
  std::array<double, 3> in_cube(double half, bool in_space) {
    const double x = between(-half, half), y = between(-half, half);
    return {x, y, in_space ? between(-half, half) : 0};
  }

 private:
  std::uint64_t state_;
};

}  // namespace cdot::torture
