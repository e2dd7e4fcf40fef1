// A scene as plain data: the content of a TOML file, checked, with every name resolved. specs/scenes/README.md explains
// the format. Reading knows joints only by their table (<cdot/joints.hpp>).
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <cdot/effects.hpp>
#include <cdot/settings.hpp>
#include <cdot/world.hpp>

#include "derive/interpret/formula.hpp"
#include "runtime/tool/scene/mistakes.hpp"

namespace cdot {

using Vec3 = std::array<double, 3>;  // in planar scenes its third number is 0

inline constexpr int world_body = -1;  // index of "world" in a scene

// The picture of a body, and its inertia by uniform density if none is given.
struct Shape {
  enum Kind { none, rod, box, disc, ball } kind = none;
  double length = 0,
         width = 0;  // along and across the body's x axis [m]; of a disc the length is the diameter
  double depth = 0;  // along the body's z axis, in space: of a box, and the thickness of a disc
};

// Pose and velocity at the start, where joints start by their coordinates.
template <class S>
struct BodyStart {
  typename S::Place place{};
  typename S::Velocity velocity{};
};

struct SceneBody {
  std::string name;
  BodyDefinition definition;      // of a planar scene, as written
  SpatialBodyDefinition spatial;  // of a scene in space, likewise
  bool started = false;           // one of these replaces the written pose and velocity:
  BodyStart<Planar<double>> planar_start;
  BodyStart<Spatial<double>> spatial_start;
  bool is_static = false;  // of either
  // A force or a torque that follows functions of time; find_forces_in_time() makes effects of them.
  std::optional<NamedValue> force_in_time, torque_in_time;
  Shape shape;
  std::vector<Vec3> traces;  // points of the body whose paths the viewer draws
};

// Of its centre of mass at the start.
Vec3 position_of(const SceneBody& body, Dimension dimension);

// The value [m, rad] and rate of a free coordinate at the start.
struct CoordinateStart {
  std::string coordinate;
  std::optional<double> value, rate;
  Span where;
};

struct SceneJoint {
  std::string name;
  JointDefinition definition;  // its bodies are indices into Scene::bodies, or world_body
  std::vector<CoordinateEffects> effects;
  std::vector<SpecEffect> bonds{};  // effects on the joint itself, as `breaking`
  Span where;                       // its header in the file
  std::vector<CoordinateStart> starts;
};

struct SceneSpring : SpringDefinition {
  Span where{};  // its header in the file
};

// A quantity of a run that an expression reads.
struct Measured {
  enum What {
    energy,
    kinetic,
    coordinate,
    rate,
    effects,              // force or torque of all effects on a coordinate, or of one
    power,                // that force times the rate
    given,                // power of a joint or of an effect between bodies: that of its forces on all of them
    force,                // of the joint on its last body
    torque,               // likewise, about the centre of mass
    acceleration,         // of a body: the change of its velocity in the last step by its length
    angular_acceleration  // likewise
  } what = energy;
  int joint = -1;  // of an acceleration, the body
  std::string coordinate_name{};
  std::string effect{};  // the type of the only one that counts; empty: all
};

// All that an expression may measure, and the words for it.
struct Measurable {
  Vocabulary words;
  std::vector<Measured> measured;  // as words.quantities

