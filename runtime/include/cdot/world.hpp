// A World: bodies, joints by name, and step(). Effects (limits, motors, ...) are added by cdot/effects.hpp: a program
// without effects does not link them.
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

#include <cdot/balance.hpp>
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

// An end that a coordinate has passed: of a `limit`, or of another effect's row between ends, as a rope's length.
struct PassedEnd {
  double by = 0;  // [m] or [rad]
  int joint = -1;
  std::string_view effect{};  // as `limit`; valid as long as the World
};

// The row with the smallest pivot of K = L D L^T, as a share of its diagonal. Where it vanishes, K loses rank: the row
// becomes redundant. joint is -1 if no factor is at hand.
struct WeakestRow {
  double share = 1;
  int joint = -1;
  int row = -1;
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

  // The World stores poses relative to this point: floats then keep their resolution far from 0. Arguments and place()
  // stay in world coordinates; pose() is relative to the origin. Call it before the first add_body().
  void set_origin(double x, double y, double z = 0);
  int add_body(const BodyDefinition& definition);  // returns its index: 0, 1, ...
  int ground();                                    // the index of one static body at the origin, made by the first call
  int add_joint(const JointDefinition& definition);
  // Adds a soft `distance` (of rest length 0: a soft `revolute` or `spherical`). Returns its number as a joint.
  int add_spring(const SpringDefinition& definition);
  void set_force(int body, const Wrench& force);
  void on_failure(OnFailure what);  // of step(); stop unless set
  // Replaces all settings, for example by recommended() ones. Throws cdot::Error after the first step.
  void use(const Settings& settings);

  // Joint rows that the present poses or velocities violate by more than the tolerance ([m] or [rad], and /s).
  std::vector<Inconsistency> inconsistencies(double tolerance) const;
  // Ends that the present coordinates have passed by more than the tolerance ([m] or [rad]).
  std::vector<PassedEnd> passed_ends(double tolerance) const;
  // Projects the poses onto C = 0 and the velocities onto Cdot = 0 by the least mass-weighted change. Fails if the
  // joints contradict each other. Refuses to move bodies far for a small error: see ProjectResult.
  ProjectResult project(double tolerance);
  const std::vector<Note>& notes() const;
  // Analyses islands and sparsity patterns now. The next step() then allocates nothing.
  void prepare();

  // --- running: step() never throws and, once prepared, never allocates ---

  // With Settings::local_error the method chooses its own steps. If time + h lies inside such a step, the state is the
  // method's interpolant, projected onto the joints. Short h therefore cost no extra steps.
  //
  // A step that fails restores the World's State to the bit; the result gives the reason.
  StepResult step(double h);

  // The joint's bodies are free of it from the next step on. That step analyses the islands again. The joint's number
  // is not reused.
  void remove_joint(int joint);
  // Changes the named parameters of a joint; the others keep their numbers. The next step projects the bodies onto the
  // new C = 0. It keeps their velocities except for the part that violates J v = 0. A length that changes at a given
  // rate belongs in the joint's spec as a function of t. Throws cdot::Error and changes nothing if add_joint() would
  // refuse the numbers.
  void set_parameters(int joint, const std::vector<NamedValue>& parameters);

  // Each of these wakes the body's island.
  void set_pose(int body, const Place& place);
  void set_velocity(int body, const typename S::Exact::Velocity& velocity);
  void apply_impulse(int body, const typename S::Exact::Velocity& impulse);

  // --- going back ---

  // The complete state: a run that continues from a snapshot has the same bits as one without a break. Prepares the
  // World.
  Snapshot snapshot() const;
  // Writes into an existing snapshot; allocates nothing if that was a snapshot of this World.
  void snapshot_into(Snapshot& snapshot) const;
  // The snapshot must be of this World, or of a World built by the same calls in the same order. Otherwise throws
  // cdot::Error and changes nothing.
  void restore(const Snapshot& snapshot);

  // --- looking ---

  double time() const;
  const Settings& settings() const;

  int body_count() const;
  typename S::Pose pose(int body) const;  // relative to set_origin()
  Place place(int body) const;            // the same in world coordinates, in doubles
  typename S::Velocity velocity(int body) const;
  typename S::InverseMass inverse_mass(int body) const;
  bool is_static(int body) const;
  bool asleep(int body) const;

  int joint_count() const;
  const JointType& joint_type(int joint) const;
  std::vector<int> joint_bodies(int joint) const;
  // All numbers of Parameters<T>, given or defaulted, laid out by ParameterInfo::offset; units have length 1.
  std::vector<double> joint_parameters(int joint) const;
  bool broken(int joint) const;                         // or removed
  std::vector<double> position_error(int joint) const;  // C
  std::vector<double> velocity_error(int joint) const;  // Cdot = J v + dC/dt
  std::vector<double> impulse(int joint) const;         // lambda of the last (sub)step [N s, N m s]
  // Force and torque of a joint on a body in the last step.
  Wrench reaction(int joint, int body) const;
  // Value of a free coordinate [m, rad]. An angle in space lies within (-pi, pi]; under an effect whole turns count.
  double coordinate(int joint, std::string_view name) const;
  double coordinate_rate(int joint, std::string_view name) const;  // and its rate

  // Over all joints that are neither soft nor broken; inequality rows count only if C < 0.
  WorstError worst_position_error() const;
  // The end that is passed the farthest; by = 0 and joint = -1 if none is.
  PassedEnd worst_passed_end() const;
  // At the present poses; inequality rows do not count.
  WorstError worst_velocity_error() const;
  // Kinetic energy + potential of gravity and constant forces (0 at each body's first pose) + springs, soft joints
  // included. A constant torque has a potential in the plane. In space it has none: its work is taken along the
  // shortest rotation from the first pose.
  double energy() const;
  // The energy since the first step against the work done, and the momentum of free islands. Always kept; this call
  // costs about as much as energy().
  Balance balance() const;
  // The same work by who did it, without those who did none; the sum is Balance::put_in - taken.
  std::vector<WorkOfSource> work_by_source() const;
  // Rows that the direct solver found redundant in its last factorisation.
  int redundant_rows() const;
  // The weakest row of that factorisation.
  WeakestRow weakest_row() const;
  // Counts of rk4, dop853 and radau5 since the World was made.
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
