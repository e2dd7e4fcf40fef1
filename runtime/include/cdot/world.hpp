// A World: bodies, joints by name, and step(). What a scene asks for beyond joints (limits, motors, ...) is added by
// runtime/include/cdot/effects.hpp, so that a program which never asks does not even link it.
//
//   cdot::World<double> world(settings);
//   int rod = world.add_body({.x = 1, .mass = 1, .inertia = 0.1});
//   world.add_joint({.type = "revolute",
//                    .bodies = {world.ground(), rod},
//                    .parameters = {{"pa", {0, 0}}, {"pb", {-1, 0}}},
//                    .soft = {}});
//   world.step(1.0 / 60);
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <cdot/joints.hpp>
#include <cdot/kernel.hpp>
#include <cdot/planar.hpp>
#include <cdot/settings.hpp>
#include <cdot/snapshot.hpp>
#include <cdot/spaces.hpp>
#include <cdot/step_counts.hpp>
#include <cdot/step_result.hpp>

namespace cdot {

template <class S>
struct WorldData;

// The largest entry of C or Cdot over all joints; joint is -1 in a World without joints.
struct WorstError {
  double value = 0;  // its absolute value
  int joint = -1;
  int row = -1;
};

// One row that the state violates (an inequality only if C < 0).
struct Inconsistency {
  int joint;
  int row;
  bool velocity;  // false: C is off; true: Cdot is off
  double value;
};

// S is a space: Planar<double>, Planar<float>, Spatial<double>, Spatial<float>; of long double: see cdot/spaces.hpp.
template <class S>
class BasicWorld {
 public:
  using T = typename S::Scalar;
  using BodyDefinition = typename S::BodyDefinition;
  using Place = typename S::Place;    // in the plane {x, y, angle}, in space {x, y, z, e0, e1, e2, e3}
  using Wrench = typename S::Wrench;  // force [N] and torque about the centre of mass [N m]

  explicit BasicWorld(const Settings& settings = {});
  ~BasicWorld();
  BasicWorld(BasicWorld&&) noexcept;
  BasicWorld& operator=(BasicWorld&&) noexcept;

  // --- setting up: throws cdot::Error, may allocate ---

  // Poses are counted from here inside: a World of floats far from 0 keeps its resolution. What is handed in and
  // place() stay in the world's coordinates, pose() does not. Only before there are bodies.
  void set_origin(double x, double y, double z = 0);
  int add_body(const BodyDefinition& definition);  // returns its index: 0, 1, ...
  int ground();  // the index of one static body at the origin, made when first asked for
  int add_joint(const JointDefinition& definition);
  int add_spring(const SpringDefinition& definition);
  void set_force(int body, const Wrench& force);
  void on_failure(OnFailure what);  // of step(); stop unless set

  // Rows of joints that the present pose or velocity violates by more than the tolerance ([m] or
  // [rad], and /s).
  std::vector<Inconsistency> inconsistencies(double tolerance) const;
  // Moves the bodies onto C = 0 and their velocities onto Cdot = 0 by the least mass-weighted
  // change. False if that did not succeed: the joints contradict each other.
  bool project(double tolerance);
  const std::vector<Note>& notes() const;
  // Analyses islands and patterns now rather than in the next step(), which then does not allocate.
  void prepare();

  // --- running: step() never throws and, once prepared, never allocates ---

  // With Settings::local_error the state at its end may lie between the ends of a step that the method chose: by the
  // method's interpolant, brought back onto the joints. Asking often then costs no steps.
  //
  // A step that fails leaves the State of the World as it was, to the bit, and says so.
  StepResult step(double h);

  // What it held together is free of it from the next step on, which analyses islands anew. Its number stays taken.
  void remove_joint(int joint);
  // These parameters of a joint get other numbers, the rest keeps its own: from the next step on, which moves the
  // bodies to where C = 0 now is and leaves their velocities, but for what J v = 0 takes of them. A length that shall
  // change with a velocity belongs into the joint's spec, as a function of t. Throws cdot::Error and changes nothing
  // where add_joint() would not take them.
  void set_parameters(int joint, const std::vector<NamedValue>& parameters);

  // Each of these wakes the body's island.
  void set_pose(int body, const Place& place);
  void set_velocity(int body, const typename S::Exact::Velocity& velocity);
  void apply_impulse(int body, const typename S::Exact::Velocity& impulse);

  // --- going back ---

  // All that a run depends on: one that goes on from it has the same bits. Prepares the World.
  Snapshot snapshot() const;
  // The same into one at hand: without allocation once it has been a snapshot of this World.
  void snapshot_into(Snapshot& snapshot) const;
  // Of this World, or of one to which the same was added in the same order. Throws cdot::Error and leaves the World as
  // it is, if it is of another.
  void restore(const Snapshot& snapshot);

  // --- looking ---

  double time() const;
  const Settings& settings() const;

  int body_count() const;
  typename S::Pose pose(int body) const;  // counted from the origin that was set, if one was
  Place place(int body) const;            // the same in doubles, in the world
  typename S::Velocity velocity(int body) const;
  typename S::InverseMass inverse_mass(int body) const;
  bool is_static(int body) const;
  bool asleep(int body) const;

  int joint_count() const;
  const JointType& joint_type(int joint) const;
  std::vector<int> joint_bodies(int joint) const;
  // All numbers of Parameters<T>, given or defaulted, units normalised, laid out by
  // ParameterInfo::offset.
  std::vector<double> joint_parameters(int joint) const;
  bool broken(int joint) const;                         // or removed
  std::vector<double> position_error(int joint) const;  // C
  std::vector<double> velocity_error(int joint) const;  // Cdot = J v + dC/dt
  std::vector<double> impulse(int joint) const;         // lambda of the last (sub)step [N s, N m s]
  // What a joint exerted on a body in the last step.
  Wrench reaction(int joint, int body) const;
  // Value of a free coordinate [m, rad]. An angle in space lies within (-pi, pi], unless an effect
  // acts on it: then whole turns count.
  double coordinate(int joint, std::string_view name) const;
  double coordinate_rate(int joint, std::string_view name) const;  // and its rate

  // Over all joints that are neither soft nor broken; an inequality counts where C < 0.
  WorstError worst_position_error() const;
  // At the present poses; inequality rows do not count.
  WorstError worst_velocity_error() const;
  // Kinetic energy + gravity and constant forces (zero where each body was added) + springs, soft
  // joints included. A constant torque has a potential in the plane; in space it has none, and is
  // counted along the shortest turn from the start.
  double energy() const;
  // Rows that the direct solver found to depend on others in its last factorisation.
  int redundant_rows() const;
  // Of rk4 and dop853, since the World was made.
  const StepCounts& step_counts() const;
  int island_count() const;
  int sleeping_islands() const;
  std::uint64_t hash() const;  // of every bit of poses and velocities

  // For runtime/include/cdot/effects.hpp.
  WorldData<S>& data() { return *data_; }

 private:
  std::unique_ptr<WorldData<S>> data_;
};

// T is double or float.
template <class T>
using World = BasicWorld<Planar<T>>;
template <class T>
using SpatialWorld = BasicWorld<Spatial<T>>;

extern template class BasicWorld<Planar<double>>;
extern template class BasicWorld<Planar<float>>;
extern template class BasicWorld<Spatial<double>>;
extern template class BasicWorld<Spatial<float>>;

}  // namespace cdot
