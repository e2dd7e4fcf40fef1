// A row block behind tapes, with the members of the kernel contract: BlockLoops runs it as it runs generated structs.
#pragma once

#include <algorithm>
#include <cmath>
#include <string_view>
#include <tuple>
#include <vector>

#include <cdot/detail/turns.hpp>
#include <cdot/kernel.hpp>

#include "derive/own/own_kernel.hpp"

namespace cdot {

// The arguments of a function by OwnFunction::Argument; those that it does not read may be null.
template <class T>
struct OwnArguments {
  const T *pose = nullptr, *velocity = nullptr, *mass = nullptr, *parameters = nullptr, *jacobian = nullptr,
          *time = nullptr, *matrix = nullptr, *numbers = nullptr, *C = nullptr, *rate = nullptr,
          *effective_mass = nullptr, *load = nullptr;
};

template <class T>
void run_own(const OwnFunction& function, const OwnArguments<T>& in, T* to, T* second = nullptr) {
  thread_local std::vector<T> registers;  // grows to the largest tape of the thread
  registers.resize(std::max(registers.size(), static_cast<std::size_t>(function.tape.registers)));
  T* const r = registers.data();
  const T* const arguments[] = {in.pose,   in.velocity, in.mass, in.parameters, in.jacobian,       in.time,
                                in.matrix, in.numbers,  in.C,    in.rate,       in.effective_mass, in.load};
  place_constants(function.tape, r);
  for (std::size_t i = 0; i < function.inputs.size(); ++i) {
    const auto& [of, index] = function.inputs[i];
    r[function.tape.input_at[i]] = arguments[static_cast<int>(of)][index];
  }
  run_tape(function.tape, r);
  for (std::size_t i = 0; i < function.outputs.size(); ++i) {
    const auto& [of_second, index] = function.outputs[i];
    (of_second ? second : to)[index] = r[function.tape.output_at[i]];
  }
}

// The most numbers of a joint made by a program: in Parameters, and in the Jacobian of a block.
inline constexpr int most_own_parameters = 128, most_own_entries = 512;

// The joint of OwnRows: its parameters. Its coordinates are found by JointEntry alone.
template <int bodies_>
struct OwnJoint {
  static constexpr int bodies = bodies_;
  static constexpr std::array<ParameterInfo, 0> parameters = {};
  using Coordinates = std::tuple<>;
  template <class T>
  struct Parameters {
    T number[most_own_parameters];
  };
};

template <int bodies_, int rows_, bool is_angle>
class OwnRows {
 public:
  static constexpr int bodies = bodies_, rows = rows_;
  static constexpr bool explicit_time = true;  // BlockOps::explicit_time says whether it is
  static constexpr std::string_view unit = is_angle ? "rad" : "";
  template <class T>
  struct Jacobian {
    T number[most_own_entries];
  };

  explicit OwnRows(const void* block) : block_(static_cast<const OwnBlock*>(block)) {}
  const std::vector<OwnTurns>& turns() const { return block_->turns; }

