// Names of scenes as identifiers of C++.
#pragma once

#include <set>
#include <string>

namespace cdot::compile {

// Names of the header itself, and words of C++ that a scene is likely to use.
std::set<std::string> taken_names();

// The name in letters, digits and `_`.
std::string identifier(const std::string& name);

// The name, with as many `_` behind it as it takes; joins those used.
std::string unused(std::string name, std::set<std::string>& used);

}  // namespace cdot::compile