  void add(std::string name, std::string unit, Measured what, bool vector = false) {
    words.quantities.push_back({std::move(name), std::move(unit), vector});
    measured.push_back(std::move(what));
  }
};

// An expression that a run evaluates: a column of the output.
struct Sensor {
  std::string name, unit;  // the unit as people write it: "N", "W"
  Formula formula;
  std::vector<Measured> measured;  // by input of the formula; unused for time and the numbers of bodies
};

// A function of time as a scene has written it: an expression in a unit, or the rows of a table.
struct WrittenProfile {
  Profile profile;
  std::string text, unit;
  ProfileTable table;
};

inline constexpr double default_step = 0.001;      // [s] of a scene that names a method without a step
inline constexpr double default_accuracy = 1e-4;   // of a mechanism's size, and [rad]: of a scene that names no method
inline constexpr int intervals_of_own_steps = 64;  // of a run whose method chooses its steps: Scene::step is one

struct Scene {
  std::string file, title;
  Dimension dimension = Dimension::planar;
  Settings settings;
  bool names_integrator = true;            // false: see runtime/tool/run/pick_integrator.hpp
  std::string why_integrator;              // why it was picked
  std::optional<Drift> drift;              // as named; settle_drift() puts it, or the usual one, into the settings
  bool single = false;                     // computed in float
  double duration = 10;                    // [s]
  double step = default_step;              // [s]; 0: no method is named, an accuracy chooses it
  bool step_by_options = false;            // it follows from the method that options name, and from the duration
  double accuracy = 0;                     // [m], [rad] that the run chooses a method for; 0: see chooses_method()
  double tolerance = 0.01;                 // [m], [rad] joint error above which a run has failed
  double energy_tolerance = 0.1;           // share of the energies that the method may lose
  double trajectory_tolerance = 0;         // share of sizes and [rad] of the trajectory's estimated error; 0: none
  OnFailure on_failure = OnFailure::stop;  // of a step
  bool project = false;                    // project an inconsistent start onto C = 0
  std::vector<SceneBody> bodies;
  std::vector<SceneJoint> joints;
  std::vector<SceneSpring> springs;
  std::vector<Sensor> sensors;
  std::vector<WrittenProfile> profiles;    // the functions of time that its numbers follow
  std::vector<std::string> inputs;         // numbers that a compiled step may change: "hinge.angle.motor.speed"
  std::shared_ptr<const Mistakes> source;  // to report errors of the World in its lines
};

// That of a profile which the scene has written; null: of none.
const WrittenProfile* written_profile(const Scene& scene, const Profile& profile);  // tool/scene/profile.cpp

// Of the bodies and joints that it has so far.
Measurable measurable_of(const Scene& scene);

// Of a scene that names a method without a step [s]. With a local error the step is only the interval between outputs.
inline double usual_step(double duration, bool own_steps) {
  return own_steps ? duration / intervals_of_own_steps : default_step;
}
// True if the run finds its method: for Scene::accuracy, or for default_accuracy if that is 0.
inline bool chooses_method(const Scene& scene) { return scene.accuracy > 0 || scene.step == 0; }

// Thrown if a scene has mistakes; what() is the report, a paragraph per mistake.
struct SceneError : std::runtime_error {
  SceneError(const std::string& report, int count) : std::runtime_error(report), mistakes(count) {}
  int mistakes;
};

// Call after a change of the methods.
void settle_drift(Scene& scene);

// The file of a scene by its path or its name: "four_bar", "spatial/four_bar". Names are those of specs/scenes, also
// where it is installed. Throws SceneError if there is none.
std::string file_of_scene(const std::string& scene);
// By its path or its name; "-" is standard input.
Scene read_scene(const std::string& scene);
Scene read_scene(std::string_view text, const std::string& name);

// Body k of the scene is body k of the World. Throws SceneError if the World refuses a part. The scene must have the
// dimension of S.
template <class S>
BasicWorld<S> build_world_in(const Scene& scene);
template <class T>
World<T> build_world(const Scene& scene) {
  return build_world_in<Planar<T>>(scene);
}

// f(space), for the scene's dimension and numbers of type T.
template <class T, class F>
auto in_space_of(const Scene& scene, F f) {
  return scene.dimension == Dimension::planar ? f(Planar<T>{}) : f(Spatial<T>{});
}

// The rows that the start violates and the ends that it passes by more than `tolerance`: a paragraph for each of the
// first few, and the number of the others. Empty if there are none.
template <class S>
std::string inconsistency_report(const Scene& scene, const BasicWorld<S>& world, double tolerance);

// "an end of `limit` of revolute "r"", "an end of tearing_rope "e1"".
std::string end_name(const Scene& scene, const PassedEnd& end);

}  // namespace cdot
