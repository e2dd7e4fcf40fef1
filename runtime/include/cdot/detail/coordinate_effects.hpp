// Effects of specs that act on the coordinate of any joint: their laws and functions, in the order of
// coordinate_effects(). A program's own come after those of the catalogue (cdot/detail/add_joints.hpp).
#pragma once

#include <cmath>
#include <functional>
#include <tuple>
#include <vector>

#include <cdot/detail/bounded_law.hpp>
#include <cdot/detail/describe_joint.hpp>
#include <cdot/detail/linear_law.hpp>

namespace cdot {

// The functions of an effect in doubles, without poses.
struct FunctionsOnCoordinate {
  std::function<void(int index, double* parameters, double time)> default_value;
  std::function<void(double C, const double* parameters, double time, RowBounds<double>&)> bounds;  // empty: no bounds
  // True if force and energy are finite at rest; empty: it has bounds.
  std::function<bool(double C, const double* parameters, double time)> has_value;
  // Of an effect on a joint itself: the distance from breaking it, at most 0 where it breaks. `load` is the norm of its
  // row forces. Such an effect has no other of these but default_value.
  std::function<double(const double* parameters, double time, double load)> breaks;
};

template <class Effect>
double distance_from_breaking(const double* parameters, double time, double load) {
  double distance;
  Effect::breaks(*reinterpret_cast<const typename Effect::template Parameters<double>*>(parameters), time, load,
                 distance);
  return distance;
}

std::vector<JointType>& registered_coordinate_effects();
std::vector<FunctionsOnCoordinate>& functions_on_coordinates();
template <class S>
std::vector<const Law<S>*>& laws_on_coordinates();

template <class Effect>
using BoundedOnCoordinate = std::tuple_element_t<0, typename Effect::Bounded>;

template <class S, class Effect>
constexpr const Law<S>* law_on_coordinate() {
  if constexpr (requires { Effect::on_joint; }) return nullptr;
  else if constexpr (requires { typename Effect::Bounded; })
    return &bounded_law<S, Effect, BoundedOnCoordinate<Effect>, ParametersAt::row>;
  else if constexpr (requires { requires Effect::linear; }) return &linear_law<S, Effect>;
  else return &effect_law<S, Effect, ParametersAt::row>;
}

// Pose is that of the effect's space in doubles; of effects without bodies any.
template <class Effect, class Pose>
FunctionsOnCoordinate functions_on_coordinate() {
  using Numbers = typename Effect::template Parameters<double>;
  FunctionsOnCoordinate functions{[](int index, double* parameters, double time) {
                                    auto& numbers = *reinterpret_cast<Numbers*>(parameters);
                                    if constexpr (Effect::bodies == 0) {
                                      Effect::default_value(index, numbers, time);
                                    } else {
                                      const Pose nowhere[Effect::bodies] = {};
                                      Effect::default_value(index, nowhere, numbers, time);
                                    }
                                  },
                                  {},
                                  {},
                                  {}};
  if constexpr (requires { Effect::on_joint; }) functions.breaks = distance_from_breaking<Effect>;
  else if constexpr (requires { typename Effect::Bounded; })
    functions.bounds = [](double C, const double* parameters, double time, RowBounds<double>& B) {
      const double value[1] = {C};
      BoundedOnCoordinate<Effect>::bounds(value, *reinterpret_cast<const Numbers*>(parameters), time, B);
    };
  else
    functions.has_value = [](double C, const double* parameters, double time) {
      const double value[1] = {C}, rate[1] = {0};
      const Numbers& p = *reinterpret_cast<const Numbers*>(parameters);
      double force[1], energy = 0;
      const auto find = [&](const auto&... mass) {
        Effect::force(value, rate, p, time, mass..., force);
        if constexpr (requires { &Effect::template energy<double>; }) Effect::energy(value, p, mass..., energy);
      };
      if constexpr (requires { requires Effect::reads_mass; }) find(1.0);
      else find();
      return std::isfinite(force[0]) && std::isfinite(energy);
    };
  return functions;
}

}  // namespace cdot
