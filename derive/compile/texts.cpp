#include "derive/compile/texts.hpp"

#include <cctype>
#include <sstream>

namespace cdot::compile {
namespace {

bool is_of_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.'; }

// The name `i` as that place.
std::string at_place(const std::string& text, const std::string& place) {
  std::string placed;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const bool is_i = text[at] == 'i' && at > 0 && !is_of_name(text[at - 1]) && !is_of_name(text[at + 1]);
    placed += is_i ? place : text.substr(at, 1);
  }
  return placed;
}

}  // namespace

std::string unrolled(const std::string& text, const Counts& counts) {
  const struct {
    std::string head;
    std::size_t count, few;
  } loops[] = {{"for (int i = 0; i < bodies; ++i) ", counts.bodies, 16},
               {"for (int i = 0; i < rows; ++i) ", counts.rows, 16},
               {"for (int i = 0; i < Slope::size; ++i) ", counts.rates, 24}};
  std::string lines;
  std::istringstream all(text);
  for (std::string line; std::getline(all, line);) {
    std::string here = line + "\n";
    for (const auto& [head, count, few] : loops) {
      const std::size_t at = line.find(head);
      if (at == std::string::npos || line.find_first_not_of(' ') != at || count > few) continue;
      here.clear();
      for (std::size_t i = 0; i < count; ++i)
        here += at_place(line.substr(0, at) + line.substr(at + head.size()), std::to_string(i)) + "\n";
    }
    lines += here;
  }
  return lines;
}

}  // namespace cdot::compile
