// Numbers of a World's State. During setup each array has its own memory. Preparation moves all of them into one block
// of bytes (runtime/state/block.hpp), which is copied, saved and compared as a whole.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

namespace cdot {

// An array. A copy has its own memory; assignment of an array of the same size writes into the block.
template <class T>
class StateArray {
 public:
  StateArray() = default;
  StateArray(const StateArray& other) : own_(other.begin(), other.end()) { come_home(); }
  StateArray(StateArray&& other) noexcept { swap(other); }
  StateArray& operator=(const StateArray& other) {
    if (size_ == other.size_) std::copy(other.begin(), other.end(), begin());
    else assign(other.begin(), other.end());
    return *this;
  }
  StateArray& operator=(StateArray&& other) noexcept {
    swap(other);
    return *this;
  }

  StateArray& operator=(const std::vector<T>& numbers) {
    if (size_ == numbers.size()) std::copy(numbers.begin(), numbers.end(), begin());
    else assign(numbers.begin(), numbers.end());
    return *this;
  }
  operator std::vector<T>() const { return {begin(), end()}; }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T* data() { return at_; }
  const T* data() const { return at_; }
  T* begin() { return at_; }
  T* end() { return at_ + size_; }
  const T* begin() const { return at_; }
  const T* end() const { return at_ + size_; }
  T& operator[](std::size_t i) { return at_[i]; }
  const T& operator[](std::size_t i) const { return at_[i]; }
  const T& at(std::size_t i) const {
    if (i >= size_) throw std::out_of_range("StateArray::at");
    return at_[i];
  }

  // Only during setup: the numbers leave the block.
  void push_back(const T& number) {
    leave_block();
    own_.push_back(number);
    come_home();
  }
  void append(std::size_t count, const T& number) {
    leave_block();
    own_.insert(own_.end(), count, number);
    come_home();
  }
  template <class Iterator>
  void append(Iterator first, Iterator last) {
    leave_block();
    own_.insert(own_.end(), first, last);
    come_home();
  }
  template <class Iterator>
  void assign(Iterator first, Iterator last) {
    own_.assign(first, last);
    come_home();
  }
  void assign(std::size_t count, const T& number) {
    own_.assign(count, number);
    come_home();
  }
  void resize(std::size_t count) {
    leave_block();
    own_.resize(count);
    come_home();
  }

  // Moves the numbers to `to`, in the block.
  void settle(void* to) {
    T* const there = static_cast<T*>(to);
    if (size_ > 0) std::memcpy(to, at_, size_ * sizeof(T));
    at_ = there;
    own_ = {};
  }

 private:
  void swap(StateArray& other) {
    std::swap(own_, other.own_), std::swap(at_, other.at_), std::swap(size_, other.size_);
  }
  void come_home() { at_ = own_.data(), size_ = own_.size(); }
  void leave_block() {
    if (at_ != own_.data()) own_.assign(begin(), end()), come_home();
  }

  std::vector<T> own_;
  T* at_ = nullptr;
  std::size_t size_ = 0;
};

// A single number, used like one.
template <class T>
class StateNumber {
 public:
  StateNumber(T number = {}) : own_(number) {}  // NOLINT: converts implicitly
  StateNumber(const StateNumber& other) : own_(*other.at_) {}
  StateNumber(StateNumber&& other) noexcept : own_(*other.at_), at_(other.at_ == &other.own_ ? &own_ : other.at_) {}
  StateNumber& operator=(const StateNumber& other) { return *this = *other.at_; }
  StateNumber& operator=(StateNumber&& other) noexcept {
    own_ = *other.at_;
    at_ = other.at_ == &other.own_ ? &own_ : other.at_;
    return *this;
  }
  StateNumber& operator=(const T& number) {
    *at_ = number;
    return *this;
  }

  template <class Number>
  StateNumber& operator+=(const Number& number) {
    *at_ += number;
    return *this;
  }
  template <class Number>
  StateNumber& operator&=(const Number& number) {
    *at_ &= number;
    return *this;
  }

  operator T&() { return *at_; }
  operator const T&() const { return *at_; }
  T* operator->() { return at_; }
  const T* operator->() const { return at_; }

  static constexpr std::size_t size() { return 1; }
  void settle(void* to) {
    T* const there = static_cast<T*>(to);
    std::memcpy(to, at_, sizeof(T));
    at_ = there;
  }

 private:
  T own_;
  T* at_ = &own_;
};

}  // namespace cdot
