// Observes the steps of a World and sums the terms of the bounds.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <cdot/jacobian.hpp>

#include "tests/methods.hpp"
#include "tests/torture/draw/in_time.hpp"
#include "tests/torture/invariants.hpp"
#include "tests/torture/laws.hpp"
#include "tests/torture/motion.hpp"
#include "tests/torture/springs.hpp"

namespace cdot::torture {

// Of the method that takes the steps: where `implicit` does not take the midpoint rule, it is Euler's.
inline double order_of(const Settings& s) {
  const bool is_euler = s.integrator == Integrator::implicit && !takes_midpoint(s);
  return test::order_of(is_euler ? Integrator::euler : s.integrator);
}

struct RowSize {
  double value;      // |J| of a displacement by the mechanism's size and of a rotation by one radian
  double round_off;  // of C, where rotations alone change it: it is of unit vectors, however small J is near a pole
};

struct RowSizes {
  std::vector<std::vector<RowSize>> of_joint;
  double length = 1;  // of the mechanism: the longest distance between two bodies, or arm of a joint
};

template <class S>
RowSizes row_sizes(BasicWorld<S>& world) {
  const SystemMatrix D = system_matrix(world);
  constexpr int lengths = S::dimension == Dimension::planar ? 2 : 3;
  const auto place = [&](int k) { return motion_of(world.pose(k), world.velocity(k), world.inverse_mass(k)).x; };
  RowSizes sizes;
  double longest = 0;
  for (const int a : D.bodies)
    for (const int b : D.bodies) {
      const auto p = place(a), q = place(b);
      longest = std::max(longest, norm({p[0] - q[0], p[1] - q[1], p[2] - q[2]}));
    }
  std::vector<std::array<double, 2>> rows;  // |J| of lengths and of rotations
  for (int r = 0; r < D.rows; ++r) {
    double straight = 0, turning = 0;
    for (int c = 0; c < D.columns; ++c) {
      const double x = D.entry(r, c);
      (c % D.freedom < lengths ? straight : turning) += x * x;
    }
    rows.push_back({std::sqrt(straight), std::sqrt(turning)});
    if (straight > 0) longest = std::max(longest, std::sqrt(turning / straight));
  }
  sizes.length = longest > 0 ? longest : 1;
  sizes.of_joint.resize(static_cast<std::size_t>(world.joint_count()));
  constexpr double of_units = 4 * std::numeric_limits<typename S::Scalar>::epsilon();
  for (const SystemMatrix::Joint& joint : D.joints)
    for (int r = joint.first; r < joint.first + joint.rows; ++r) {
      const auto [straight, turning] = rows[static_cast<std::size_t>(r)];
      sizes.of_joint[static_cast<std::size_t>(joint.joint)].push_back(
          {std::hypot(straight * sizes.length, turning), straight > 0 ? 0 : of_units});
    }
  return sizes;
}

// A measure of the rows' independence in the metric of the masses: the root of the least eigenvalue above round-off of
// K, with the diagonal of K scaled to 1. A small value means a pose near a singular one.
double independence(const SystemMatrix& system, double round_off);
// How many such eigenvalues are above `told`. D may have a larger rank: light bodies between heavy ones hide its rows.
int rows_told_apart(const SystemMatrix& system, double told);
// The largest change of a unit row between two matrices; 2 if a row reversed.
double turned(const SystemMatrix& before, const SystemMatrix& after, double length);

// The largest C as a share of its row's size, and its joint. Inequality rows count beyond `slack`, also a share.
struct Gap {
  double share = 0;
  int joint = -1;
};

template <class S>
Gap gap_of(const BasicWorld<S>& world, const Scene& scene, const RowSizes& sizes, double slack = 0) {
  Gap gap;
  for (int j = 0; j < static_cast<int>(scene.joints.size()); ++j) {
    const auto& size = sizes.of_joint[static_cast<std::size_t>(j)];
    if (size.empty() || world.broken(j) || world.joint_type(j).is_effect ||
        scene.joints[static_cast<std::size_t>(j)].definition.soft)
      continue;
    const std::vector<double> C = world.position_error(j);
    const auto& kinds = world.joint_type(j).row_kinds;
    for (std::size_t r = 0; r < C.size(); ++r) {
      const bool one_sided = kinds[r] == RowKind::inequality;
      if (one_sided && C[r] > -slack * size[r].value) continue;
      const double share = (std::abs(C[r]) - size[r].round_off) / size[r].value - (one_sided ? slack : 0);
      if (std::isnan(share)) return {share, j};
      if (share > gap.share) gap = {share, j};
    }
  }
  return gap;
}

// Round-off of poses in C, as a share of what a displacement by `length` and a turn of 1 rad make of it: places and
// angles of two bodies are off by half a unit in the last place each, and as much again in the arms.
template <class S>
double round_off_of_poses(const BasicWorld<S>& world, double length) {
  double farthest = 0;
  for (int body = 0; body < world.body_count(); ++body) {
    const auto q = world.place(body);
    if constexpr (S::dimension == Dimension::planar)
      farthest = std::max(farthest, std::hypot(q.x, q.y) / length + std::abs(q.angle));
    else farthest = std::max(farthest, std::hypot(q.x, q.y, q.z) / length);
  }
  return 2 * std::numeric_limits<typename S::Scalar>::epsilon() * farthest;
}

// The speed across the rows marked in `counts`, in the metric of the masses: sqrt((J v)' K^-1 (J v)). v: by column.
double speed_across(const SystemMatrix& system, const std::vector<double>& v, const std::vector<char>& counts);

// The same, across all joints but soft, broken and slack ones.
template <class S>
double speed_across(BasicWorld<S>& world, const Scene& scene) {
  const SystemMatrix system = system_matrix(world);
  std::vector<char> counts(static_cast<std::size_t>(system.rows), 1);
  for (const SystemMatrix::Joint& joint : system.joints) {
    const JointType& type = world.joint_type(joint.joint);
    const auto j = static_cast<std::size_t>(joint.joint);  // springs between points follow
    const bool hard = j < scene.joints.size() && !type.is_effect && !scene.joints[j].definition.soft;
    const std::vector<double> C = world.position_error(joint.joint);
    for (std::size_t r = 0; r < static_cast<std::size_t>(joint.rows); ++r)
      if (!hard || (type.row_kinds[r] == RowKind::inequality && C[r] > 0))
        counts[static_cast<std::size_t>(joint.first) + r] = 0;
  }
  std::vector<double> v;
  for (const int body : system.bodies) {
    const BodyMotion is = motion_of(world.pose(body), world.velocity(body), world.inverse_mass(body));
    if (S::dimension == Dimension::planar) v.insert(v.end(), {is.v[0], is.v[1], is.w[2]});
    else v.insert(v.end(), {is.v[0], is.v[1], is.v[2], is.w[0], is.w[1], is.w[2]});
  }
  return speed_across(system, v, counts);
}

// The same, where steps leave it and do not pay for the work along it: with the direct solver, Baumgarte's correction.
template <class S>
double speed_left_across(BasicWorld<S>& world, const Scene& scene) {
  const bool paid = scene.settings.solver == Solver::iterative || scene.settings.drift == Drift::projection;
  return paid ? 0 : speed_across(world, scene);
}

// Sum |lambda| |M^-1 J'| of the exact rows over a step, in the metric of the masses, where time drives some of them.
template <class S>
double kicks_of_joints(BasicWorld<S>& world, const Scene& scene) {
  const auto exact = [&](int joint) {
    const auto j = static_cast<std::size_t>(joint);  // springs between points follow
    return j < scene.joints.size() && !world.joint_type(joint).is_effect && !scene.joints[j].definition.soft;
  };
  double sum = 0;
  bool driven = false;
  for (int joint = 0; joint < world.joint_count(); ++joint)
    driven |= exact(joint) &&
              (world.joint_type(joint).explicit_time || moves_in_time(scene.joints[static_cast<std::size_t>(joint)]));
  if (!driven) return 0;
  const SystemMatrix system = system_matrix(world);
  for (const SystemMatrix::Joint& joint : system.joints) {
    if (!exact(joint.joint)) continue;
    const std::vector<double> impulse = world.impulse(joint.joint);
    for (int r = 0; r < joint.rows; ++r)
      sum += std::abs(impulse[static_cast<std::size_t>(r)]) *
             std::sqrt(system.K[static_cast<std::size_t>((joint.first + r) * (system.rows + 1))]);
  }
  return scene.settings.substeps * sum;
}

struct AtJoints {
  double left_across, kicks;  // speed_left_across(), kicks_of_joints()
  double put_in;              // Balance::put_in, where numbers follow functions of time
};

// The bounds of energy and angular momentum after the steps so far; see README.md.
class Accounts {
 public:
  // `length`: of the mechanism, with the arms of its joints.
  Accounts(const Motion& start, std::vector<SpringRow> springs, double energy, const Scene& scene, double length,
           double epsilon, double across);

