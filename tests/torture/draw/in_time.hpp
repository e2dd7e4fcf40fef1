// Numbers of a random mechanism's joints and effects that follow functions of time.
#pragma once

#include "tests/torture/draw/draw.hpp"

namespace cdot::torture {

// Each starts at the number that the scene has. `refused` receives the reasons why the World took one not.
template <class S>
void add_numbers_in_time(Random& random, const Scales& scales, Scene& scene, std::vector<std::string>& refused);

// Forces and torques on bodies and along coordinates that follow tables with kinks and jumps.
template <class S>
void add_tables(Random& random, const Scales& scales, Scene& scene, std::vector<std::string>& refused);

// True if a number of the joint itself follows one.
bool moves_in_time(const SceneJoint& joint);
// True if a number of the scene follows one.
bool has_numbers_in_time(const Scene& scene);

}  // namespace cdot::torture
