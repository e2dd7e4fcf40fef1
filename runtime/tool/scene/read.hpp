// Shared by the parts of the scene reader: the names of the bodies, and points in the frame of the world or a body.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "runtime/tool/scene/entry.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {

// The bodies by name. It also knows bodies with mistakes, so that joints to them cause no second mistake.
class BodyNames {
 public:
  explicit BodyNames(const Scene& scene);
  // The index of each name in `key`; world_body for "world". An unknown name is a mistake, and gives nothing.
  std::optional<std::vector<int>> find(Entry& entry, const std::string& key) const;
  const std::string& name(int body) const;
  // A world position or direction in the frame of a body at its initial pose.
  Vec3 to_body(int body, const Vec3& world_position) const;
  Vec3 turned_to_body(int body, const Vec3& world_direction) const;
  Vec3 to_world(int body, const Vec3& body_position) const;
  Dimension dimension() const { return scene_->dimension; }

 private:
  const Scene* scene_;
  std::map<std::string, int> index_;
  std::vector<std::string> known_;
};

// [x, y], in space [x, y, z].
std::optional<Vec3> read_vector(Entry& entry, const std::string& key, Dimension dimension);

// A point of a body, or a direction: [x, y] in its frame; or { world = [x, y] } at the start, which to_body() or
// turned_to_body() takes there.
std::optional<Vec3> read_of_body(Entry& entry, const std::string& key, int body, const BodyNames& names,
                                 Vec3 (BodyNames::*from_world)(int, const Vec3&) const);

// A name that is new and fits a CSV column; `fallback` if the entry has none.
std::optional<std::string> read_name(Entry& entry, std::map<std::string, Span>& used,
                                     const std::optional<std::string>& fallback);

// The place of a mistake in a text: inside its quotes, if the file has the text as it is.
Span place_in(Span whole, const std::string& text, const FormulaMistake& mistake);  // tool/scene/profile.cpp

// The effects on the coordinates of a joint, those on the joint itself, and `soft`, which makes it a spring.
void read_bonds(Entry& joint, Scene& scene, std::vector<SpecEffect>& to);
void read_effects(Entry& joint, const JointType& type, Scene& scene,
                  std::vector<CoordinateEffects>& to);  // tool/scene/effects.cpp
std::optional<Softness> read_softness(Entry& joint, const char* key);

// Types that nobody compiled (tool/scene/own_types.cpp). The spec that `name` means beside the scene; empty if there is
// none.
std::string spec_beside(const Entry& entry, const std::string& name, const std::vector<std::string>& endings);
// The type of a spec for the `type` of a joint, and for the effect `key` of a coordinate. Null after a mistake.
const JointType* own_joint_type(Entry& joint, Dimension dimension, const std::string& spec);
const JointType* own_effect_type(Entry& coordinate, const std::string& key, const std::string& spec);

// toml++ bounds nested values itself, but not the parts of a dotted key, each of which costs a stack frame. No key of a
// scene has more than this.
inline constexpr int most_parts_of_key = 16;
// The first key a.b.c… with too many parts: where the first part beyond the bound begins.
std::optional<Span> find_deep_key(std::string_view text);  // tool/scene/depth.cpp

void read_settings(Entry& top, Scene& scene);                         // tool/scene/settings.cpp
void read_bodies(Entry& top, Scene& scene);                           // tool/scene/bodies.cpp
void find_forces_in_time(Scene& scene);                               // tool/scene/bodies.cpp
void read_joints(Entry& top, const BodyNames& names, Scene& scene);   // tool/scene/joints.cpp
void read_springs(Entry& top, const BodyNames& names, Scene& scene);  // tool/scene/joints.cpp
void read_sensors(Entry& top, Scene& scene);                          // tool/scene/sensors.cpp

}  // namespace cdot
