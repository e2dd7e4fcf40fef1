// What a problem is, whoever solves it, and what an engine offers to be measured: a list of series
// of settings, each of which starts a run. An engine is one file in engines/ that registers itself.
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

// Of one body: centre of mass, orientation, and their rates in world axes.
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
  bool turns = true;   // its orientation is not held
  Vec3 torque{};       // constant [N m]
  double damping = 0;  // force = -mass * damping * velocity, and likewise for its spin [1/s]
  int number = 0;      // in the scene
};

// `distance` keeps two points apart, `max_distance` is a string, `orientation` keeps two bodies from turning against
// each other; `six_dof` has its slides held, and of its turns what is said.
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
  pulley
};

// What drives a hinge from a to b, and what stops it; in the plane an angle is zero where both bodies' are equal.
struct Motor {
  double speed = 0, most = 0;  // [rad/s], [N m]
};
struct Stops {
  double lower = 0, upper = 0;  // [rad]
};
// A damper has no stiffness.
struct Spring {
  double stiffness = 0, damping = 0;  // [N/m, N m/rad], [N s/m, N m s/rad]
};

inline constexpr int world = -1;

// About one of several axes at right angles: the first fixed in a, the last in b, each moved by those before it.
struct Turn {
  Vec3 axis{};  // at the start, in world axes, of length 1
  bool held = false;
  std::optional<Motor> motor;
};

struct Joint {
  JointKind kind = JointKind::revolute;
  int a = 0, b = 0;            // indices of bodies, or `world`
  Vec3 anchor{};               // of a, at the start, in world axes
  Vec3 axis{};                 // likewise: what it turns about or slides along, of any length but 0
  std::optional<Vec3> axis_b;  // what b has for it, if not the same
  Vec3 anchor_b{};             // of b: elsewhere where a joint starts open
  double length = 0;           // of a rope over wheels, its part at a and `ratio` times that at b
  Vec3 wheel{}, wheel_b{};     // of a pulley, in the world
  double ratio = 1;
  std::vector<Turn> turns;  // of a universal joint two, of one of six degrees three
  std::optional<Motor> motor;
  std::optional<Stops> stops;
  std::optional<Spring> spring;  // of a hinge or a slider, at rest where it starts
  std::optional<Spring> soft;    // how it holds, if not for good
  int number = 0;                // in the scene
};

// What an engine has no words for.
struct CannotSay : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// What an error is the largest of, over bodies and sample times.
enum class Measure {
  place,       // distance of the centre of mass from where it should be [m]
  orientation  // angle of the body from where it should be [rad]
};

struct Problem {
  std::string name, title, scene;
  bool planar = false;  // all in the plane of x and y; inertias about x and y are free then
  Vec3 gravity{};
  double sleep_after = 0;  // [s] that bodies rest before they sleep; 0: they never do
  double duration = 0;
  Measure measure = Measure::place;
  std::vector<Body> bodies;
  std::vector<Joint> joints;
  std::vector<double> times;                  // at which answers are compared
  std::vector<std::vector<State>> reference;  // at these times, every body
};

class Run {
 public:
  virtual ~Run() = default;
  virtual void advance(double to) = 0;  // may throw if the engine gives up
  virtual void step(double by) = 0;     // likewise
  virtual State state(int body) const = 0;

  // Between two steps: bodies by their place in the problem, joints by their numbers. What acts on a body's centre:
  virtual void strike(int, const Vec3& /*impulse*/) { throw CannotSay("no impulse on a body"); }
  // `now` is the problem with the bodies' present states as its start. False where the engine has no words for it, and
  // has to be made anew.
  virtual bool add(const Problem& /*now*/, const Joint&) { return false; }
  virtual bool remove(int /*joint*/) { return false; }
  virtual bool change(const Problem& now, const Joint& joint) { return remove(joint.number) && add(now, joint); }

  // What a joint carried in the last step [N].
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
  std::string changed;        // every default that it changes, in words; "" if none
  std::string knob;           // "h" [s], or "accuracy"
  std::vector<double> knobs;  // coarse to fine
  std::function<std::unique_ptr<Run>(double knob)> start;
};

struct Engine {
  std::string name;
  std::string version;
  std::string number;   // "double" or "float"
  std::string colour;   // in pictures
  std::string changed;  // the defaults that all its series change
  // Empty if it cannot pose the problem. The problem outlives the series.
  std::function<std::vector<Series>(const Problem&)> series;
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
