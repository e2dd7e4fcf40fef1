// Functions of the header over all bodies, as text.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "derive/compile/scene/mechanism.hpp"
#include "derive/compile/texts.hpp"

namespace cdot::compile {

struct BodyTexts {
  const Mechanism& mechanism;
  const std::vector<std::string>& names;  // in C++

  // Lines that set poses and velocities of the start.
  std::string start() const;
  // turn(): sine and cosine of the bodies in `turning`; rotation matrices. shift(): moves and turns.
  std::string turn(const std::set<std::string>& turning) const;
  // push(): forces other than the joints' for a step of Euler's method.
  std::string push() const;
  // weighed(): twice the kinetic energy.
  std::string weighed(bool with_bounds) const;
  std::string bounds_of_weighed() const;
  std::string energy(bool has_effects) const;
  // By the implicit midpoint rule: what judges a part of a step; drag(), if some body has drag.
  std::string judged() const;
  std::string dragged() const;

  // turn() of poses beside turned ones, in the plane: by their angles apart.
  std::string turn_beside(const std::vector<Named>& turning) const;

  // f(body, its name) for those that move.
  template <class F>
  void each(F f) const {
    for (std::size_t i = 0; i < mechanism.bodies.size(); ++i)
      if (mechanism.bodies[i].moves) f(mechanism.bodies[i], names[i]);
  }
};

}  // namespace cdot::compile
