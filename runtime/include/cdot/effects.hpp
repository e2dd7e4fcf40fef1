// What a scene may ask of a joint's free coordinates. Each effect is one row of the coordinate with
// its own bias, softness and bounds; a World in which nobody calls these functions has no trace of
// them in step(). `coordinate` is a name from the joint's spec ("angle", "slide"). All throw
// cdot::Error on misuse.
//
// A kind of effect is a struct here, its member and its kind in the lists below, and one file, effects/<kind>.cpp.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <cdot/world.hpp>

namespace cdot {

inline constexpr double unlimited = std::numeric_limits<double>::infinity();

struct Limit {
  std::optional<double> lower, upper;  // [m] or [rad]; one or both; equal: the coordinate is locked
  bool acts_one_way() const { return true; }
};

struct Motor {
  double speed = 0;              // [m/s] or [rad/s]
  double max_force = unlimited;  // [N] or [N m]
  bool acts_one_way() const { return true; }
};

struct CoordinateSpring {
  Softness softness;                 // a damper alone: stiffness 0 and a damping
  std::optional<double> rest = 0.0;  // [m] or [rad]; none: where the coordinate is when the spring is added
  bool acts_one_way() const { return softness.damping > 0 || softness.damping_ratio > 0; }
};

struct DryFriction {
  double max_force = 0;  // [N] or [N m]
  bool acts_one_way() const { return true; }
};

struct Load {
  double force = 0;  // [N] or [N m], constant, along the coordinate
  bool acts_one_way() const { return false; }
};

// All that acts on one coordinate of a joint.
struct CoordinateEffects {
  std::string coordinate;
  std::optional<Limit> limit{};
  std::optional<Motor> motor{};
  std::vector<CoordinateSpring> springs{};  // a damper is a spring without stiffness
  std::optional<DryFriction> friction{};
  std::optional<Load> load{};

  // f(effect) for each, in the order in which a scene adds them.
  template <class F>
  void each(F f) const {
    if (limit) f(*limit);
    if (motor) f(*motor);
    for (const CoordinateSpring& spring : springs) f(spring);
    if (friction) f(*friction);
    if (load) f(*load);
  }
};

// Adds one of these effects. Returns its number among those of its joint; -1 where the joint connects only immovable
// bodies.
template <class S, class Effect>
int add_effect(BasicWorld<S>& world, int joint, std::string_view coordinate, const Effect& effect);

// While a World runs: other numbers for the effect of that number, from the next step on. Wakes the joint's island. A
// motor whose largest force is 0 is switched off, and so is a limit from -unlimited to unlimited; a limit with two ends
// and a locked coordinate do not become each other.
template <class S, class Effect>
void set_effect(BasicWorld<S>& world, int joint, int number, const Effect& effect);

// The joint disappears after the first step in which the norm of its row forces exceeds the load
// [N, N m].
template <class S>
void set_breaking_load(BasicWorld<S>& world, int joint, double load);

// --- The kinds, as a scene writes them: angle.motor = { speed = 2, max = 10 }.

struct EffectNumber {
  enum Range { as_coordinate, any, positive, not_negative };  // as_coordinate: of any sign, an angle if that is one
  const char* key = nullptr;
  Range range = any;
  const char* example = nullptr;  // of a number that must be given
};

struct EffectKind {
  // A number by itself, a table of numbers, or one that may be a pair.
  enum Form { number, table, pair };
  // A number as it was read: it may be written and wrong.
  struct Given {
    bool written = false;
    std::optional<double> value;
  };
  struct Wrong {
    std::string cause, fix;  // "{}" in the cause stands for the table
  };
  const char *key, *example, *meaning;
  Form form;
  EffectNumber numbers[5];  // up to the first without a key
  std::optional<Wrong> (*take)(std::span<const Given> numbers, CoordinateEffects& effects);
};

extern const EffectKind limit_kind, motor_kind, spring_kind, damper_kind, friction_kind, load_kind;

inline constexpr const EffectKind* effect_kinds[] = {&limit_kind,  &motor_kind,    &spring_kind,
                                                     &damper_kind, &friction_kind, &load_kind};

// --- By name.

template <class S>
int add_limit(BasicWorld<S>& world, int joint, std::string_view coordinate, const Limit& limit) {
  return add_effect(world, joint, coordinate, limit);
}
template <class S>
int add_motor(BasicWorld<S>& world, int joint, std::string_view coordinate, const Motor& motor) {
  return add_effect(world, joint, coordinate, motor);
}
template <class S>
int add_spring(BasicWorld<S>& world, int joint, std::string_view coordinate, const CoordinateSpring& spring) {
  return add_effect(world, joint, coordinate, spring);
}
template <class S>
int add_friction(BasicWorld<S>& world, int joint, std::string_view coordinate, const DryFriction& friction) {
  return add_effect(world, joint, coordinate, friction);
}
template <class S>
void set_limit(BasicWorld<S>& world, int joint, int effect, const Limit& limit) {
  set_effect(world, joint, effect, limit);
}
template <class S>
void set_motor(BasicWorld<S>& world, int joint, int effect, const Motor& motor) {
  set_effect(world, joint, effect, motor);
}
template <class S>
void set_spring(BasicWorld<S>& world, int joint, int effect, const CoordinateSpring& spring) {
  set_effect(world, joint, effect, spring);
}
template <class S>
void set_friction(BasicWorld<S>& world, int joint, int effect, const DryFriction& friction) {
  set_effect(world, joint, effect, friction);
}

}  // namespace cdot
