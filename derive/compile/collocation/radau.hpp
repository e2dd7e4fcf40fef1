// step() of Radau IIA with three stages as text. As the World does it: runtime/step/collocation.hpp.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"
#include "derive/compile/scene/mechanism.hpp"

namespace cdot::compile {

std::string radau(const Mechanism& mechanism, const Contents& has);

// In a step with one round of Newton: of its matrices and vectors, beside the calls of a header's functions.
long operations_of_collocation(std::size_t components);

}  // namespace cdot::compile