  template <class Pose, class P, class T>
  void position(const Pose (&q)[bodies], const P& p, T time, T (&C)[rows]) const {
    run<T>(OwnFunctionName::position, {.pose = first<T>(q), .parameters = p.number, .time = &time}, C);
  }
  template <class Pose, class P, class T>
  void jacobian(const Pose (&q)[bodies], const P& p, T time, T (&C)[rows], Jacobian<T>& J) const {
    const OwnArguments<T> in = {.pose = first<T>(q), .parameters = p.number, .time = &time};
    run_own<T>((*block_)[OwnFunctionName::jacobian], in, C, J.number);
  }
  template <class Mass, class T, int triangle>
  void effective_mass(const Jacobian<T>& J, const Mass (&m)[bodies], T (&K)[triangle]) const {
    run<T>(OwnFunctionName::effective_mass, {.mass = first<T>(m), .jacobian = J.number}, K);
  }
  template <class T, int triangle>
  void factor(const T (&K)[triangle], T (&F)[triangle]) const {
    run<T>(OwnFunctionName::factor, {.matrix = K}, F);
  }
  template <class T, int triangle>
  void solve(const T (&F)[triangle], const T (&rhs)[rows], T (&lambda)[rows]) const {
    run<T>(OwnFunctionName::solve, {.matrix = F, .numbers = rhs}, lambda);
  }
  template <class Velocity, class T>
  void velocity(const Jacobian<T>& J, const Velocity (&v)[bodies], T (&Jv)[rows]) const {
    run<T>(OwnFunctionName::velocity, {.velocity = first<T>(v), .jacobian = J.number}, Jv);
  }
  template <class Mass, class Velocity, class T>
  void apply(const Jacobian<T>& J, const Mass (&m)[bodies], const T (&lambda)[rows], Velocity (&v)[bodies]) const {
    const OwnArguments<T> in = {.velocity = first<T>(v), .mass = first<T>(m), .jacobian = J.number, .numbers = lambda};
    run<T>(OwnFunctionName::apply, in, reinterpret_cast<T*>(v));
  }
  template <class T, int columns>
  void dense(const Jacobian<T>& J, T (&D)[rows][columns]) const {
    std::fill_n(*D, rows * columns, T(0));
    run<T>(OwnFunctionName::dense, {.jacobian = J.number}, *D);
  }
  template <class Mass, class T, int columns>
  void inverse_mass_jacobian(const Jacobian<T>& J, const Mass (&m)[bodies], T (&D)[rows][columns]) const {
    std::fill_n(*D, rows * columns, T(0));
    run<T>(OwnFunctionName::inverse_mass_jacobian, {.mass = first<T>(m), .jacobian = J.number}, *D);
  }
  template <class Pose, class Velocity, class P, class T>
  void gamma(const Pose (&q)[bodies], const Velocity (&v)[bodies], const P& p, T time, T (&g)[rows]) const {
    const OwnArguments<T> in = {.pose = first<T>(q), .velocity = first<T>(v), .parameters = p.number, .time = &time};
    run<T>(OwnFunctionName::gamma, in, g);
  }
  template <class Pose, class P, class T>
  void time_derivative(const Pose (&q)[bodies], const P& p, T time, T (&C_t)[rows]) const {
    run<T>(OwnFunctionName::time_derivative, {.pose = first<T>(q), .parameters = p.number, .time = &time}, C_t);
  }
  template <class Pose, class P, class T, int columns>
  void stiffness(const Pose (&q)[bodies], const P& p, T time, const T (&lambda)[rows], T (&H)[columns][columns]) const {
    std::fill_n(*H, columns * columns, T(0));
    const OwnArguments<T> in = {.pose = first<T>(q), .parameters = p.number, .time = &time, .numbers = lambda};
    run<T>(OwnFunctionName::stiffness, in, *H);
  }

 private:
  // Structs of the contract consist of numbers of type T only.
  template <class T, class Struct>
  static const T* first(const Struct (&of)[bodies]) {
    return reinterpret_cast<const T*>(of);
  }
  template <class T>
  void run(OwnFunctionName name, const OwnArguments<T>& in, T* to) const {
    run_own<T>((*block_)[name], in, to);
  }

  const OwnBlock* block_;
};

// BlockOps::counters has their number.
template <class S, int bodies, int rows, bool is_angle_>
struct TurnCounters<S, OwnJoint<bodies>, OwnRows<bodies, rows, is_angle_>> {
  using T = typename S::Scalar;
  using Block = OwnRows<bodies, rows, is_angle_>;
  using Poses = const typename S::Pose[bodies];

  static constexpr bool is_angle() { return is_angle_; }
  static constexpr int count = is_angle_ ? 1 : 0;
  static constexpr bool counts_parameters = S::dimension == Dimension::spatial;

  static void count_parameters(const Block& block, Poses& q, T* parameters, T time, T* counters) {
    for (const OwnTurns& of : block.turns()) {
      T& counter = *counters++;
      const T angle = angle_of(of, q, parameters, time), turns = whole_turns(angle, counter);
      if (!std::isfinite(turns)) continue;
      parameters[of.parameter] = turns;
      counter = angle + turns;
    }
  }
  static void count_angle(const Block& block, T& C, T* counters) { add_turns(C, counters[block.turns().size()]); }
  static void start(const Block& block, Poses& q, const T* parameters, T time, T* counters) {
    for (const OwnTurns& of : block.turns()) *counters++ = angle_of(of, q, parameters, time) + parameters[of.parameter];
    if constexpr (is_angle_) *counters = T(0);
  }

 private:
  static T angle_of(const OwnTurns& of, Poses& q, const T* parameters, T time) {
    T angle;
    run_own<T>(of.angle, {.pose = reinterpret_cast<const T*>(q), .parameters = parameters, .time = &time}, &angle);
    return angle;
  }
};

}  // namespace cdot
