// Starts of joints by their coordinates: start = { angle = "30 deg" }, start_rate = { angle = 2 }.
#pragma once

#include "runtime/tool/scene/entry.hpp"

namespace cdot {

inline constexpr const char *start_key = "start", *start_rate_key = "start_rate";

// Reads one of these keys.
void read_starts(Entry& joint, const char* key, const JointType& type, SceneJoint& to);

// The starts of the bodies of all joints that hang together with a started one. Poses: from the written ones in short
// steps, each a projection onto C = 0 with the coordinates held. Velocities: the written ones by the least change in
// the metric of the masses. A start out of reach is a mistake, with the distance that is left.
void find_starts(Scene& scene, Mistakes& mistakes);

}  // namespace cdot
