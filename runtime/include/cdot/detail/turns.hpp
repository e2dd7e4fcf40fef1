// Angles beyond half a turn. In space a kernel gives an angle within (-pi, pi]. These counters add the whole turns from
// one evaluation to the next, for
//   - a coordinate in radians under an effect: its C grows beyond pi;
//   - a joint whose rows need it: the parameter `<coordinate>_turns` [rad] is kept such that the
//     coordinate and it together never jump (a gear between two hinges).
#pragma once

#include <cmath>
#include <string_view>
#include <tuple>
#include <type_traits>

#include <cdot/joints.hpp>
#include <cdot/kernel.hpp>

namespace cdot {

// The whole turns that bring `angle` nearest to `last`, in radians.
template <class T>
T whole_turns(T angle, T last) {
  constexpr T turn = T(6.283185307179586476925L);
  return turn * std::round((last - angle) / turn);
}

// An angle, and what its counter held of it last.
template <class T>
void add_turns(T& angle, T& counter) {
  angle += whole_turns(angle, counter);
  if (std::isfinite(angle)) counter = angle;
}

// The offset of the parameter that counts the turns of a coordinate; -1: none.
template <class Joint>
constexpr int turns_parameter(std::string_view coordinate) {
  for (const ParameterInfo& info : Joint::parameters) {
    const std::string_view name = info.name;
    if (info.unit == "rad" && name.ends_with("_turns") && name.substr(0, name.size() - 6) == coordinate)
      return info.offset;
  }
  return -1;
}

// An angle that is not finite, as in a stage that diverges, counts no turns.
//
// Counters of one slot of a row block: first those of the joint's parameters in the order of its coordinates, then, if
// the block is a coordinate in radians, its own. A block made by a program (kernel.hpp) has a specialisation.
template <class S, class Joint, class Block>
struct TurnCounters {
  using T = typename S::Scalar;
  using Poses = const typename S::Pose[Joint::bodies];
  using Parameters = typename Joint::template Parameters<T>;

  static constexpr bool is_angle() {
    if constexpr (S::dimension == Dimension::spatial && requires { Block::unit; }) return Block::unit == "rad";
    return false;
  }
  static constexpr int of_parameters() {
    int count = 0;
    if constexpr (S::dimension == Dimension::spatial)
      [&]<class... C>(std::type_identity<std::tuple<C...>>) {
        ((count += turns_parameter<Joint>(C::name) >= 0), ...);
      }(std::type_identity<typename Joint::Coordinates>{});
    return count;
  }
  static constexpr int count = of_parameters() + (is_angle() ? 1 : 0);
  static constexpr bool counts_parameters = of_parameters() > 0;

  // Called before the rows are evaluated.
  static void count_parameters(const Block&, Poses& q, T* parameters, T time, T* counters) {
    each_parameter(
        [&]<class C>(std::type_identity<C>, T* counter) {
          T angle[1];
          C::position(q, *reinterpret_cast<const Parameters*>(parameters), time, angle);
          const T turns = whole_turns(angle[0], *counter);
          if (!std::isfinite(turns)) return;
          parameters[turns_parameter<Joint>(C::name)] = turns;
          *counter = angle[0] + turns;
        },
        counters);
  }
  // Called after the rows are evaluated.
  static void count_angle(const Block&, T& C, T* counters) { add_turns(C, counters[of_parameters()]); }
  // Start values: the turns that the scene gives a parameter, and an angle within half a turn.
  static void start(const Block&, Poses& q, const T* parameters, T time, T* counters) {
    each_parameter(
        [&]<class C>(std::type_identity<C>, T* counter) {
          T angle[1];
          C::position(q, *reinterpret_cast<const Parameters*>(parameters), time, angle);
          *counter = angle[0] + parameters[turns_parameter<Joint>(C::name)];
        },
        counters);
    if constexpr (is_angle()) counters[of_parameters()] = T(0);
  }

 private:
  template <class F>
  static void each_parameter(F f, T* counters) {
    [&]<class... C>(std::type_identity<std::tuple<C...>>) {
      const auto one = [&]<class Coordinate>(std::type_identity<Coordinate> coordinate) {
        if constexpr (turns_parameter<Joint>(Coordinate::name) >= 0) f(coordinate, counters++);
      };
      (one(std::type_identity<C>{}), ...);
    }(std::type_identity<typename Joint::Coordinates>{});
  }
};

}  // namespace cdot
