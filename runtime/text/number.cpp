#include "runtime/text/number.hpp"

#include <charconv>

namespace cdot::text {
namespace {

std::optional<double> take_decimal(std::string_view& text) {
  double value = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) return {};
  text.remove_prefix(static_cast<std::size_t>(rest - text.data()));
  return value;
}

}  // namespace

std::optional<double> take_number(std::string_view& text) {
  std::optional<double> value = take_decimal(text);
  if (!value || !text.starts_with("/")) return value;
  text.remove_prefix(1);
  const std::optional<double> divisor = take_decimal(text);
  return divisor ? std::optional(*value / *divisor) : std::nullopt;
}

}  // namespace cdot::text
