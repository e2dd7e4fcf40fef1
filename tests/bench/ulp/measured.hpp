// A generated kernel's functions behind one interface: numbers in, numbers out, in any scalar. Only this file uses the
// joints' types; it is compiled for each group of joints and each scalar.
#pragma once

#include <array>
#include <tuple>
#include <type_traits>
#include <vector>

#include <cdot/detail/kernel_forms.hpp>

#include "tests/bench/ulp/function.hpp"
#include "tests/kernels/any_block.hpp"

namespace cdot::ulp {

template <class T>
struct MeasuredFunction {
  Measured which;
  std::size_t outputs;
  // Evaluates `count` inputs; the outputs follow one another.
  void (*many)(const Arguments<T>* in, std::size_t count, T* out);
};

template <class T>
struct MeasuredBlock {
  AnyBlock shape;  // without functions; shape.general: the block with the exact values
  std::size_t fields;
  std::vector<MeasuredFunction<T>> functions;
  void (*set_defaults)(Inputs& in);  // overwrites the parameters that have a default
  int operations = 0;                // of a form outside generated/ and the ledger
};

template <class Scalar>
struct Plane {
  using T = Scalar;
  static constexpr int dimension = 2, width = 3;
  using Pose = planar::Pose<T>;
  using Velocity = planar::Velocity<T>;
  using InverseMass = planar::InverseMass<T>;
};
template <class Scalar>
struct Space {
  using T = Scalar;
  static constexpr int dimension = 3, width = 6;
  using Pose = spatial::Pose<T>;
  using Velocity = spatial::Velocity<T>;
  using InverseMass = spatial::InverseMass<T>;
  using IsotropicInverseMass = spatial::IsotropicInverseMass<T>;
};

// Generated structs consist of numbers of type T only; this reads them from arrays of T.
template <class Target, class Number>
auto& as(Number* numbers) {
  using Result = std::conditional_t<std::is_const_v<Number>, const Target, Target>;
  if constexpr (std::is_empty_v<Target>) {
    static Target nothing;
    return static_cast<Result&>(nothing);
  } else {
    return *reinterpret_cast<Result*>(numbers);
  }
}

template <class S, class Joint, class Block>
struct Calls {
  using T = typename S::T;
  static constexpr int bodies = Block::bodies, rows = Block::rows;
  static constexpr int triangle = rows * (rows + 1) / 2, columns = S::width * bodies;
  using Parameters = typename Joint::template Parameters<T>;
  using Jacobian = typename Block::template Jacobian<T>;
  static constexpr std::size_t fields = std::is_empty_v<Jacobian> ? 0 : sizeof(Jacobian) / sizeof(T);

  struct Inputs {
    const Arguments<T>& in;
    const auto& q() const { return as<typename S::Pose[bodies]>(in[poses].data()); }
    const auto& v() const { return as<typename S::Velocity[bodies]>(in[velocities].data()); }
    const auto& m() const { return as<typename S::InverseMass[bodies]>(in[masses].data()); }
    const auto& balls() const { return as<typename S::IsotropicInverseMass[bodies]>(in[isotropic_masses].data()); }
    const auto& p() const { return as<Parameters>(in[parameters].data()); }
    const T& time() const { return in[instant][0]; }
    const auto& lambda() const { return as<T[rows]>(in[impulses].data()); }
    const auto& rhs() const { return as<T[rows]>(in[right_side].data()); }
    const auto& J() const { return as<Jacobian>(in[fields_of_J].data()); }
    const auto& K() const { return as<T[triangle]>(in[mass_matrix].data()); }
    const auto& F() const { return as<T[triangle]>(in[factors].data()); }
  };

  static constexpr std::size_t outputs(Measured which) {
    switch (which) {
      case Measured::jacobian: return fields;
      case Measured::effective_mass:
      case Measured::effective_mass_isotropic:
      case Measured::factor: return triangle;
      case Measured::apply:
      case Measured::apply_isotropic: return columns;
      case Measured::dense:
      case Measured::inverse_mass_jacobian:
      case Measured::inverse_mass_jacobian_isotropic:
      case Measured::local_jacobian: return rows * columns;
      case Measured::euler_jacobian: return rows * 7 * bodies;
      case Measured::stiffness: return columns * columns;
      default: return rows;
    }
  }

