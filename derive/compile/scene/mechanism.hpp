// A scene as numbers: what the compiler of scenes knows of the runtime. World and scene stay behind mechanism.cpp.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <cdot/integrators.hpp>

namespace cdot::compile {

using Tensor = std::array<double, 6>;  // xx, yy, zz, xy, xz, yz

// Numbers of a velocity go by columns: x, y, w; in space x, y, z, wx, wy, wz.
struct Body {
  std::string name;
  bool moves = true;
  std::vector<double> pose;      // at the start: x, y, angle; in space x, y, z, e0, e1, e2, e3 [m], [rad]
  std::vector<double> velocity;  // at the start, by columns
  double inv_m = 0, inv_I = 0;   // [1/kg], [1/(kg m^2)]; inv_I: if `inertia_turns`, 0
  // In space, where the moments of inertia differ: the tensor and its inverse, in the body's axes.
  bool inertia_turns = false;
  Tensor inertia{}, inverse_inertia{};
  std::vector<double> acceleration;          // of constant forces and torques, by columns [m/s^2], [rad/s^2]
  std::array<double, 3> torque{};            // the constant one, if `inertia_turns` [N m]
  double linear_drag = 0, angular_drag = 0;  // [1/s]
  bool drags() const { return moves && (linear_drag != 0 || angular_drag != 0); }
  bool turns() const { return moves && (inertia_turns || inv_I > 0); }
};

// Rows of a table of time as cubics between them, in the time since the first row of each: a + b t + c t^2 + d t^3. The
// last piece, and outside the table the first number of an end, are constant.
struct Table {
  std::vector<double> times;
  std::vector<std::array<double, 4>> pieces;
  bool repeats = false;
  std::vector<double> breaks;  // the times at which steps of the method end
};

// A number that follows a function of time: an expression in a unit, as the scene has written it, or a table.
struct InTime {
  std::string text, unit;
  int table = -1;  // among those of the mechanism
};

// A parameter of a joint in space that counts the whole turns of one of its coordinates, as those of a gear.
struct CountedTurns {
  std::size_t parameter;   // among those of the joint
  std::string coordinate;  // of its spec
  int angle;               // its number among the mechanism's
};

struct Joint {
  std::string name, type;
  std::vector<int> bodies;         // indices into Mechanism::bodies
  std::vector<double> parameters;  // laid out as Parameters<T> of the kernel
  // Of a motor without a largest force, whose rate is an equation: the coordinate of that spec, and its speed.
  std::string coordinate{};
  double speed = 0;
  std::optional<InTime> speed_in_time{};
  std::map<std::size_t, InTime> in_time{};  // those of `parameters` that follow functions of time
  std::vector<bool> is_rate{};              // by row: of velocities, without C
  int holds = -1;                           // of a joint that may break: its number among these
  int tensions = 0;                         // rows of the stiffness of tension (midpoint/tensions.hpp)
  std::vector<CountedTurns> turns{};
  std::vector<std::string> coordinates{};  // that its spec leaves free
};

// A force along each row of a spec, or along one of its coordinates; a row with bounds on a coordinate.
struct Effect {
  std::string name;                // "hinge.angle.servo"
  std::string type;                // the spec that has the rows
  std::string coordinate;          // of that spec; empty: its own rows
  std::vector<int> bodies;         // of that spec
  std::vector<double> parameters;  // of that spec
  enum Law {
    of_spec,  // that of a spec; `numbers` are its Parameters<T>
    spring,   // -k C - d dC/dt; numbers: 1 by frequency, frequency or k, damping ratio or d, rest
    load,     // numbers: F
    // Rows with bounds:
    limited,  // of_spec, a force within limits
    bound,    // of_spec, its bounded row number `row`
    motor,    // numbers: rate, largest force
    limit,    // numbers: lower, upper end
    lock      // numbers: the value held
  } law = of_spec;
  std::string law_type;  // of_spec, limited, bound
  int angle = -1;        // of a coordinate in space that counts whole turns: its number among the mechanism's
  std::size_t row = 0;
  std::vector<double> numbers;
  std::map<std::size_t, InTime> in_time{};             // those of `numbers` that follow functions of time
  std::map<std::size_t, InTime> parameters_in_time{};  // on a rope or a soft joint: those of its `parameters`
  double size = 1;                                     // Island::size of its mechanism [m]
  bool beside_motor = false;  // in whose mechanism a motor without a largest force acts beside ends
  // Of a row whose bounds grow with a load: what carries it, among Mechanism::bounded or Mechanism::joints.
  int loaded_by_row = -1, loaded_by_joint = -1;
  int cone = -1;   // of a row of a force along several coordinates: the first one of these, among Mechanism::bounded
  int holds = -1;  // of a joint that may break, on which it acts: as Joint::holds
  bool pulls = false;                 // a soft rope: a spring where C <= 0, whose force is never negative
  bool by_own_force = false;          // an event of the row depends on the force that it carries
  int tensions = 0;                   // as Joint::tensions
  std::vector<CountedTurns> turns{};  // of a soft joint: as Joint::turns
  bool acts_by_force() const { return law <= limited; }
  bool is_loaded() const { return loaded_by_row >= 0 || loaded_by_joint >= 0; }
};

// By which a joint breaks.
struct Bond {
  std::string name, type;                     // "hinge.breaking", "breaking"
  int holds = 0;                              // the number of the joint among those that may break
  int joint = -1, bounded = -1, effect = -1;  // it, among Mechanism::joints, Mechanism::bounded, Mechanism::effects
  bool carries = true;                        // false: an effect without rows of its own, which has no load
  std::vector<double> numbers{};              // Parameters<T> of the spec
};

using Method = Integrator;

struct Mechanism {
  std::string file, title, method_name;
  int dimension = 2;
  Method method = Method::rk4;
  double step = 0;                  // [s]
  double tolerance = 0;             // of C [m], [rad]
  double size = 1;                  // of the smallest mechanism [m]
  std::array<double, 3> gravity{};  // [m/s^2]
  std::vector<std::string> inputs;  // numbers that a run may change, as a header names them
  std::vector<Body> bodies;         // the last one is the world
  std::vector<Joint> joints;
  std::vector<Effect> effects;                   // by forces
  std::vector<Effect> bounded;                   // rows with bounds
  std::vector<Bond> bonds;                       // by joint
  std::map<std::string, std::string> own_specs;  // files beside the scene, by type
  std::vector<Table> tables;                     // that numbers follow
  bool foresees = true;                          // corrections may begin close to their end
  bool open = false;                             // no step projects onto C = 0
  double fed_back = 0;                           // share of C that the velocities of a step take back
  int angles = 0;                                // that count whole turns
  std::vector<std::string> notes;                // parts of the scene that are left out

