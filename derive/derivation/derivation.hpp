// The derivation of a joint: C, Cdot, J, K, gamma and the geometric stiffness, as expressions over vectors.
#pragma once

#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "derive/expression/functions.hpp"
#include "derive/language/joint.hpp"

namespace cdot::derive {

// The symbols of one body.
struct BodySymbols {
  Expr x, theta;      // centre of mass (vector), angle (empty in space)
  Expr v, w;          // velocity, angular velocity (a scalar in the plane, a vector in space)
  Expr inv_m, inv_I;  // inverse mass and inertia (in space a tensor in world axes)
};
BodySymbols body_symbols(const Joint& joint, int body);

// One body's part of a row of J: the factors of v and of w.
struct JacobianEntry {
  Expr v;  // vector
  Expr w;  // scalar in the plane, vector in space
};
// The numbers of J: x, y and w of each body in the plane; x, y, z and the components of w in space.
std::vector<Expr> columns_of(const JacobianEntry& entry);
std::vector<Expr> columns_of(const std::vector<JacobianEntry>& J);
inline std::size_t columns_per_body(int dimension) { return dimension == 2 ? 3 : 6; }
Expr zero_spin(Pool& pool);

// A scalar row. Vector equations have been taken apart into their components along the world's axes.
struct ScalarRow {
  std::string name;          // "C1", "C1_x", or the author's name
  const Row* row = nullptr;  // the statement that it comes from; null for a coordinate
  RowKind kind = RowKind::equality;
  int component = -1;             // of a vector equation; -1 for a scalar one
  bool of_world = false;          // as its statement
  Expr C;                         // zero for a velocity row
  Expr Cdot;                      // J v + dC/dt, before the velocities are isolated
  Expr C_t;                       // dC/dt at fixed q
  Expr gamma;                     // -Jdot v - d/dt(dC/dt); empty where a body is immovable
  Expr gamma_by_entries;          // the same, entry of J by entry
  std::vector<JacobianEntry> J;   // one per body
  std::vector<Expr> gradients{};  // vectors that J repeats, by names of their own (gradient.hpp)
  std::vector<Expr> axes{};       // those of angular velocities
};

std::vector<std::vector<Expr>> columns_of(std::span<const ScalarRow> rows);  // row by row

// The rows of a joint, or the one row of a coordinate.
struct Block {
  std::string name;    // of the coordinate; empty for the joint itself
  int immovable = -1;  // this body has neither velocity nor inverse mass
  std::vector<ScalarRow> rows;
  std::vector<std::vector<Expr>> K;            // lower triangle: K[i][j], j <= i
  std::vector<std::vector<Expr>> K_isotropic;  // in space: K of bodies whose inverse inertia is a number
  std::vector<Expr> lambda;                    // the multipliers that `stiffness` contains
  // d(J^T lambda)/dq: square, a row and a column per column of J; not of a block with an immovable body.
  std::vector<std::vector<Expr>> stiffness;
  // In a Derivation: this block with one body immovable, for each body without which no row of J vanishes.
  std::vector<Block> variants;
};

// The law of an effect by the components of its inputs, in the order of the rows.
struct DerivedLaw {
  std::vector<Expr> value, rate;  // leaves
  Expr energy;                    // empty: none
  std::vector<Expr> force;        // all of it, -dE/d(value) and what the spec adds
  std::vector<Expr> unstored;     // what the spec adds: the part that has no energy
  // Of the force: -dF_i/d(value_j) and -dF_i/d(rate_j).
  std::vector<std::vector<Expr>> stiffness, damping;
};

// The prescribed rate of a bounded row, and its derivative by time.
struct DerivedBound {
  Expr rate, acceleration;  // empty for the ends of a coordinate
  Expr lower, upper;        // without a load; empty: none
  Expr by_lower, by_upper;  // what each unit of the load adds
};

// A joint and all parts of its kernels, derived once: the same object is proved, planned, printed and explained.
struct Derivation {
  Joint joint;                        // without coordinates that an include brought and rows constrain
  Block rows;                         // refers to rows of `joint`: a Derivation moves, but has no copies
  std::vector<Block> coordinates;     // in the order of those of `joint`
  std::optional<DerivedLaw> law;      // of an effect with a force or an energy
  std::vector<DerivedBound> bounded;  // in the order of those of `joint`

  explicit Derivation(Joint of) : joint(std::move(of)) {}
  Derivation(Derivation&&) = default;
};

// A velocity row that is not linear in the velocities.
struct NotLinear : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The moving part; by default everything moves.
struct Moving {
  int immovable = -1;  // this body stands still
  Expr only = {};      // nothing moves but this leaf: one term of the product rule, or a slope by a `given` scalar
  // Nothing moves, but the Euler parameters e of this body grow by themselves, de/dt = e, and so leave their unit
  // sphere: what is fixed in the body and turned by A(e) grows too. In space; a twist has no part in it.
  int stretched = -1;
};

// d e/dt along the motion: dx/dt = v, ds/dt = w x s for what is fixed in a body, dtheta/dt = w. Velocities themselves
// count as constant, so that applied twice it gives C's second derivative without the accelerations.
Expr time_derivative(Expr e, const Joint& joint, const Moving& motion = {});

// e as the angle from one vector to another, atan2(u x v, u . v), in space atan2(|u x v|, u . v), if it is one.
struct AngleBetween {
  Expr from, to;
};
std::optional<AngleBetween> angle_between(Expr e);
// An arc tangent that is the twist of a frame against another about their x, y or z axes, as such; empty for others.
Expr twist_of(Expr e);
// True if y^2 + x^2 = 1 in e = atan2(y, x), whatever the pose.
bool is_on_unit_circle(Expr e);
inline bool is_root(Expr e) { return e->kind == Kind::norm || (e->kind == Kind::function && e->fn == Fn::sqrt); }

// Terms r x t + s x t as (r + s) x t, and likewise for dot: shorter, and how people write.
Expr collected(Expr e);

// K = J M^-1 J^T of these rows, lower triangle; `isotropic`: inverse inertias are numbers also in space.
std::vector<std::vector<Expr>> effective_mass(const Joint& joint, const std::vector<ScalarRow>& rows,
                                              int immovable = -1, bool isotropic = false);

// The coefficients of the velocities in an expression that is linear in them: transposition, node by node. As it finds
// them, and collected.
std::vector<JacobianEntry> factors_of_velocities(Expr Cdot, const Joint& joint);
std::vector<JacobianEntry> isolate_velocities(Expr Cdot, const Joint& joint);

Derivation derive(Joint joint);
void derive_law(Derivation& derivation);  // of an effect: `law` and `bounded`
Block derive_rows(const Joint& joint, int immovable = -1);
Block derive_coordinate(const Joint& joint, const Coordinate& coordinate, int immovable = -1);

}  // namespace cdot::derive
