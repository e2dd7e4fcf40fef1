// A number as a person writes it, also as a fraction.
#pragma once

#include <optional>
#include <string_view>

namespace cdot::text {

// Takes "0.5" or "1/60" off the start of the text; nothing if it does not begin with a number.
std::optional<double> take_number(std::string_view& text);

}  // namespace cdot::text
