#include "tests/torture/draw/in_time.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "derive/interpret/formula.hpp"
#include "tests/torture/draw/spec_effects.hpp"

namespace cdot::torture {
namespace {

// A value of a joint, of an effect on bodies or of one on a coordinate.
struct Place {
  std::size_t joint, effects, spec;  // effects: none beyond their number
  std::size_t value;
  const JointType* type;
  const ParameterInfo* info;
};

NamedValue& value_at(Scene& scene, const Place& place) {
  SceneJoint& joint = scene.joints[place.joint];
  if (place.effects >= joint.effects.size()) return joint.definition.parameters[place.value];
  return joint.effects[place.effects].specs[place.spec].parameters[place.value];
}

// Directions of length 1 take constants only.
bool may_move(const ParameterInfo& info) {
  return info.kind == ParameterKind::scalar || info.kind == ParameterKind::point || info.kind == ParameterKind::vector;
}

void add_places(const JointType& type, const std::vector<NamedValue>& values, Place place, std::vector<Place>& places) {
  for (place.value = 0; place.value < values.size(); ++place.value) {
    const auto info = std::ranges::find(type.parameters, values[place.value].name, &ParameterInfo::name);
    if (info == type.parameters.end() || !may_move(*info)) continue;
    place.type = &type, place.info = &*info;
    places.push_back(place);
  }
}

// Joints with velocity rows take constants only.
std::vector<Place> places_in(const Scene& scene) {
  std::vector<Place> places;
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const SceneJoint& joint = scene.joints[j];
    const JointType& type = *find_joint_type(scene.dimension, joint.definition.type);
    if (std::ranges::count(type.row_kinds, RowKind::velocity) == 0)
      add_places(type, joint.definition.parameters, {j, joint.effects.size(), 0, 0, nullptr, nullptr}, places);
    for (std::size_t e = 0; e < joint.effects.size(); ++e)
      for (std::size_t s = 0; s < joint.effects[e].specs.size(); ++s) {
        const SpecEffect& spec = joint.effects[e].specs[s];
        if (in_time(spec.parameters)) continue;
        add_places(*find_coordinate_effect(spec.type), spec.parameters, {j, e, s, 0, nullptr, nullptr}, places);
      }
  }
  return places;
}

// The language reads numbers as fractions of 64-bit integers: at most 17 decimals.
std::string number_in_text(double x) {
  const int digits = x == 0 ? 1 : std::clamp(static_cast<int>(18 + std::floor(std::log10(std::abs(x)))), 6, 16);
  return fmt::format("{:.{}g}", x, digits);
}

// A share of the number, or of the mechanism's own unit, that keeps it in its range.
double random_way(Random& random, const Scales& scales, const ParameterInfo& info, double number) {
  const double share = random.log_between(0.02, 0.5);
  double size = info.kind == ParameterKind::scalar ? std::abs(number) : scales.length;
  if (size == 0 || info.unit == "rad") size = scale_of(info.unit, scales);
  size = std::min({size, number - info.above, info.below - number});
  return random.either_sign(share * size);
}

// 0 at the time 0, about 1 at most; w turns 0.3 to 3 times in the run.
std::string random_course(Random& random, double duration) {
  constexpr double pi = 3.14159265358979323846;
  const double w = 2 * pi * random.log_between(0.3, 3) / duration;
  switch (random.below(3)) {
    case 0: return fmt::format("sin({} [rad/s] * time)", number_in_text(w));
    case 1: return fmt::format("(1 - cos({} [rad/s] * time)) / 2", number_in_text(w));
    default: return fmt::format("{} [1/s] * time", number_in_text(1 / duration));
  }
}

// start + way * course, as a scene writes it.
std::optional<WrittenProfile> random_expression(Random& random, double start, double way, std::string_view unit,
                                                double duration, std::vector<std::string>& refused) {
  const std::string in_unit = unit == "1" ? "" : fmt::format(" [{}]", unit);
  const std::string text = fmt::format("{}{} + {}{} * {}", number_in_text(start), in_unit, number_in_text(way), in_unit,
                                       random_course(random, duration));
  const FormulaInTime::Reading read = FormulaInTime::read(text, unit);
  for (const FormulaMistake& mistake : read.mistakes) refused.push_back(mistake.cause);
  if (!read.formula) return {};
  const auto at = [formula = *read.formula](double time) {
    const auto [value, rate, acceleration] = formula.at(time);
    return ProfileValue{value, rate, acceleration};
  };
  return WrittenProfile{Profile::function(at), text, std::string(unit), {}};
}

// Rows from `start` on, within `way` of it. Joints take no jump, and no body can follow an end that jumps.
WrittenProfile random_table(Random& random, double start, double way, double duration, bool smooth) {
  ProfileTable table{.times = {0}, .values = {start}};
  const int rows = 3 + random.below(6);
  for (int k = 1; k < rows; ++k) {
    table.times.push_back(duration * (k + random.between(-0.3, 0.3)) / (rows - 1));
    table.values.push_back(start + way * random.between(-1, 1));
  }
  table.interpolation = random.of<Interpolation>({Interpolation::linear, Interpolation::cubic});
  if (!smooth && random.chance(0.3)) table.interpolation = Interpolation::step;
  if (!smooth && table.interpolation == Interpolation::linear && random.chance(0.5)) table.times[2] = table.times[1];
  return {Profile::table(table), {}, {}, table};
}

using Drawn = std::optional<WrittenProfile>;
Drawn random_function(Random& random, double start, double way, std::string_view unit, const Scene& scene, bool smooth,
                      std::vector<std::string>& refused) {
  if (random.chance(0.4)) return random_table(random, start, way, scene.duration, smooth);
  return random_expression(random, start, way, unit, scene.duration, refused);
}

// Ends and speeds in a form of their own become effects of specs, as a reader makes of them: before all others, the
// limit first.
SpecEffect as_spec(CoordinateEffects& effects, bool motor) {
  SpecEffect spec{motor ? "motor" : "limit"};
  if (motor) {
    spec.parameters.push_back({"speed", {effects.motor->speed}});
    if (effects.motor->max_force != unlimited) spec.parameters.push_back({"max", {effects.motor->max_force}});
    effects.motor.reset();
  } else {
    if (effects.limit->lower) spec.parameters.push_back({"lower", {*effects.limit->lower}});
    if (effects.limit->upper) spec.parameters.push_back({"upper", {*effects.limit->upper}});
    effects.limit.reset();
  }
  return spec;
}

struct Shorthand {
  std::size_t joint, effects;
  bool motor;
  std::string unit;
};

std::vector<Shorthand> shorthands_in(const Scene& scene) {
  std::vector<Shorthand> all;
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const JointType& type = *find_joint_type(scene.dimension, scene.joints[j].definition.type);
    for (std::size_t e = 0; e < scene.joints[j].effects.size(); ++e) {
      const CoordinateEffects& effects = scene.joints[j].effects[e];
      const std::string unit(std::ranges::find(type.coordinates, effects.coordinate, &CoordinateInfo::name)->unit);
      if (effects.limit) all.push_back({j, e, false, unit});
      if (effects.motor) all.push_back({j, e, true, unit + "/s"});
    }
  }
  return all;
}

