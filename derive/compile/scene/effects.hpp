// The effects of a scene as numbers: the World has completed them.
#pragma once

#include <functional>
#include <string>

#include <cdot/world.hpp>

#include "derive/compile/scene/mechanism.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot::compile {

// refuse(joint of the scene, or null for a spring; what it is): for effects that cannot be compiled.
using RefuseEffect = std::function<void(const SceneJoint&, const std::string&)>;

// True for a joint whose one row is an inequality: it is a row with bounds.
bool is_rope(const JointType& type);

template <class S>
void read_effects(const Scene& scene, BasicWorld<S>& world, const RefuseEffect& refuse, Mechanism& mechanism);

}  // namespace cdot::compile
