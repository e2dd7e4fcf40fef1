// Text in an attribute or element of a page or a picture.
#pragma once

#include <string>
#include <string_view>

namespace cdot {

std::string escaped(std::string_view text);

}  // namespace cdot
