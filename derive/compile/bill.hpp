// The cost of each joint and effect of a scene in a step, and the savings of dropping it.
#pragma once

#include <string>
#include <vector>

#include "derive/compile/header.hpp"
#include "derive/compile/scene/mechanism.hpp"

namespace cdot::compile {

// A joint, an effect, gravity, or a force or damping on a body.
struct Part {
  std::string name;   // "joint hinge (revolute)"
  Mechanism without;  // the mechanism, but this
  Mechanism alone;    // the bodies with this
};
std::vector<Part> parts_of(const Mechanism& mechanism);

// A table, or JSON.
std::string bill_of(const Mechanism& mechanism, const derive::SpecsFolder& specs, bool as_json);

}  // namespace cdot::compile
