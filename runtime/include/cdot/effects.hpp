// Effects on the free coordinates of a joint. Each effect is one row of the coordinate with its own bias, softness and
// bounds. In a World without effects step() spends no time on them. `coordinate` is a name from the joint's spec
// ("angle", "slide"). All functions throw cdot::Error on misuse.
//
// The structs here are short forms of effects in specs/coordinate; effects/shorthand.cpp names the spec of each. Every
// other effect of a spec is a SpecEffect.
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
  std::optional<double> lower, upper;  // [m] or [rad], one or both; equal ends lock the coordinate
  bool acts_one_way() const { return true; }
};

struct Motor {
  double speed = 0;              // [m/s] or [rad/s]
  double max_force = unlimited;  // [N] or [N m]
  bool acts_one_way() const { return true; }
};

struct CoordinateSpring {
  Softness softness;                 // a damper alone: stiffness 0 and a damping
  std::optional<double> rest = 0.0;  // [m] or [rad]; without it: the coordinate's value when the spring is added
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

// An effect of a spec on the coordinate of any joint, if its law is about one coordinate alone (coordinate_effects() in
// joints.hpp): {"servo", {{"k", {50}}, {"most", {3}}}}. Parameters with a default may be missing.
struct SpecEffect {
  std::string type;
  std::vector<NamedValue> parameters{};
  bool acts_one_way() const;
};

// All effects on one coordinate of a joint.
struct CoordinateEffects {
  std::string coordinate;
  std::optional<Limit> limit{};
  std::optional<Motor> motor{};
  std::vector<CoordinateSpring> springs{};  // a damper is a spring without stiffness
  std::optional<DryFriction> friction{};
  std::optional<Load> load{};
  std::vector<SpecEffect> specs{};

  // f(effect) for each, in the order in which a scene adds them.
  template <class F>
  void each(F f) const {
    if (limit) f(*limit);
    if (motor) f(*motor);
    for (const SpecEffect& spec : specs) f(spec);  // before springs, so that sweeps end with these
    for (const CoordinateSpring& spring : springs) f(spring);
    if (friction) f(*friction);
    if (load) f(*load);
  }
};

// Adds one of these effects. Returns its number among those of the joint; -1 if all bodies of the joint are immovable.
template <class S, class Effect>
int add_effect(BasicWorld<S>& world, int joint, std::string_view coordinate, const Effect& effect);

// The effect must act on coordinates in the unit of this one. A default that is the effect's own coordinate is the
// value that this one has now.
template <class S>
int add_effect(BasicWorld<S>& world, int joint, std::string_view coordinate, const SpecEffect& effect);

// The same of an effect on the joint itself, as `breaking`. The Runge-Kutta methods locate its event within the step;
// by the others, and by sweeps, the joint breaks after the first step whose end the event has reached. The direct
// solver shares a load among redundant joints; of several joints that would break and are connected, the most
// overloaded one breaks first. Parameters are constants.
template <class S>
void add_effect(BasicWorld<S>& world, int joint, const SpecEffect& effect);

// Changes the given parameters; the others stay.
template <class S>
void set_effect(BasicWorld<S>& world, int joint, int number, const SpecEffect& effect);

// Changes the constants of an effect from the next step on and wakes the joint's island. max_force = 0 switches a motor
// off; the ends -unlimited and unlimited switch a limit off.
template <class S, class Effect>
void set_effect(BasicWorld<S>& world, int joint, int number, const Effect& effect);

// The short form of `breaking`: the joint breaks where the norm of its row forces reaches the load [N, N m].
template <class S>
void set_breaking_load(BasicWorld<S>& world, int joint, double load);

// --- The kinds, as a scene writes them: angle.motor = { speed = 2, max = 10 }.

struct EffectNumber {
  enum Range { as_coordinate, any, positive, not_negative };  // as_coordinate: any sign, in the coordinate's unit
  const char* key = nullptr;
  Range range = any;
  const char* example = nullptr;  // of a required number
};

struct EffectKind {
  // A number, a table of numbers, or a table that may be written as a pair.
  enum Form { number, table, pair };
  // A number as read; `written` without a value is an error.
  struct Given {
    bool written = false;
    std::optional<double> value;
  };
  struct Wrong {
    std::string cause, fix;  // "{}" in the cause stands for the table
  };
  const char *key, *example, *meaning;
  Form form;
  EffectNumber numbers[5];  // ends at the first without a key
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