  template <Measured which>
  static void one(const Inputs& in, T* out) {
    using enum Measured;
    auto& of_rows = as<T[rows]>(out);
    auto& of_triangle = as<T[triangle]>(out);
    auto& matrix = as<T[rows][columns]>(out);
    if constexpr (which == position) {
      Block::position(in.q(), in.p(), in.time(), of_rows);
    } else if constexpr (which == jacobian) {
      T C[rows];
      Block::jacobian(in.q(), in.p(), in.time(), C, as<Jacobian>(out));
    } else if constexpr (which == effective_mass) {
      Block::effective_mass(in.J(), in.m(), of_triangle);
    } else if constexpr (which == effective_mass_isotropic) {
      Block::effective_mass(in.J(), in.balls(), of_triangle);
    } else if constexpr (which == factor) {
      Block::factor(in.K(), of_triangle);
    } else if constexpr (which == solve) {
      Block::solve(in.F(), in.rhs(), of_rows);
    } else if constexpr (which == factor_and_solve) {
      T F[triangle];
      Block::factor(in.K(), F);
      Block::solve(F, in.rhs(), of_rows);
    } else if constexpr (which == velocity) {
      Block::velocity(in.J(), in.v(), of_rows);
    } else if constexpr (which == dense) {
      Block::dense(in.J(), matrix);
    } else if constexpr (which == inverse_mass_jacobian) {
      Block::inverse_mass_jacobian(in.J(), in.m(), matrix);
    } else if constexpr (which == inverse_mass_jacobian_isotropic) {
      Block::inverse_mass_jacobian(in.J(), in.balls(), matrix);
    } else if constexpr (which == gamma) {
      Block::gamma(in.q(), in.v(), in.p(), in.time(), of_rows);
    } else if constexpr (which == time_derivative) {
      Block::time_derivative(in.q(), in.p(), in.time(), of_rows);
    } else if constexpr (which == stiffness) {
      Block::stiffness(in.q(), in.p(), in.time(), in.lambda(), as<T[columns][columns]>(out));
    } else if constexpr (which == local_jacobian) {
      Block::local_jacobian(in.q(), in.J(), matrix);
    } else if constexpr (which == euler_jacobian) {
      Block::euler_jacobian(in.q(), in.J(), as<T[rows][7 * bodies]>(out));
    } else if constexpr (which == impulse_fast || which == impulse_balanced || which == impulse_robust) {
      impulse<which>(in, of_rows);
    } else {
      auto& v = as<typename S::Velocity[bodies]>(out);
      std::copy(in.v(), in.v() + bodies, v);
      if constexpr (which == apply) {
        Block::apply(in.J(), in.m(), in.lambda(), v);
      } else {
        Block::apply(in.J(), in.balls(), in.lambda(), v);
      }
    }
  }

  template <Measured which>
  static void impulse(const Inputs& in, T (&lambda)[rows]) {
    T K[triangle], F[triangle];
    if constexpr (which == Measured::impulse_robust) {
      factor_by_rows<columns>(Block{}, in.J(), in.m(), F);
      Block::solve(F, in.rhs(), lambda);
    } else {
      Block::effective_mass(in.J(), in.m(), K);
      if constexpr (which == Measured::impulse_fast) {
        invert(K, F);
        multiply(F, in.rhs(), lambda);
      } else {
        Block::factor(K, F);
        Block::solve(F, in.rhs(), lambda);
      }
    }
  }
  // One row has only one form; K^-1 exists for two rows.
  static constexpr bool has(Measured which) {
    if (which == Measured::impulse_fast) return rows == 2;
    if (which == Measured::impulse_balanced || which == Measured::impulse_robust) return rows > 1;
    return S::dimension == 3 || !only_in_space(which);
  }

  template <Measured which>
  static void many(const Arguments<T>* in, std::size_t count, T* out) {
    for (std::size_t i = 0; i < count; ++i) one<which>(Inputs{in[i]}, out + i * outputs(which));
  }

  template <std::size_t... index>
  static std::vector<MeasuredFunction<T>> functions(std::index_sequence<index...>) {
    std::vector<MeasuredFunction<T>> all;
    const auto add = [&]<Measured which>(std::integral_constant<Measured, which>) {
      if constexpr (has(which)) {
        if (outputs(which) > 0) all.push_back({which, outputs(which), many<which>});
      }
    };
    (add(std::integral_constant<Measured, static_cast<Measured>(index)>{}), ...);
    return all;
  }

  static void set_defaults(cdot::Inputs& in) {
    if constexpr (std::is_same_v<T, double>) {
      for (std::size_t i = 0; i < Joint::parameters.size(); ++i) {
        if (!Joint::parameters[i].has_default) continue;
        Joint::default_value(static_cast<int>(i), as<const typename S::Pose[bodies]>(in.q.data()),
                             as<Parameters>(in.p.data()), in.time[0]);
      }
    }
  }
};

template <class S, class Joint, class Block>
void add_block(std::vector<MeasuredBlock<typename S::T>>& all, std::string name) {
  using C = Calls<S, Joint, Block>;
  MeasuredBlock<typename S::T> block{};
  AnyBlock& shape = block.shape;
  shape.dimension = S::dimension;
  shape.joint = Joint::name;
  shape.is_coordinate = name != "rows";
  shape.block = std::move(name);
  shape.bodies = Block::bodies, shape.rows = Block::rows;
  shape.immovable = -1;
  shape.general = all.size();
  shape.row_names = Block::row_names, shape.row_kinds = Block::row_kinds;
  shape.parameters = Joint::parameters;
  block.fields = C::fields;
  block.functions = C::functions(std::make_index_sequence<measured_functions>{});
  block.set_defaults = C::set_defaults;
  all.push_back(std::move(block));
}

template <class S, class Joint>
void add_joint(std::vector<MeasuredBlock<typename S::T>>& all) {
  if constexpr (Joint::rows > 0) add_block<S, Joint, Joint>(all, "rows");
  [&]<class... Coordinates>(std::type_identity<std::tuple<Coordinates...>>) {
    (add_block<S, Joint, Coordinates>(all, std::string(Coordinates::name)), ...);
  }(std::type_identity<typename Joint::Coordinates>{});
}

// Every row block of the registry, computed in T.
template <class T>
const std::vector<MeasuredBlock<T>>& measured_blocks();

}  // namespace cdot::ulp
