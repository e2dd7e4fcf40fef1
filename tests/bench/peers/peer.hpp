// The description of a problem for all engines, and the interface of an engine: a list of series of settings, each of
// which starts a run. An engine is one file in engines/ that registers itself.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace cdot::peers {

using Vec3 = std::array<double, 3>;
using Quaternion = std::array<double, 4>;  // e0 (scalar), e1, e2, e3; from the body to the world

// The state of one body: centre of mass, orientation, and their rates in world axes.
struct State {
  Vec3 x{};
  Quaternion q{1, 0, 0, 0};
  Vec3 v{}, w{};
};

struct Body {
  std::string name;
  double mass = 0;
  Vec3 inertia{};  // about the axes of the body's frame, which are principal
  State start;
  bool moves = true;
  bool turns = true;   // false: the orientation is fixed
  Vec3 torque{};       // constant [N m]
  double damping = 0;  // force = -mass * damping * velocity, and likewise for its spin [1/s]
  int number = 0;      // in the scene
};

// `distance` is a rod, `max_distance` a string; `orientation` locks the relative rotation of two bodies. `six_dof`
// locks slides, and rotations as given. A `mount` holds b by springs alone. A
// `contact` keeps the anchor of a above a plane of b, the world, by its anchor; its axis is the plane's normal.
enum class JointKind {
  revolute,
  prismatic,
  spherical,
  fixed,
  distance,
  max_distance,
  orientation,
  universal,
  six_dof,
  pulley,
  mount,
  contact
};

// Motor of a hinge or a slider: of b along the axis from a. Motor and stops of a hinge are for the angle from a to b,
// which in the plane is 0 if both bodies' angles are equal.
struct Motor {
  double speed = 0, most = 0;                     // [rad/s], [N m]; [m/s], [N]
  std::function<double(double time)> speed_at{};  // in place of the speed
};
// A drive of a hinge to an angle: the torque -stiffness (angle - target) - damping rate, of at most `most`.
struct Servo {
  double target = 0, stiffness = 0, damping = 0, most = 0;  // [rad], [N m/rad], [N m s/rad], [N m]
  bool saturates_smoothly = false;                          // its spring alone, and in Cdot only
};
// Springs of a mount: along its axis, across it, and of the turns about these. They are unstretched where the anchors
// meet, unturned.
struct Mount {
  double along = 0, across = 0, twist = 0, bend = 0;  // [N/m], [N/m], [N m/rad], [N m/rad]
};
struct Stops {
  double lower = 0, upper = 0;  // [rad]
};
// A damper has no stiffness.
struct Spring {
  double stiffness = 0, damping = 0;  // [N/m, N m/rad], [N s/m, N m s/rad]
};

inline constexpr int world = -1;

// A rotation about one of several perpendicular axes: the first is fixed in a, the last in b, and earlier rotations
// move later axes.
struct Turn {
  Vec3 axis{};  // at the start, in world axes, of length 1
  bool held = false;
  std::optional<Motor> motor;
};

struct Joint {
  JointKind kind = JointKind::revolute;
  int a = 0, b = 0;            // indices of bodies, or `world`
  Vec3 anchor{};               // of a, at the start, in world axes
  Vec3 axis{};                 // likewise: axis of rotation or sliding, of any length but 0
  std::optional<Vec3> axis_b;  // the axis in b, if different
  Vec3 anchor_b{};             // of b; differs if the joint starts open
  double length = 0;           // of a rope over wheels: the part at a plus `ratio` times the part at b
  Vec3 wheel{}, wheel_b{};     // of a pulley, in the world
  double ratio = 1;
  std::vector<Turn> turns;  // two for a universal joint, three for a six-degree joint
  std::optional<Motor> motor;
  std::vector<double> brakes;  // of a hinge: dry friction up to these torques [N m]
  std::optional<Servo> servo;
  std::optional<Mount> mount;
  double friction = 0;  // coefficient of a contact
  std::optional<Stops> stops;
  std::optional<Spring> spring;  // of a hinge or a slider, unstretched at the start
  std::optional<Spring> soft;    // softness of the joint itself
  int number = 0;                // in the scene
};

// Thrown for a feature that an engine does not support.
struct CannotSay : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The quantity whose maximum over bodies and sample times is the error.
enum class Measure {
  place,       // distance of the centre of mass from the reference [m]
  orientation  // angle of the body from the reference [rad]
};

struct Problem {
  std::string name, title, scene;
  bool planar = false;  // motion in the x-y plane; inertias about x and y are then arbitrary
  Vec3 gravity{};
  double sleep_after = 0;  // [s] of rest before sleep; 0: never
  double duration = 0;
  Measure measure = Measure::place;
  std::vector<Body> bodies;
  std::vector<Joint> joints;
  std::vector<double> times;                  // sample times of the comparison
  std::vector<std::vector<State>> reference;  // at these times, every body
};

class Run {
 public:
  virtual ~Run() = default;
  virtual void advance(double to) = 0;  // may throw if the engine gives up
  virtual void step(double by) = 0;     // likewise
  virtual State state(int body) const = 0;

  // Changes between two steps: bodies by index in the problem, joints by number. Actions on a body's centre:
  virtual void strike(int, const Vec3& /*impulse*/) { throw CannotSay("no impulse on a body"); }
  // `now` is the problem with the present states as its start. Returns false if the engine does not support the change
  // and must be rebuilt.
  virtual bool add(const Problem& /*now*/, const Joint&) { return false; }
  virtual bool remove(int /*joint*/) { return false; }
  virtual bool change(const Problem& now, const Joint& joint) { return remove(joint.number) && add(now, joint); }

  // The force in a joint during the last step [N].
  virtual double force(int /*joint*/) const { throw CannotSay("it does not tell what a joint carries"); }
  virtual bool asleep(int /*body*/) const { throw CannotSay("nothing sleeps in it"); }
};

// A run in equal steps.
class SteppedRun : public Run {
 public:
  explicit SteppedRun(double h) : h_(h) {}
  void advance(double to) final {
    for (; double(taken_) * h_ < to - 0.5 * h_; ++taken_) step(h_);
  }

 private:
  double h_;
  long taken_ = 0;
};

// One way to use an engine, with the one knob that trades time for accuracy.
struct Series {
  std::string name;
  std::string changed;        // description of every changed default; "" if none
  std::string knob;           // "h" [s], or "accuracy"
  std::vector<double> knobs;  // coarse to fine
  std::function<std::unique_ptr<Run>(double knob)> start;
};

struct Engine {
  std::string name;
  std::string version;
  std::string number;   // "double" or "float"
  std::string colour;   // in diagrams
  std::string changed;  // defaults changed by all its series
  // Empty if the engine cannot pose the problem. The problem outlives the series.
  std::function<std::vector<Series>(const Problem&)> series;
  int lanes = 1;          // mechanisms in a run, all alike; the price is that of one
  bool is_limit = false;  // no engine, but one mechanism written by hand
};

// All registered engines by name, Cdot first.
const std::vector<Engine>& engines();

struct Registration {
  explicit Registration(Engine engine);
};

// Steps that divide the time between samples, from about 1/60 s on, two sizes per halving.
std::vector<double> steps(const Problem& problem);
// For methods of higher order: from 1/15 s on.
std::vector<double> fine_steps(const Problem& problem);

}  // namespace cdot::peers
