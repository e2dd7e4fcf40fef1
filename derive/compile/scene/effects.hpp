// The effects of a scene as numbers: the World has completed them.
#pragma once

#include <functional>
#include <map>
#include <string>

#include <cdot/world.hpp>

#include "derive/compile/scene/mechanism.hpp"
#include "runtime/state/world_data.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot::compile {

// refuse(joint of the scene, or null for a spring; what it is): for effects that cannot be compiled.
using RefuseEffect = std::function<void(const SceneJoint&, const std::string&)>;

// True for a joint whose one row is an inequality: it is a row with bounds.
bool is_rope(const JointType& type);

// The functions of time that numbers of a place follow (of its rows; -1: its own), by number; adds their tables to the
// mechanism. False if a program has given one. `moves`: they prescribe positions, so that steps end at their kinks.
bool find_functions(const Scene& scene, const JointRecord& record, int place, bool moves, Mechanism& mechanism,
                    std::map<std::size_t, InTime>& in_time);

// The rows by which the World counts the stiffness of tension of a place.
template <class S>
int tensions_of(BasicWorld<S>& world, const Place& place);

// True if rows of a joint of the World count whole turns; those of a type: runtime/include/cdot/detail/turns.hpp.
template <class S>
bool counts_turns(BasicWorld<S>& world, int joint);
std::vector<CountedTurns> turns_of(const JointType& type, Mechanism& mechanism);

template <class S>
void read_effects(const Scene& scene, BasicWorld<S>& world, const RefuseEffect& refuse, Mechanism& mechanism);

}  // namespace cdot::compile
