// Joints and effects that nobody compiled: a spec is derived while the program runs, and Worlds know its type by name
// from then on.
// Their kernels run as tapes with the bits of compiled ones; a step of ten links takes 2.5 to 3 times as long.
#pragma once

#include <string>

namespace cdot {

struct OwnType {
  std::string name;        // of the type; empty if the spec has errors
  bool has_bodies = true;  // false: an effect that acts on the coordinate of a joint and is no joint itself
  std::string problems;    // errors and warnings, each with its line and the likely fix
};

// Registers the joint of a *.joint file or the effect of an *.effect file: no other thread may use Worlds meanwhile. A
// file that has not changed since the last call gives the same type. If a type has the joint's name already, the new
// one is called "name#2".
OwnType add_own_type(const std::string& file);
// That file, of a type with bodies or on a coordinate; empty for a type that is compiled.
std::string file_of_own_type(const std::string& name);

}  // namespace cdot
