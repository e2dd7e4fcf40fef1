// The contract between generated kernels and everything that runs them.
//
// A kernel is a struct of static function templates, one struct per joint (`cdot::planar::line`), written by
// `cdot derive`. A solver sees a *row block*: one or more rows of C(q, t) over one or more bodies. Three kinds of
// struct are row blocks with the same members. The first is a joint, the second one of its coordinates (`line::slide`,
// always one row). The third is a variant of these with one body immovable (`line::a_immovable`, without that body's
// terms in J, K and the impulse). A variant inherits gamma, dC/dt and the stiffness from the block with all bodies
// movable, because no inner loop of a solver calls them. In space it also inherits the two other forms of J, which take
// the Jacobian<T> of that block.
//
//   members of a row block B                                                                 shapes
//   B::bodies, B::rows                                             number of bodies, of rows
//   B::explicit_time                                               true if C depends on t explicitly
//   B::Jacobian<T>                                                 the nonzeros of J as named scalars of type T
//   B::position        (q, p, t, C)                                C                                    [rows]
//   B::jacobian        (q, p, t, C, J)                             C and J together
//   B::effective_mass  (J, m, K)                                   K = J M^-1 J^T, lower triangle, row by row
//   B::factor          (K, F)                                      K = L D L^T, guarded; F: D^-1 on the diagonal
//   B::solve           (F, rhs, lambda)                            lambda = K^-1 rhs                    [rows]
//   B::velocity        (J, v, Jv)                                  J v, without dC/dt                   [rows]
//   B::apply           (J, m, lambda, v)                           v += M^-1 J^T lambda
//   B::dense           (J, D)                                      J with its zeros, D[row][3 body + {x, y, w}]
//   B::inverse_mass_jacobian (J, m, D)                             (M^-1 J^T)^T, laid out like dense
//   B::gamma           (q, v, p, t, g)                             -Jdot v - d/dt(dC/dt)                [rows]
//   B::time_derivative (q, p, t, C_t)                              dC/dt at fixed q (zero unless explicit_time)
//   B::stiffness       (q, p, t, lambda, H)                        d(J^T lambda)/dq, H[3 bodies][3 bodies]
//
//   q: Pose<T>[bodies]   v: Velocity<T>[bodies]   m: InverseMass<T>[bodies]   p: Parameters<T>   t: time [s]
//
// In space (`cdot::spatial::revolute`) a body has six columns, x y z of v and of w in world axes: dense is D[rows][6
// bodies], stiffness H[6 bodies][6 bodies], its turns being small rotations about the world's axes. Besides:
//   B::effective_mass, B::apply, B::inverse_mass_jacobian          overloads for m: IsotropicInverseMass<T>[bodies]
//   B::local_jacobian  (q, J, D)                                   J by v and w' = A^T w (body axes), D[rows][6 bodies]
//   B::euler_jacobian  (q, J, D)                                   J by v, rates of e0 e1 e2 e3, D[rows][7 bodies]
//
// Further members of the three kinds of row block (strings are std::string_view, arrays std::array):
//   members of a joint                                             and of
//   name                                                           a coordinate: "line"; "slide"
//   title                                                          its purpose in one sentence
//   unit                                                           a coordinate only: "m", "rad"
//   body_names, row_names, row_kinds                               a coordinate: the last two
//   Parameters<T>, parameters                                      the numbers, and a ParameterInfo for each parameter
//   default_value      (index, q, p, t)                            writes p's parameter `index` from q and those before
//   Coordinates                                                    std::tuple of the coordinates
//   Immovable                                                      a coordinate: std::tuple of the variants
//   Bounded                                                        an effect: std::tuple of its bounded rows, if any
//   coordinate_unit, coordinate_uses                               an effect whose law is about one coordinate alone;
//                                                                  "any" unit: cdot::coordinate, without row blocks;
//                                                                  "joint": an effect on a joint itself, on_joint,
//                                                                  with breaks(p, t, load, D) for its one event
//   immovable_body                                                 a variant only: the index of that body
// A variant inherits every unchanged member from its block. T is float, double, cdot::Pack, or any type with + - * /,
// comparison, select and the functions used.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <tuple>

