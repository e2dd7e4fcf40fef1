// A first scene for a spec: bodies side by side, so that a new joint moves before anybody writes a scene.
#pragma once

#include <string>

namespace cdot::play {

// The text of a scene for the joint or effect of this file. The name of the file must be that of the type. Throws Error
// with the messages of `cdot check` if the spec has mistakes.
std::string trial_scene(const std::string& spec);

}  // namespace cdot::play