  // `taken`: adaptive steps so far; h: the length of the step.
  // `joints`: at its end.
  void step(const Motion& now, std::vector<SpringRow> springs, double energy, double operations, long long taken,
            double h, AtJoints joints);

  // For RATTLE plus the distance to the energy that its steps conserve, h^2 (v'V''v / 12 - F'M^-1 F / 24). The force
  // of a velocity row has no V: in the last half kick it does the work h^2 lambda (dJ/dt) v / 8, which the first half
  // kick of the next step takes back. Beside other joints it has either sign, and that of the start counts too.
  double order_error() const {  // [J]
    const double away = largest_change_ + pushed_;
    return order_error_ + (order_ == 2 ? away * away * (rolls_ ? 7.0 / 24 : 1.0 / 8) : 0);
  }
  // The balance knows what time puts in by some joints [J]. Others may act against them, and dv does not show that.
  double error_of_drives() const { return driven_error_; }
  double round_off_energy() const { return round_off_; }  // [J]
  double roughest() const { return roughest_; }           // the largest change of acceleration in a step, relative
  // [1/s]: the largest rate at which a force turns round or, where springs are implicit, grows as bodies approach.
  double fastest() const { return fastest_; }
  double momentum_round_off() const { return momentum_; }  // [kg m/s]
  double angular_round_off() const { return angular_; }    // [kg m^2/s]
  double angular_order_error() const { return angular_order_; }