namespace cdot {

// Raised when the members above change. Every kernel asserts the number that it was generated for.
inline constexpr int kernel_contract = 2;

enum class RowKind {
  equality,    // C = 0
  inequality,  // C >= 0, its impulse is >= 0
  velocity     // J v = 0 only: C has no position form and is reported as 0 (rolling, a knife edge)
};

enum class ParameterKind {
  point,   // a point fixed on a body, in that body's frame; 2 numbers in the plane, 3 in space [m]
  vector,  // a vector fixed in a body, in that body's frame; 2 numbers, 3 in space
  unit,    // the same of length 1; the runtime normalises a scene's vector and refuses a zero vector
  frame,   // a triad fixed in a body: its x axis in the body's frame, 2 numbers; in space x, y and z axis, 9 numbers
  scalar   // 1 number
};

// A parameter of an effect on the coordinate of a joint.
enum class CoordinateUse {
  none,        // the law does not read it
  required,    // to be given
  by_default,  // default_value(index, ...) computes it without poses
  value        // by default the value of the coordinate when the effect is added
};

inline constexpr double unbounded = std::numeric_limits<double>::infinity();

struct ParameterInfo {
  std::string_view name;
  ParameterKind kind;
  int body;               // index of the body that it is fixed in; -1: fixed in the world, or a scalar
  std::string_view unit;  // "m", "rad", "1", "m/s", ...
  int offset;             // of its first number in Parameters<T>, in units of T
  int size;
  bool has_default;  // default_value(index, ...) computes it from the initial pose and the parameters before it
  double above = -unbounded, below = unbounded;  // a scalar lies between these
  bool from = false;                             // it may be `above` itself
  bool unlimited = false;                        // it may be infinite
};

inline float abs(float x) { return std::fabs(x); }
inline double abs(double x) { return std::fabs(x); }
inline long double abs(long double x) { return std::fabs(x); }

// The number type inside T: T itself, or the lane type of a pack (which specialises this).
template <class T>
struct ScalarOf {
  using type = T;
};

// The smallest positive normal number of T: the threshold of a kernel's guards.
template <class T>
inline T smallest() {
  return T(std::numeric_limits<typename ScalarOf<T>::type>::min());
}

// a where the condition is true, else b, without a branch on data.
template <class T>
inline T select(bool condition, T a, T b) {
  return condition ? a : b;
}

// 1/x; 0 where |x| is below the smallest normal number. Kernels divide only by this function.
template <class T>
inline T inverse(T x) {
  return select(abs(x) >= smallest<T>(), T(1) / x, T(0));
}

// -1, 0 or 1.
template <class T>
inline T sign(T x) {
  return select(x > T(0), T(1), select(x < T(0), T(-1), T(0)));
}

// 1/d for a pivot d of K = L D L^T; k is the diagonal entry of K before elimination. 0 where d is round-off beside k:
// the row depends on earlier rows, and its impulse stays 0.
template <class T>
inline T pivot(T d, T k) {
  constexpr auto epsilon = std::numeric_limits<typename ScalarOf<T>::type>::epsilon();
  return select(d > T(64 * epsilon) * k, T(1) / d, T(0));
}

// The bounds of a bounded row of an effect, B::bounds(C, p, t, bounds). Of a coordinate, lower <= C <= upper. Of a
// force (B::of_rate), that of a row J v = rate, with `acceleration` the derivative of the rate by time.
template <class T>
struct RowBounds {
  T lower = T(-unbounded), upper = T(unbounded), rate = T(0), acceleration = T(0);
};

namespace planar {

// Centre of mass [m], rotation R = [c -s; s c] and the unwrapped angle [rad] that c and s belong to.
template <class T>
struct Pose {
  T x, y, c, s, angle;
};

// Velocity of the centre of mass [m/s] and angular velocity [rad/s], both in world axes.
template <class T>
struct Velocity {
  T x, y, w;
};

// Inverse mass [1/kg] and inverse inertia about the centre of mass [1/(kg m^2)]; both 0 for an immovable body.
template <class T>
struct InverseMass {
  T m, I;
};

}  // namespace planar

namespace spatial {

// Centre of mass [m], orientation as Euler parameters (a unit quaternion, e0 its scalar part), and their rotation
// matrix A(e), row by row. The body's x axis is (xx, yx, zx) in the world.
template <class T>
struct Pose {
  T x, y, z;
  T e0, e1, e2, e3;
  T xx, xy, xz, yx, yy, yz, zx, zy, zz;
};

// Velocity of the centre of mass [m/s] and angular velocity [rad/s], both in world axes.
template <class T>
struct Velocity {
  T x, y, z, wx, wy, wz;
};

// Inverse mass [1/kg] and inverse inertia tensor about the centre of mass in world axes [1/(kg m^2)]; all 0 for an
// immovable body.
template <class T>
struct InverseMass {
  T m, Ixx, Iyy, Izz, Ixy, Ixz, Iyz;
};

// The same for a body with equal inertia about every axis (a ball, a cube).
template <class T>
struct IsotropicInverseMass {
  T m, I;
};

}  // namespace spatial
}  // namespace cdot