  bool spatial() const { return dimension == 3; }
  // True for a Runge-Kutta method; the others step velocities by impulses.
  bool on_accelerations() const { return works_on_accelerations(method); }
  int breakable() const { return bonds.empty() ? 0 : bonds.back().holds + 1; }  // joints that may break
  bool has_rates() const {
    return std::ranges::any_of(joints, [](const Joint& joint) { return std::ranges::count(joint.is_rate, true) > 0; });
  }
  bool has_bonds_on_effects() const {  // by forces
    return std::ranges::any_of(bonds, [](const Bond& bond) { return bond.effect >= 0; });
  }
  bool has_events_by_force() const { return std::ranges::any_of(bounded, &Effect::by_own_force); }
  // By these methods the impulses of corrections count as loads.
  bool weighs() const {
    return (!bonds.empty() || has_events_by_force() || has_loads()) &&
           (method == Method::euler || method == Method::rattle);
  }
  // Without a largest force, among the rows with bounds.
  bool has_strong_motors() const {
    return std::ranges::any_of(bounded,
                               [](const Effect& of) { return of.law == Effect::motor && std::isinf(of.numbers[1]); });
  }
  bool has_loads() const { return has_cones() || std::ranges::any_of(bounded, &Effect::is_loaded); }
  bool has_cones() const {
    return std::ranges::any_of(bounded, [](const Effect& of) { return of.cone >= 0; });
  }
  // True if the inertia of a body turns with it.
  bool has_gyroscopes() const { return std::ranges::any_of(bodies, &Body::inertia_turns); }
  bool keeps_momenta() const { return has_gyroscopes() && !on_accelerations(); }  // of such bodies
  std::size_t linear() const { return static_cast<std::size_t>(dimension); }      // columns before the angular ones
  std::size_t columns() const { return spatial() ? 6 : 3; }
  std::size_t components() const {  // of all velocities
    return columns() * static_cast<std::size_t>(std::ranges::count_if(bodies, &Body::moves));
  }
  std::string column(std::size_t c) const {
    constexpr const char *plane[] = {"x", "y", "w"}, *space[] = {"x", "y", "z", "wx", "wy", "wz"};
    return spatial() ? space[c] : plane[c];
  }
  // Acceleration of a body by gravity and constant forces; without its torque if its inertia turns.
  double push(const Body& body, std::size_t c) const { return (c < linear() ? gravity[c] : 0) + body.acceleration[c]; }
};

// Choices of the command line in place of the scene's; empty and 0: as the scene has it.
struct Wishes {
  std::string integrator, drift;
  double step = 0;
  std::vector<std::string> inputs;  // "hinge.angle.servo.target"
  bool plain = false;               // corrections foresee nothing
};

// Throws SceneError for a scene that has mistakes, or that has parts which cannot be compiled.
Mechanism read_mechanism(const std::string& file, const Wishes& wishes);

}  // namespace cdot::compile
