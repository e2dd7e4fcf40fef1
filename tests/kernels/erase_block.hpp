// Generated structs -> AnyBlock: only this file uses the joints' types.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <utility>

#include <cdot/pack.hpp>
#include <cdot/planar/registry.hpp>
#include <cdot/spatial/registry.hpp>

#include "tests/kernels/any_block.hpp"
#include "tests/kernels/packs.hpp"

namespace cdot {

template <class T>
struct Lanes {
  static constexpr std::size_t count = 1;
  static void set(T& x, std::size_t, double value) { x = T(value); }
  static double get(const T& x, std::size_t) { return static_cast<double>(x); }
};
template <class T, int width>
struct Lanes<Pack<T, width>> {
  static constexpr std::size_t count = width;
  static void set(Pack<T, width>& x, std::size_t lane, double value) {
    x.set(static_cast<int>(lane), static_cast<T>(value));
  }
  static double get(const Pack<T, width>& x, std::size_t lane) { return x[static_cast<int>(lane)]; }
};

template <>
struct Lanes<packs::Packs> {
  static constexpr std::size_t count = packs::lanes;
  static void set(packs::Packs& x, std::size_t lane, double value) {
    packs::at_lane(x, lane,
                   [&]<class P>(P& pack, int i) { pack.set(i, static_cast<typename ScalarOf<P>::type>(value)); });
  }
  static double get(packs::Packs x, std::size_t lane) {
    return packs::at_lane(x, lane, [](const auto& pack, int i) { return static_cast<double>(pack[i]); });
  }
};

// The number of values of type T in a struct or an array of structs.
template <class T, class Struct, std::size_t bytes = sizeof(Struct)>
inline constexpr std::size_t numbers_in = bytes / sizeof(T);

// The loops are instantiated once for each scalar type: for each struct they would take a tenth of the compile time.
template <class T>
void load_numbers(std::byte* target, std::size_t count, std::span<const Inputs> lanes,
                  std::vector<double> Inputs::*member) {
  for (std::size_t i = 0; i < count; ++i) {
    T x;
    for (std::size_t lane = 0; lane < Lanes<T>::count; ++lane) Lanes<T>::set(x, lane, (lanes[lane].*member)[i]);
    std::memcpy(target + i * sizeof x, &x, sizeof x);
  }
}
template <class T, class Target>
void load(Target& target, std::span<const Inputs> lanes, std::vector<double> Inputs::*member) {
  if constexpr (!std::is_empty_v<Target>)
    load_numbers<T>(reinterpret_cast<std::byte*>(&target), numbers_in<T, Target>, lanes, member);
}

// Appends the result of `function` and, if T counts, its cost.
template <class T>
void keep_numbers(std::vector<Outputs>& outputs, Function function, const std::byte* source, std::size_t count) {
  if constexpr (requires { T::taken; }) outputs[0].cost[function] += std::exchange(T::taken, {});
  for (std::size_t lane = 0; lane < Lanes<T>::count; ++lane) {
    for (std::size_t i = 0; i < count; ++i) {
      T x;
      std::memcpy(&x, source + i * sizeof x, sizeof x);
      outputs[lane].of[function].push_back(Lanes<T>::get(x, lane));
    }
  }
}
template <class T, class Source>
void keep(std::vector<Outputs>& outputs, Function function, const Source& source) {
  constexpr std::size_t count = std::is_empty_v<Source> ? 0 : numbers_in<T, Source>;
  keep_numbers<T>(outputs, function, reinterpret_cast<const std::byte*>(&source), count);
}

template <class Scalar>
struct Plane {
  static constexpr int dimension = 2, width = 3;
  using Pose = planar::Pose<Scalar>;
  using Velocity = planar::Velocity<Scalar>;
  using InverseMass = planar::InverseMass<Scalar>;
  using Joints = planar::Joints;
  using Effects = planar::Effects;
};
template <class Scalar>
struct Space {
  static constexpr int dimension = 3, width = 6;
  using Pose = spatial::Pose<Scalar>;
  using Velocity = spatial::Velocity<Scalar>;
  using InverseMass = spatial::InverseMass<Scalar>;
  using Joints = spatial::Joints;
  using Effects = spatial::Effects;
};

// The functions for isotropic bodies, only in space.
template <class Block, class T, class Jacobian, class Velocity>
void evaluate_isotropic(std::span<const Inputs> lanes, const Jacobian& J, const T (&lambda)[Block::rows], Velocity& v,
                        std::vector<Outputs>& out) {
  constexpr int n = Block::bodies, rows = Block::rows;
  spatial::IsotropicInverseMass<T> m[n];
  load<T>(m, lanes, &Inputs::m_isotropic);
  T K[rows * (rows + 1) / 2], D[rows][6 * n];
  Block::effective_mass(J, m, K), keep<T>(out, effective_mass_isotropic, K);
  Block::inverse_mass_jacobian(J, m, D), keep<T>(out, inverse_mass_jacobian_isotropic, D);
  Block::apply(J, m, lambda, v), keep<T>(out, apply_isotropic, v);
}

// J by the other forms of velocity in space, from J of `General`, the block without immovable bodies.
template <class General, class Block, class T, class Pose, class Parameters>
void evaluate_forms(const Pose& q, const Parameters& p, T time, std::vector<Outputs>& out) {
  constexpr int n = Block::bodies, rows = Block::rows;
  typename General::template Jacobian<T> J;
  T C[rows], local[rows][6 * n], by_parameters[rows][7 * n];
  General::jacobian(q, p, time, C, J);
  if constexpr (requires { T::taken; }) T::taken = {};
  Block::local_jacobian(q, J, local), keep<T>(out, local_jacobian, local);
  Block::euler_jacobian(q, J, by_parameters), keep<T>(out, euler_jacobian, by_parameters);
}

// The law of an effect as a function of C, rates, parameters and time.
template <class Block, class T, class Parameters>
void evaluate_law(const T (&C)[Block::rows], const T (&rate)[Block::rows], const Parameters& p, T time,
                  std::vector<Outputs>& out) {
  T E[1], F[Block::rows];
  struct {
    T k[Block::rows][Block::rows], d[Block::rows][Block::rows];
  } slopes;
  if constexpr (requires { Block::energy(C, p, E[0]); }) Block::energy(C, p, E[0]), keep<T>(out, law_energy, E);
  Block::force(C, rate, p, time, F), keep<T>(out, law_force, F);
  if constexpr (requires { Block::unstored(C, rate, p, time, F); })
    Block::unstored(C, rate, p, time, F), keep<T>(out, law_unstored, F);
  Block::slopes(C, rate, p, time, slopes.k, slopes.d), keep<T>(out, law_slopes, slopes);
  struct {
    T lower[Block::rows], upper[Block::rows];
  } limits;
  if constexpr (requires { Block::limits(C, p, time, limits.lower, limits.upper); })
    Block::limits(C, p, time, limits.lower, limits.upper), keep<T>(out, law_limits, limits);
}

// A row block with a law: not the coordinates of an effect.
template <class Block>
constexpr bool is_effect = requires {
  Block::is_effect;
};

template <template <class> class In, class Joint, class General, class Block, class T>
std::vector<Outputs> evaluate(std::span<const Inputs> lanes) {
  constexpr int n = Block::bodies, rows = Block::rows, triangle = rows * (rows + 1) / 2;
  constexpr int columns = In<T>::width * n;
  typename In<T>::Pose q[n];
  typename In<T>::Velocity v[n];
  typename In<T>::InverseMass m[n];
  typename Joint::template Parameters<T> p;
  typename Block::template Jacobian<T> J;
  T time[1], lambda[rows], rhs[rows];
  load<T>(q, lanes, &Inputs::q);
  load<T>(v, lanes, &Inputs::v);
  load<T>(m, lanes, &Inputs::m);
  load<T>(p, lanes, &Inputs::p);
  load<T>(time, lanes, &Inputs::time);
  load<T>(lambda, lanes, &Inputs::lambda);
  load<T>(rhs, lanes, &Inputs::rhs);

  std::vector<Outputs> out(Lanes<T>::count);
  T C[rows], K[triangle], F[triangle], x[rows], Jv[rows], g[rows];
  T D[rows][columns], H[columns][columns];
  Block::position(q, p, time[0], C), keep<T>(out, position, C);
  Block::jacobian(q, p, time[0], C, J), keep<T>(out, jacobian, C), keep<T>(out, jacobian, J);
  Block::effective_mass(J, m, K), keep<T>(out, effective_mass, K);
  Block::factor(K, F), keep<T>(out, factor, F);
  Block::solve(F, rhs, x), keep<T>(out, solve, x);
  Block::velocity(J, v, Jv), keep<T>(out, velocity, Jv);
  Block::dense(J, D), keep<T>(out, dense, D);
  Block::inverse_mass_jacobian(J, m, D), keep<T>(out, inverse_mass_jacobian, D);
  Block::gamma(q, v, p, time[0], g), keep<T>(out, gamma, g);
  Block::time_derivative(q, p, time[0], g), keep<T>(out, time_derivative, g);
  Block::stiffness(q, p, time[0], lambda, H), keep<T>(out, stiffness, H);
  if constexpr (is_effect<Block>) evaluate_law<Block>(C, rhs, p, time[0], out);
  if constexpr (In<T>::dimension == 3) {
    typename In<T>::Velocity pushed[n];
    std::copy(v, v + n, pushed);
    evaluate_isotropic<Block>(lanes, J, lambda, pushed, out);
    evaluate_forms<General, Block>(q, p, time[0], out);
  }
  Block::apply(J, m, lambda, v), keep<T>(out, apply, v);
  return out;
}

template <class Block>
std::vector<double> factor_and_solve(const std::vector<double>& K, const std::vector<double>& rhs) {
  constexpr int rows = Block::rows, triangle = rows * (rows + 1) / 2;
  double k[triangle], F[triangle], b[rows], x[rows];
  std::copy(K.begin(), K.end(), k);
  std::copy(rhs.begin(), rhs.end(), b);
  Block::factor(k, F);
  Block::solve(F, b, x);
  return {x, x + rows};
}

template <template <class> class In, class Joint>
void set_defaults(Inputs& in) {
  typename In<double>::Pose q[Joint::bodies];
  typename Joint::template Parameters<double> p;
  load<double>(q, std::span(&in, 1), &Inputs::q);
  load<double>(p, std::span(&in, 1), &Inputs::p);
  for (std::size_t i = 0; i < Joint::parameters.size(); ++i) {
    if (Joint::parameters[i].has_default) {
      Joint::default_value(static_cast<int>(i), q, p, in.time[0]);
    }
  }
  std::memcpy(in.p.data(), &p, in.p.size() * sizeof(double));
}

template <template <class> class In, class Joint, class General, class Block, class T>
AnyBlock erased(std::string name, std::size_t general, bool is_coordinate) {
  int immovable = -1;
  if constexpr (requires { Block::immovable_body; }) immovable = Block::immovable_body;
  return {In<T>::dimension,
          std::string(Joint::name),
          std::move(name),
          Block::bodies,
          Block::rows,
          immovable,
          general,
          is_coordinate,
          is_effect<Block>,
          Block::explicit_time,
          Block::row_names,
          Block::row_kinds,
          Joint::parameters,
          evaluate<In, Joint, General, Block, T>,
          factor_and_solve<Block>,
          set_defaults<In, Joint>};
}

// A block and its variants; `prefix` is "" for the rows, "slide." for a coordinate.
template <template <class> class In, class Joint, class Block, class T>
void add_with_variants(std::vector<AnyBlock>& all, const std::string& name, const std::string& prefix) {
  const std::size_t general = all.size();
  all.push_back(erased<In, Joint, Block, Block, T>(name, general, !prefix.empty()));
  const auto add = [&]<class Variant>(std::type_identity<Variant>) {
    const std::string body(Joint::body_names[Variant::immovable_body]);
    all.push_back(erased<In, Joint, Block, Variant, T>(prefix + body + "_immovable", general, !prefix.empty()));
  };
  [&]<class... Variants>(std::type_identity<std::tuple<Variants...>>) {
    (add(std::type_identity<Variants>{}), ...);
  }(std::type_identity<typename Block::Immovable>{});
}

template <template <class> class In, class Joint, class T>
void add_joint(std::vector<AnyBlock>& all) {
  if constexpr (Joint::rows > 0) add_with_variants<In, Joint, Joint, T>(all, "rows", "");
  const auto add = [&]<class Coordinate>(std::type_identity<Coordinate>) {
    const std::string name(Coordinate::name);
    add_with_variants<In, Joint, Coordinate, T>(all, name, name + ".");
  };
  [&]<class... Coordinates>(std::type_identity<std::tuple<Coordinates...>>) {
    (add(std::type_identity<Coordinates>{}), ...);
  }(std::type_identity<typename Joint::Coordinates>{});
}

template <template <class> class In, class T>
void add_joints(std::vector<AnyBlock>& all) {
  const auto add = [&]<class... Joints>(std::type_identity<std::tuple<Joints...>>) {
    (add_joint<In, Joints, T>(all), ...);
  };
  add(std::type_identity<typename In<T>::Joints>{});
  add(std::type_identity<typename In<T>::Effects>{});
}

template <class T>
const std::vector<AnyBlock>& blocks() {
  static const std::vector<AnyBlock> all = [] {
    std::vector<AnyBlock> list;
    add_joints<Plane, T>(list);
    add_joints<Space, T>(list);
    return list;
  }();
  return all;
}

}  // namespace cdot
