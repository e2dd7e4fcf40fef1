// Poses, velocities and their sums in a compiled struct, in the plane and in space, as text.
#pragma once

#include <string>

#include "derive/compile/equations.hpp"
#include "derive/compile/methods/contents.hpp"
#include "derive/compile/scene/mechanism.hpp"

namespace cdot::compile {

// Pose, Velocity and Rate, that of a pose; choose(), move(), rate_of(), in the struct of that name.
// `apart`: stages of a Runge-Kutta method read no centre of mass.
std::string types_of(const Mechanism& mechanism, const std::string& name, bool apart);

// The other types of a State: Jacobian, Inputs, Angles and more, as far as the scene has them.
std::string number_types_of(const Mechanism& mechanism, const Equations& equations, const Contents& has);

// Bodies that move, and numbers of a slope of a Runge-Kutta method: rates that each stage sums, and accelerations of
// centres of mass that are summed at the end alone.
struct SlopeSize {
  std::size_t bodies, rates, centres;
};
SlopeSize slope_size(const Mechanism& mechanism, bool apart);

// Numbers of a State for each body that moves: with its accelerations or, of a step at velocities, its momentum; pulls:
// the accelerations are those by joints.
long numbers_of(const Mechanism& mechanism, const Body& body, bool pulls);

}  // namespace cdot::compile