// An end of a limit, or the speed of a motor.
template <class S>
void move_shorthand(Random& random, const Scales& scales, Scene& scene, std::vector<std::string>& refused) {
  const std::vector<Shorthand> all = shorthands_in(scene);
  if (all.empty()) return;
  const Shorthand place = random.of(all);
  CoordinateEffects effects = scene.joints[place.joint].effects[place.effects];
  SpecEffect spec = as_spec(effects, place.motor);
  NamedValue& value =
      spec.parameters[place.motor ? 0 : static_cast<std::size_t>(random.below(int(spec.parameters.size())))];
  const double start = value.numbers[0], size = start != 0 ? std::abs(start) : scale_of(place.unit, scales);
  const double way = random.either_sign(size * random.log_between(0.02, 0.5));
  const Drawn function = random_function(random, start, way, place.unit, scene, !place.motor, refused);
  if (!function) return;
  value.in_time.push_back({0, function->profile});
  const bool after_limit = place.motor && !effects.specs.empty() && effects.specs[0].type == "limit";
  effects.specs.insert(effects.specs.begin() + after_limit, spec);
  taken<S>(scene, refused, [&](Scene& trial) {
    trial.joints[place.joint].effects[place.effects] = effects;
    trial.profiles.push_back(*function);
  });
}

}  // namespace

