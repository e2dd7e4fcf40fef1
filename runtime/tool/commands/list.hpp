// The joints that a scene may name, with their parameters and coordinates.
#pragma once

#include <string>

namespace cdot {

std::string list_text();
std::string list_json();

}  // namespace cdot
