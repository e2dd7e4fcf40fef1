// Texts and numbers one after the other in a string, and back: what a process hands to another one,
// and what is kept in a file.
#pragma once

#include <charconv>
#include <stdexcept>
#include <string>
#include <string_view>

namespace cdot::derive {

class Parcel {
 public:
  void put(std::string_view part) { content_ += std::to_string(part.size()) + ":" + std::string(part); }
  void put(int number) { put(std::to_string(number)); }
  const std::string& content() const { return content_; }

 private:
  std::string content_;
};

// Takes out what was put in, in the same order; throws Damaged where it cannot have been put so.
class Unpacking {
 public:
  struct Damaged : std::runtime_error {
    Damaged() : std::runtime_error("damaged") {}
  };
  explicit Unpacking(std::string_view content) : rest_(content) {}

  std::string text() {
    const std::size_t colon = rest_.find(':');
    if (colon == rest_.npos) throw Damaged{};
    const auto size = static_cast<std::size_t>(parsed(rest_.substr(0, colon)));
    if (size > rest_.size() - colon - 1) throw Damaged{};
    std::string part(rest_.substr(colon + 1, size));
    rest_.remove_prefix(colon + 1 + size);
    return part;
  }
  int number() { return parsed(text()); }

 private:
  static int parsed(std::string_view digits) {
    int number = -1;
    const auto end = digits.data() + digits.size();
    if (std::from_chars(digits.data(), end, number).ptr != end || number < 0) throw Damaged{};
    return number;
  }

  std::string_view rest_;
};

}  // namespace cdot::derive
