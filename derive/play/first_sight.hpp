// The part of the page that is there before its engine has begun.
#pragma once

#include <nlohmann/json.hpp>

namespace cdot::play {

// {scene, spec, lecture}: the answers that the engine of the page will give for an example {scene, specs} among these
// files, and the spec whose derivation is shown first. Null if the example has mistakes: the page tells them.
nlohmann::json first_sight(const nlohmann::json& files, const nlohmann::json& example);

}  // namespace cdot::play
