// Effects of specs on the coordinate of any joint: their laws, with the parameters as constants of the row.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include <cdot/coordinate/registry.hpp>
#include <cdot/detail/coordinate_effects.hpp>
#include <cdot/planar.hpp>
#include <cdot/planar/registry.hpp>
#include <cdot/spatial.hpp>
#include <cdot/spatial/registry.hpp>

#include "runtime/effects/effect.hpp"
#include "runtime/rows/parameters.hpp"
#include "runtime/state/checks.hpp"
#include "runtime/state/drives.hpp"

namespace cdot {
namespace {

template <class Effect, class... Others>
constexpr bool has_name_of(std::type_identity<std::tuple<Others...>>) {
  return ((Effect::name == Others::name) || ...);
}

// f(std::type_identity<Effect>, std::type_identity<Pose<double>>) for each; of equal names that of any coordinate, or
// else that of the plane.
template <class F>
void each_coordinate_effect(F f) {
  const auto in_space = [&]<class Pose, class Others, class... Effects>(std::type_identity<std::tuple<Effects...>>,
                                                                        std::type_identity<Others>,
                                                                        std::type_identity<Pose> pose) {
    const auto one = [&]<class Effect>(std::type_identity<Effect> effect) {
      if constexpr (requires { Effect::coordinate_unit; })
        if constexpr (!has_name_of<Effect>(std::type_identity<Others>{})) f(effect, pose);
    };
    (one(std::type_identity<Effects>{}), ...);
  };
  using Any = coordinate::Effects;
  using AnyOrPlanar = decltype(std::tuple_cat(Any{}, planar::Effects{}));
  in_space(std::type_identity<Any>{}, std::type_identity<std::tuple<>>{}, std::type_identity<planar::Pose<double>>{});
  in_space(std::type_identity<planar::Effects>{}, std::type_identity<Any>{},
           std::type_identity<planar::Pose<double>>{});
  in_space(std::type_identity<spatial::Effects>{}, std::type_identity<AnyOrPlanar>{},
           std::type_identity<spatial::Pose<double>>{});
}

// Its place among coordinate_effects().
std::size_t index_of(const std::string& name) {
  if (const JointType* const type = find_coordinate_effect(name))
    return static_cast<std::size_t>(type - coordinate_effects().data());
  throw Error(fmt::format("there is no effect `{}` for the coordinate of a joint", name));
}

void check_law(std::size_t index, double C, const std::vector<double>& numbers, double time) {
  const auto& [default_value, bounds, has_value, breaks] = functions_on_coordinates()[index];
  const JointType& type = coordinate_effects()[index];
  if (has_value && !has_value(C, numbers.data(), time)) throw effect_without_value(type, numbers);
  if (!bounds) return;
  RowBounds<double> B;
  bounds(C, numbers.data(), time, B);
  if (!(B.lower <= B.upper) || !std::isfinite(B.rate))
    throw Error(
        fmt::format("effect `{}` has bounds from {:.6g} to {:.6g}: the lower one must not lie above the upper "
                    "one{}",
                    type.name, B.lower, B.upper, scalars_of(type, numbers)));
}

// Writes the given parameters into `numbers`. Returns these.
std::vector<const ParameterInfo*> take_given(const JointType& type, const std::vector<NamedValue>& given,
                                             std::vector<double>& numbers) {
  for (std::size_t k = 0; k < type.parameters.size(); ++k)
    for (const NamedValue& value : given)
      if (value.name == type.parameters[k].name && type.coordinate_uses[k] == CoordinateUse::none)
        throw Error(
            fmt::format("parameter `{}` of effect `{}` has no meaning on the coordinate of a joint: leave it "
                        "out",
                        value.name, type.name));
  return change_parameters(type, given, numbers);
}

// All numbers of Parameters<double>; C is the value of the coordinate.
std::vector<double> complete(std::size_t index, const std::vector<NamedValue>& given, double C, double time) {
  const JointType& type = coordinate_effects()[index];
  std::vector<double> numbers(static_cast<std::size_t>(type.parameter_size), 0.0);
  const std::vector<const ParameterInfo*> taken = take_given(type, given, numbers);
  for (std::size_t k = 0; k < type.parameters.size(); ++k) {
    const ParameterInfo& info = type.parameters[k];
    const CoordinateUse use = type.coordinate_uses[k];
    if (use == CoordinateUse::none || std::ranges::find(taken, &info) != taken.end()) continue;
    if (use == CoordinateUse::required)
      throw Error(fmt::format("effect `{}` needs its parameter `{}` (it has no default on a coordinate)", type.name,
                              info.name));
    if (use == CoordinateUse::value) numbers[static_cast<std::size_t>(info.offset)] = C;
    else functions_on_coordinates()[index].default_value(static_cast<int>(k), numbers.data(), time);
  }
  check_law(index, C, numbers, time);
  return numbers;
}

void refuse_on_joint(const JointType& type) {
  if (type.acts_on_joint())
    throw Error(fmt::format("effect `{}` acts on a joint itself, not on its coordinate", type.name));
}

template <class S>
NamedLaw<S> law_of(std::size_t index) {
  refuse_on_joint(coordinate_effects()[index]);
  if (is_extended<typename S::Scalar> && index >= laws_on_coordinates<S>().size())
    throw Error(fmt::format("effect `{}` was not made for extended precision", coordinate_effects()[index].name));
  return {*laws_on_coordinates<S>()[index], coordinate_effects()[index].name.data()};
}

}  // namespace

#ifndef CDOT_EXTENDED
std::span<const JointType> coordinate_effects() { return registered_coordinate_effects(); }

std::vector<FunctionsOnCoordinate>& functions_on_coordinates() {
  static std::vector<FunctionsOnCoordinate> functions = [] {
    std::vector<FunctionsOnCoordinate> all;
    each_coordinate_effect([&]<class Effect, class Pose>(std::type_identity<Effect>, std::type_identity<Pose>) {
      all.push_back(functions_on_coordinate<Effect, Pose>());
    });
    return all;
  }();
  return functions;
}

std::vector<JointType>& registered_coordinate_effects() {
  static std::vector<JointType> types = [] {
    std::vector<JointType> all;
    each_coordinate_effect([&]<class Effect, class Pose>(std::type_identity<Effect>, std::type_identity<Pose>) {
      all.push_back(describe_joint<Effect>());
    });
    return all;
  }();
  return types;
}

const JointType* find_coordinate_effect(std::string_view name) {
  const auto types = coordinate_effects();
  const auto found = std::ranges::find(types, name, &JointType::name);
  return found == types.end() ? nullptr : &*found;
}

bool SpecEffect::acts_one_way() const {
  return coordinate_effects()[index_of(type)].without_energy || in_time(parameters);
}
#endif

template <class S>
std::vector<const Law<S>*>& laws_on_coordinates() {
  static std::vector<const Law<S>*> laws = [] {
    std::vector<const Law<S>*> all;
    each_coordinate_effect([&]<class Effect, class Pose>(std::type_identity<Effect>, std::type_identity<Pose>) {
      all.push_back(law_on_coordinate<S, Effect>());
    });
    return all;
  }();
  return laws;
}

template <class S>
int add_effect(BasicWorld<S>& world, int joint, std::string_view coordinate, const SpecEffect& effect) {
  WorldData<S>& data = world.data();
  check_joint(data, joint);
  const std::size_t index = index_of(effect.type);
  const JointType& type = coordinate_effects()[index];
  const JointType& of_joint = joint_types(S::dimension)[static_cast<std::size_t>(data.joints[joint].type)];
  const auto place = static_cast<std::size_t>(coordinate_index<S>(data.joints[joint].type, coordinate));
  const std::string_view unit = of_joint.coordinates[place].unit;
  refuse_on_joint(type);
  if (!type.acts_on(unit))
    throw Error(fmt::format("effect `{}` acts on a coordinate in {}; `{}` of joint `{}` is in {}", type.name,
                            type.coordinate_unit, coordinate, of_joint.name, unit));
  const std::vector<NamedValue> given = at_time(effect.parameters, data.time);
  const auto constants = complete(index, given, world.coordinate(joint, coordinate), data.time);
  const Law<S>* const law = &law_of<S>(index).law;
  check_functions(type, given);
  note_change(data);
  const int number = add_coordinate_row(data, joint, coordinate, law, constants, type.name);
  if (number >= 0) add_drives(data, joint, number, type, given);
  return number;
}

template <class S>
void add_effect(BasicWorld<S>& world, int joint, const SpecEffect& effect) {
  const double time = world.data().time;
  check_joint(world.data(), joint);
  const std::size_t index = index_of(effect.type);
  const JointType& type = coordinate_effects()[index];
  if (!type.acts_on_joint())
    throw Error(fmt::format("effect `{}` acts on a coordinate of a joint: name the coordinate", type.name));
  refuse_functions(effect.parameters, "an effect on a joint itself");
  add_bond(world, {joint, std::string(type.name), functions_on_coordinates()[index].breaks,
                   complete(index, effect.parameters, 0, time), type.explicit_time});
}

template <class S>
void set_effect(BasicWorld<S>& world, int joint, int number, const SpecEffect& effect) {
  WorldData<S>& data = world.data();
  const std::size_t index = index_of(effect.type);
  const NamedLaw<S> named = law_of<S>(index);
  const Batch<S>* const batch = batch_of_effect(world, joint, number, named);
  if (!batch) return;
  refuse_functions(effect.parameters, "set_effect()");
  refuse_driven(data.joints[joint], coordinate_effects()[index], number, effect.parameters);
  const int slot = slot_of(data, data.joints[joint].places[static_cast<std::size_t>(number)]);
  const auto* const now = batch->constants.data() + slot * named.law.constants;
  std::vector<double> numbers(now, now + named.law.constants);
  take_given(coordinate_effects()[index], effect.parameters, numbers);
  check_law(index, double(batch->C[slot]), numbers, data.time);
  set_constants(world, joint, number, named, numbers);
}

#define CDOT_INSTANTIATE(S)                                                          \
  template std::vector<const Law<S>*>& laws_on_coordinates<S>();                     \
  template int add_effect(BasicWorld<S>&, int, std::string_view, const SpecEffect&); \
  template void add_effect(BasicWorld<S>&, int, const SpecEffect&);                  \
  template void set_effect(BasicWorld<S>&, int, int, const SpecEffect&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