 private:
  void add_error(const Motion& now, double energy);
  double missed_by_numbers_in_time(double put_in, double h, double rough);
  // The work of a spring that a first-order step may miss, and the relative change of its rate or its stiffness.
  struct Missed {
    double work, rough;
  };
  std::vector<Missed> work_missed(const std::vector<SpringRow>& springs, double dv);
  double by_order(const std::vector<Missed>& all, double rough) const;
  void add_round_off(const Motion& now, double operations);

  double order_, epsilon_, start_energy_, local_error_;
  bool rolls_;                // it has velocity rows
  double constant_, pushed_;  // what the constant forces, and springs as well, add to the velocities in a step, in the
                              // metric of the masses
  double step_, substep_;
  std::vector<SpringRow> springs_;
  std::vector<double> largest_rates_;  // of the springs
  double farthest_;                    // from the origin, or the longest arm [m]
  long long taken_ = 0;
  Motion last_;
  double across_;
  std::optional<VelocityChange> change_;
  std::vector<Missed> pending_springs_;  // of the first step, as pending_
  double rough_before_ = 0, pending_ = 0, pending_drives_ = 0, driven_error_ = 0, put_in_ = 0, power_ = 0,
         most_power_ = 0, largest_change_ = 0, largest_speed_ = 0, largest_energy_ = 0;
  double fastest_ = 0, order_error_ = 0, round_off_ = 0, roughest_ = 0, momentum_ = 0, angular_ = 0, angular_order_ = 0;
};

}  // namespace cdot::torture
