// The parameters of a joint as lines of a kernel.
#pragma once

#include <string>
#include <vector>

#include "derive/language/joint.hpp"

namespace cdot::derive {

std::string literal(const std::string& s);  // as a string of C++

bool may_be_unlimited(const Parameter& p);  // by its default

// struct Parameters, and an array with a ParameterInfo for each.
std::vector<std::string> parameters_described(const Joint& joint);
// struct Parameters, and the index of each by its name.
std::vector<std::string> parameters_alone(const Joint& joint);

}  // namespace cdot::derive
