// Numbers -> a fingerprint: FNV-1a of their bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cdot {

struct Hash {
  std::uint64_t value = 14695981039346656037ull;
  void bytes(const void* from, std::size_t count) {
    const auto* byte = static_cast<const unsigned char*>(from);
    for (std::size_t i = 0; i < count; ++i) value = (value ^ byte[i]) * 1099511628211ull;
  }
  template <class Number>
  void add(const Number& number) {
    bytes(&number, sizeof number);
  }
  template <class Number>
  void add(const std::vector<Number>& numbers) {
    add(numbers.size());
    bytes(numbers.data(), numbers.size() * sizeof(Number));
  }
};

}  // namespace cdot
