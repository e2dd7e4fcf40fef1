// The definitions of a World, its bodies and its joints: plain data with defaults, always in doubles. This header
// stands apart from cdot/world.hpp: a reader of scenes fills the data without a World.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <cdot/integrators.hpp>
#include <cdot/profile.hpp>

namespace cdot {

// Thrown by all functions that set a World up; the text names the error and the fix. step() never throws.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

enum class Solver { direct, iterative };

struct SolverRow {
  std::string_view name;
  Solver method;
  bool sweeps;  // Settings::iterations applies
};

// In the order of the enumerators. runtime/solve/solver.hpp has their functions.
inline constexpr std::array<SolverRow, 2> solvers{{
    {"direct", Solver::direct, false},       // sparse LDL^T of each island's K: exact to round-off, for mechanisms
    {"iterative", Solver::iterative, true},  // sequential impulses: coarse, cheap, for large scenes
}};
constexpr bool sweeps(Solver solver) { return solvers[static_cast<std::size_t>(solver)].sweeps; }

enum class Drift {
  none,        // velocities only; C grows with time
  baumgarte,   // a share of C is fed back into the velocities: J v = -(baumgarte / h) C
  projection,  // Newton on C after every step, the velocities projected as well
  // For sweeps: rows as stiff springs before the poses move, then rigid rows without C, so that the velocities keep
  // nothing of the correction.
  soft
};

// How the iterative solver solves the rows of one joint together. tests/bench/ulp measures cost and accuracy of each.
enum class Kernels {
  fast,      // stores K^-1 of two rows in place of its factors
  balanced,  // K = L D L^T
  robust     // the same factors from J, without K: long arms and heavy loads cost half as many digits
};

struct Settings {
  Solver solver = Solver::direct;
  Integrator integrator = Integrator::euler;
  // For rk4, dop853 and radau5. 0: step(h) takes steps of h / substeps. Above 0: the method chooses its steps, each
  // with an estimated error below this, in [m], [rad], [m/s] and [rad/s].
  double local_error = 0;
  Drift drift = Drift::projection;
  int iterations = 10;     // of the iterative solver, per substep
  int substeps = 1;        // step(h) takes this many steps of h / substeps
  double baumgarte = 0.2;  // share of C removed per step, 0 to 1
  Kernels kernels = Kernels::balanced;
  bool warm_start = true;  // the iterative solver starts from the last step's impulses
  double gravity_x = 0;    // [m/s^2]
  double gravity_y = 0;
  double gravity_z = 0;       // in space
  double sleep_after = 0;     // [s] of rest before an island sleeps; 0: islands never sleep
  double sleep_speed = 1e-3;  // [m/s] and [rad/s] below which a body counts as resting
};

// True if `implicit` takes steps of the midpoint rule, which are stable at every length.
constexpr bool takes_midpoint(const Settings& s) {
  return row_of(s.integrator).stiffens && !sweeps(s.solver) && s.drift == Drift::projection;
}

// Why these methods exclude each other; nullptr if they do not.
constexpr const char* mistake_in_methods(const Settings& s) {
  const bool accelerations = works_on_accelerations(s.integrator);
  if (s.local_error > 0 && !accelerations)
    return "local_error chooses the steps of rk4, dop853 and radau5 only: leave it out, or choose one of these";
  if (s.local_error > 0 && s.local_error < 1e-20)
    return "no step has an error below round-off: local_error must be at least 1e-20";
  if (row_of(s.integrator).projects && s.drift != Drift::projection)
    return "rattle includes the projection: it needs drift = projection";
  if (s.drift == Drift::soft && !sweeps(s.solver))
    return "soft corrects by sweeps: it needs solver = iterative; the direct solver takes drift = projection";
  if (s.drift == Drift::soft && s.integrator != Integrator::euler)
    return "soft corrects Euler's steps only: other integrators need drift = projection";
  if (!accelerations) return nullptr;
  if (s.drift == Drift::baumgarte)
    return "baumgarte corrects velocities of Euler's steps only: rk4, dop853 and radau5 need drift = projection";
  if (!row_of(s.integrator).any_solver && sweeps(s.solver))
    return "radau5 differentiates the accelerations, for which sweeps are too inexact: it needs solver = direct";
  if (s.drift == Drift::none && sweeps(s.solver))
    return "only drift = projection removes the error that the iterative solver leaves in accelerations";
  return nullptr;
}

struct BodyDefinition {
  double x = 0, y = 0, angle = 0;   // centre of mass [m], [rad]
  double vx = 0, vy = 0, w = 0;     // [m/s], [rad/s]
  double mass = 0;                  // [kg]; must be > 0 unless is_static
  double inertia = 0;               // about the centre of mass [kg m^2]; 0: a point mass, which does not turn
  bool is_static = false;           // immovable: inverse mass and inertia exactly 0
  bool fixed_rotation = false;      // inverse inertia exactly 0
  double force_x = 0, force_y = 0;  // constant, at the centre of mass [N]
  double torque = 0;                // constant [N m]
  double linear_damping = 0;        // [1/s]: force = -mass * linear_damping * v
  double angular_damping = 0;       // [1/s]
};

// Symmetric, about the centre of mass in the body's frame [kg m^2].
struct Inertia {
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
};

// Why no rigid body can have this tensor; nullptr if one can or if the tensor is 0.
const char* mistake_in(const Inertia& inertia);

struct SpatialBodyDefinition {
  double x = 0, y = 0, z = 0;                       // centre of mass [m]
  double e0 = 1, e1 = 0, e2 = 0, e3 = 0;            // orientation as a quaternion of any length but 0
  double vx = 0, vy = 0, vz = 0;                    // [m/s]
  double wx = 0, wy = 0, wz = 0;                    // in world axes [rad/s]
  double mass = 0;                                  // [kg]; must be > 0 unless is_static
  Inertia inertia = {};                             // all 0: a point mass, which does not turn
  bool is_static = false;                           // immovable
  bool fixed_rotation = false;                      // inverse inertia exactly 0
  double force_x = 0, force_y = 0, force_z = 0;     // constant, at the centre of mass [N]
  double torque_x = 0, torque_y = 0, torque_z = 0;  // constant, in world axes [N m]
  double linear_damping = 0, angular_damping = 0;   // [1/s]
};

// A number of a parameter as a function of time.
struct NumberInTime {
  int number;  // of the value's numbers, from 0
  Profile profile;
};

struct NamedValue {
  std::string name;
  // Scalar: 1. Point, vector or unit: 2 in the plane, 3 in space. Frame: 2 in the plane; in space its x axis (3), x and
  // y axes (6) or all three (9).
  std::vector<double> numbers;
  // Functions of time that numbers of this value follow; `numbers` then matters for the others.
  std::vector<NumberInTime> in_time{};
};

inline bool in_time(const std::vector<NamedValue>& values) {
  return std::any_of(values.begin(), values.end(), [](const NamedValue& value) { return !value.in_time.empty(); });
}

// {"F", {2, swing}}: each number a constant or a function of time.
inline NamedValue in_time(std::string name, const std::vector<Profile>& profiles) {
  NamedValue value{std::move(name), {}};
  for (const Profile& profile : profiles) {
    value.in_time.push_back({static_cast<int>(value.numbers.size()), profile});
    value.numbers.push_back(0);
  }
  return value;
}

// Stiffness and damping of a soft row. by_frequency true: frequency [Hz] and damping ratio, referred to the row's
// effective mass. False: stiffness [N/m, N m/rad] and damping [N s/m, N m s/rad].
struct Softness {
  bool by_frequency = true;
  double frequency = 0, damping_ratio = 0;
  double stiffness = 0, damping = 0;
};

struct JointDefinition {
  std::string type;                    // as in the specs: "revolute", "distance", ...
  std::vector<int> bodies;             // in the order of the spec: a, b, ...
  std::vector<NamedValue> parameters;  // the others get the spec's defaults at the present poses
  std::optional<Softness> soft;        // the joint's own equality rows as springs
};

// A damped spring between a point of one body and a point of another: tension = stiffness (length - rest_length) +
// damping d(length)/dt.
struct SpringDefinition {
  int body_a = 0, body_b = 0;
  double ax = 0, ay = 0, az = 0;  // in the frames of the bodies [m]; z only in space
  double bx = 0, by = 0, bz = 0;
  double stiffness = 0;    // [N/m]
  double rest_length = 0;  // [m]
  double damping = 0;      // [N s/m]
};

// A joint or an effect that was accepted but has no influence, with the reason.
struct Note {
  int joint;
  std::string text;
};

}  // namespace cdot