template <class S>
void add_numbers_in_time(Random& random, const Scales& scales, Scene& scene, std::vector<std::string>& refused) {
  if (random.chance(0.4)) move_shorthand<S>(random, scales, scene, refused);
  const std::vector<Place> places = places_in(scene);
  for (int k = places.empty() ? 0 : 1 + random.below(3); k > 0; --k) {
    const Place place = random.of(places);
    const NamedValue& value = value_at(scene, place);
    const int number = random.below(static_cast<int>(value.numbers.size()));
    const double start = value.numbers[static_cast<std::size_t>(number)];
    if (!value.in_time.empty()) continue;
    const double way = random_way(random, scales, *place.info, start);
    const bool smooth = !place.type->is_effect || place.type->row_kinds.empty();
    const Drawn function = random_function(random, start, way, place.info->unit, scene, smooth, refused);
    if (!function) continue;
    taken<S>(scene, refused, [&](Scene& trial) {
      value_at(trial, place).in_time.push_back({number, function->profile});
      trial.profiles.push_back(*function);
    });
  }
}

namespace {

// A number of a force of about `size`, by a table that begins anywhere.
double follow_table(Random& random, double size, const Scene& scene, NamedValue& value, int number,
                    std::vector<WrittenProfile>& tables) {
  const double start = size * random.between(-1, 1);
  tables.push_back(random_table(random, start, size, scene.duration, false));
  value.in_time.push_back({number, tables.back().profile});
  return start;
}

// A push or a couple on a body.
template <class S>
void push_by_tables(Random& random, const Scales& scales, const std::string& name, Scene& scene,
                    std::vector<std::string>& refused) {
  const JointType& type = *find_joint_type(S::dimension, random.chance(0.5) ? "push" : "couple");
  SceneJoint effect = random_effect(random, scales, scene, type);
  effect.name = name;
  std::vector<WrittenProfile> tables;
  for (NamedValue& value : effect.definition.parameters) {
    const ParameterInfo& info = *std::ranges::find(type.parameters, value.name, &ParameterInfo::name);
    if (info.kind == ParameterKind::point) continue;
    const double size = scale_of(info.unit, scales) * random.log_between(0.1, 10);
    for (std::size_t k = 0; k < value.numbers.size(); ++k)
      value.numbers[k] = follow_table(random, size, scene, value, static_cast<int>(k), tables);
  }
  taken<S>(scene, refused, [&](Scene& trial) {
    trial.joints.push_back(effect);
    trial.profiles.insert(trial.profiles.end(), tables.begin(), tables.end());
  });
}

// A load on a coordinate that no other effect of a spec acts on.
template <class S>
void load_by_table(Random& random, const Scales& scales, Scene& scene, std::vector<std::string>& refused) {
  if (scene.joints.empty()) return;
  const auto j = static_cast<std::size_t>(random.below(static_cast<int>(scene.joints.size())));
  const JointType& type = *find_joint_type(S::dimension, scene.joints[j].definition.type);
  if (type.is_effect || type.coordinates.empty()) return;
  const auto c = static_cast<std::size_t>(random.below(static_cast<int>(type.coordinates.size())));
  const double size = scale_of(type.coordinates[c].unit == "rad" ? "N*m" : "N", scales) * random.log_between(0.1, 10);
  NamedValue push{"push", {0}};
  std::vector<WrittenProfile> tables;
  push.numbers[0] = follow_table(random, size, scene, push, 0, tables);
  taken<S>(scene, refused, [&](Scene& trial) {
    CoordinateEffects& effects = effects_on(trial.joints[j], type, c);
    if (!effects.specs.empty() || effects.load) return;
    effects.specs.push_back({"load", {push}});
    trial.profiles.push_back(tables.front());
  });
}

}  // namespace

template <class S>
void add_tables(Random& random, const Scales& scales, Scene& scene, std::vector<std::string>& refused) {
  for (int k = 1 + random.below(3); k > 0; --k) {
    if (random.chance(0.5)) load_by_table<S>(random, scales, scene, refused);
    else push_by_tables<S>(random, scales, fmt::format("t{}", k), scene, refused);
  }
}

bool moves_in_time(const SceneJoint& joint) { return in_time(joint.definition.parameters); }

bool has_numbers_in_time(const Scene& scene) {
  return std::ranges::any_of(scene.joints, [](const SceneJoint& joint) {
    return moves_in_time(joint) || std::ranges::any_of(joint.effects, [](const CoordinateEffects& effects) {
             return std::ranges::any_of(effects.specs, [](const SpecEffect& spec) { return in_time(spec.parameters); });
           });
  });
}

#define CDOT_INSTANTIATE(S)                                                                        \
  template void add_numbers_in_time<S>(Random&, const Scales&, Scene&, std::vector<std::string>&); \
  template void add_tables<S>(Random&, const Scales&, Scene&, std::vector<std::string>&);
CDOT_INSTANTIATE(Planar<double>)
CDOT_INSTANTIATE(Spatial<double>)
#undef CDOT_INSTANTIATE

}  // namespace cdot::torture
