// A sequence that keeps its first elements in itself: most operations have two operands, and passes copy thousands.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <type_traits>
#include <utility>
#include <vector>

namespace cdot::derive {

template <class T, std::size_t N>
class Few {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  using value_type = T;

  Few() = default;
  Few(std::initializer_list<T> elements) { append(elements.begin(), elements.size()); }
  Few(const std::vector<T>& elements) { append(elements.data(), elements.size()); }
  Few(const Few& other) { copy(other); }
  Few(Few&& other) noexcept { take(other); }
  ~Few() { free(); }
  Few& operator=(const Few& other) {
    if (this != &other) size_ = 0, copy(other);
    return *this;
  }
  Few& operator=(Few&& other) noexcept {
    if (this == &other) return *this;
    free();
    take(other);
    return *this;
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T* begin() { return has_many() ? place_.many : place_.few; }
  T* end() { return begin() + size_; }
  const T* begin() const { return has_many() ? place_.many : place_.few; }
  const T* end() const { return begin() + size_; }
  T& operator[](std::size_t i) { return begin()[i]; }
  const T& operator[](std::size_t i) const { return begin()[i]; }
  T& back() { return begin()[size_ - 1]; }
  const T& back() const { return begin()[size_ - 1]; }

  void push_back(T element) {
    if (size_ == capacity_) reserve(2 * size_);
    begin()[size_++] = element;
  }
  void pop_back() { --size_; }
  void append(const T* elements, std::size_t n) {
    reserve(size_ + n);
    std::copy_n(elements, n, end());
    size_ += static_cast<std::uint32_t>(n);
  }
  // Takes the last elements away.
  void shorten(std::size_t size) { size_ = static_cast<std::uint32_t>(size); }

  friend bool operator==(const Few& a, const Few& b) { return std::equal(a.begin(), a.end(), b.begin(), b.end()); }

 private:
  union Place {
    Place() : few{} {}
    T few[N];
    T* many;
  };

  bool has_many() const { return capacity_ > N; }
  void free() {
    if (has_many()) delete[] place_.many;
  }
  void reserve(std::size_t n) {
    if (n <= capacity_) return;
    T* larger = new T[n];
    std::copy_n(begin(), size_, larger);
    free();
    place_.many = larger, capacity_ = static_cast<std::uint32_t>(n);
  }
  // Into an empty one.
  void copy(const Few& other) {
    if (has_many() || other.has_many()) append(other.begin(), other.size());
    else place_ = other.place_, size_ = other.size_;
  }
  void take(Few& other) {
    size_ = std::exchange(other.size_, 0);
    capacity_ = std::exchange(other.capacity_, N);
    place_ = other.place_;
  }

  std::uint32_t size_ = 0, capacity_ = N;
  Place place_;
};

}  // namespace cdot::derive
