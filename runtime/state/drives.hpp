// Numbers of joints and effects that follow functions of time: checked, and noted in the Model.
#pragma once

#include <vector>

#include <cdot/joints.hpp>
#include <cdot/settings.hpp>

#include "runtime/state/world_data.hpp"

namespace cdot {

// The same values, with the numbers that their functions have at this time.
std::vector<NamedValue> at_time(std::vector<NamedValue> given, double time);

// Throws Error if a value follows a function of time: only what is added does.
void refuse_functions(const std::vector<NamedValue>& given, const char* where);

// Throws Error if these numbers of the joint, or of its effect at this place, follow functions of time. place as in
// JointDrive.
void refuse_driven(const JointModel& joint, const JointType& type, int place, const std::vector<NamedValue>& given);

// Throws Error if these values of a joint or an effect of this type cannot follow their functions.
void check_functions(const JointType& type, const std::vector<NamedValue>& given);

// Notes them; of a joint its points in the world lie relative to the origin.
template <class S>
void add_drives(WorldData<S>& world, int joint, int place, const JointType& type, const std::vector<NamedValue>& given);

}  // namespace cdot
