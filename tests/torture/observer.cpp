#include "tests/torture/observer.hpp"

#include <Eigen/Eigenvalues>

namespace cdot::torture {
namespace {

// h |M^-1 F| in the metric of the masses: gravity and the constant forces.
double pushed_by_forces(const Scene& scene) {
  const Settings& s = scene.settings;
  double sum = 0;
  for (const SceneBody& body : scene.bodies) {
    const bool planar = scene.dimension == Dimension::planar;
    const BodyDefinition& p = body.definition;
    const SpatialBodyDefinition& q = body.spatial;
    const double mass = planar ? p.mass : q.mass, inertia = planar ? p.inertia : 0;
    if (body.is_static) continue;
    const double x = s.gravity_x + (planar ? p.force_x : q.force_x) / mass;
    const double y = s.gravity_y + (planar ? p.force_y : q.force_y) / mass;
    const double z = s.gravity_z + (planar ? 0 : q.force_z / mass);
    sum += mass * (x * x + y * y + z * z) + (inertia > 0 ? p.torque * p.torque / inertia : 0);
  }
  return scene.step / s.substeps * std::sqrt(sum);
}

// D with rotations scaled by a length, each row scaled to 1.
Eigen::MatrixXd unit_rows(const SystemMatrix& system, double length) {
  const int lengths = system.freedom == 3 ? 2 : 3;
  Eigen::MatrixXd D(system.rows, system.columns);
  for (int r = 0; r < system.rows; ++r) {
    for (int c = 0; c < system.columns; ++c)
      D(r, c) = system.frozen[static_cast<std::size_t>(c)]
                    ? 0
                    : system.entry(r, c) / (c % system.freedom < lengths ? 1 : length);
    const double size = D.row(r).norm();
    if (size > 0) D.row(r) /= size;
  }
  return D;
}

// Of K with its diagonal scaled to 1.
Eigen::VectorXd eigenvalues_of_unit_K(const SystemMatrix& system) {
  const int n = system.rows;
  const auto k = [&](int r, int c) { return system.K[static_cast<std::size_t>(r * n + c)]; };
  Eigen::MatrixXd K(n, n);
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; ++c) {
      const double size = std::sqrt(k(r, r) * k(c, c));
      K(r, c) = size > 0 ? k(r, c) / size : 0;
    }
  return K.selfadjointView<Eigen::Lower>().eigenvalues();
}

bool has_velocity_rows(const Scene& scene) {
  return std::any_of(scene.joints.begin(), scene.joints.end(), [&](const SceneJoint& joint) {
    const auto& kinds = find_joint_type(scene.dimension, joint.definition.type)->row_kinds;
    return std::count(kinds.begin(), kinds.end(), RowKind::velocity) > 0;
  });
}

}  // namespace

double independence(const SystemMatrix& system, double round_off) {
  if (system.rows == 0 || system.columns == 0) return 1;
  double least = 1;
  for (const double value : eigenvalues_of_unit_K(system))
    if (value > system.rows * round_off) least = std::min(least, value);
  return std::sqrt(least);
}

int rows_told_apart(const SystemMatrix& system, double told) {
  if (system.rows == 0 || system.columns == 0) return 0;
  return static_cast<int>((eigenvalues_of_unit_K(system).array() > told).count());
}

double speed_across(const SystemMatrix& system, const std::vector<double>& v, const std::vector<char>& counts) {
  const auto k = [&](int r, int c) { return system.K[static_cast<std::size_t>(r * system.rows + c)]; };
  std::vector<int> rows;
  for (int r = 0; r < system.rows; ++r)
    if (counts[static_cast<std::size_t>(r)] && k(r, r) > 0) rows.push_back(r);
  const auto n = static_cast<Eigen::Index>(rows.size());
  if (n == 0) return 0;
  Eigen::MatrixXd K(n, n);
  Eigen::VectorXd e = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const int r = rows[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j < n; ++j) {
      const int c = rows[static_cast<std::size_t>(j)];
      K(i, j) = k(r, c) / std::sqrt(k(r, r) * k(c, c));
    }
    for (int c = 0; c < system.columns; ++c) e(i) += system.entry(r, c) * v[static_cast<std::size_t>(c)];
    e(i) /= std::sqrt(k(r, r));
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(K);
  double sum = 0;
  for (Eigen::Index i = 0; i < n; ++i)
    if (solver.eigenvalues()(i) > 1e-10)
      sum += std::pow(solver.eigenvectors().col(i).dot(e), 2) / solver.eigenvalues()(i);
  return std::sqrt(sum);
}

double turned(const SystemMatrix& before, const SystemMatrix& after, double length) {
  if (after.rows == 0 || before.rows != after.rows || after.columns == 0) return 0;
  return (unit_rows(after, length) - unit_rows(before, length)).rowwise().norm().maxCoeff();
}

Accounts::Accounts(const Motion& start, std::vector<SpringRow> springs, double energy, const Scene& scene,
                   double length, double epsilon, double across)
    : order_(order_of(scene.settings)),
      epsilon_(epsilon),
      start_energy_(energy),
      local_error_(scene.settings.local_error),
      rolls_(has_velocity_rows(scene)),
      constant_(pushed_by_forces(scene)),
      pushed_(constant_),
      step_(scene.step),
      substep_(scene.step / scene.settings.substeps),
      springs_(std::move(springs)),
      farthest_(length),
      last_(start),
      across_(across) {}

// The torques that a first-order step leaves: it corrects the poses by d, x1 = x0 + h v1 + d, at their velocities, and
// the impulses of the correction, d / h, act at the end of the step along the directions of its start. A body has moved
// by h v and turned by h w since then: d x m v + h v x m dv + h w x dL.
double torques_of_corrections(const Motion& before, const Motion& now, double h) {
  double sum = 0;
  for (std::size_t i = 0; i < now.bodies.size(); ++i) {
    const BodyMotion &was = before.bodies[i], &is = now.bodies[i];
    std::array<double, 3> d, dv, dL;
    for (std::size_t k = 0; k < 3; ++k) {
      d[k] = is.x[k] - was.x[k] - h * is.v[k];
      dv[k] = is.v[k] - was.v[k], dL[k] = is.spin[k] - was.spin[k];
    }
    sum += is.mass * norm(is.v) * (norm(d) + h * norm(dv)) + h * norm(is.w) * norm(dL);
  }
  return sum;
}

// A first-order step kicks and corrects, then projects: both changes, which may oppose each other.
double parts_of_change(const Motion& before, const Motion& now, const VelocityChange& d, double h) {
  const VelocityChange first = change_to_mean(before, now, h);
  return std::sqrt(square(now, first)) + std::sqrt(square(now, d, first));
}

// [J], and relative to twice the kinetic energy in the angular momentum.
void Accounts::add_error(const Motion& now, double energy) {
  order_error_ += energy;
  if (largest_speed_ > 0) angular_order_ += now.angular_size * energy / (largest_speed_ * largest_speed_);
}

void Accounts::add_round_off(const Motion& now, double operations) {
  for (const BodyMotion& body : now.bodies) farthest_ = std::max(farthest_, norm(body.x));
  // Positions and arms are rounded too: forces do work on the rounding errors, and velocities correct them.
  round_off_ += operations * epsilon_ *
                (largest_energy_ + pushed_ / step_ * now.root_mass * farthest_ +
                 epsilon_ * now.root_mass * now.root_mass * farthest_ * farthest_ / (step_ * step_));
  momentum_ += operations * epsilon_ * now.linear_size;
  angular_ += operations * epsilon_ * now.angular_size;
}

// The errors of springs in a step. A stretch, and a stiffness, may wave more quickly than the bodies move: the change
// of the rate in the step counts relative to the largest so far, if that is larger.
std::vector<Accounts::Missed> Accounts::work_missed(const std::vector<SpringRow>& springs, double dv) {
  largest_rates_.resize(springs.size(), 0);
  std::vector<Missed> all;
  for (std::size_t k = 0; k < springs.size(); ++k) {
    const SpringRow &s = springs_[k], &e = springs[k];
    largest_rates_[k] = std::max({largest_rates_[k], std::abs(s.rate), std::abs(e.rate)});
    const double bend = largest_rates_[k] > 0 ? std::abs(e.rate - s.rate) / largest_rates_[k] : 0;
    all.push_back({missed_work(s, e, step_, dv), std::max(bend, stiffened(s, e))});
  }
  return all;
}

// Each further order is one more derivative, a factor `rough`, or the spring's own.
double Accounts::by_order(const std::vector<Missed>& all, double rough) const {
  double sum = 0;
  for (const Missed& of : all) sum += of.work * std::pow(std::max(rough, of.rough), order_ - 1);
  return sum;
}

// Of the power P that numbers in time put in, h |change of P|, and for each further order a factor `rough`, or that of
// P. The first step counts as the second.
double Accounts::missed_by_numbers_in_time(double put_in, double h, double rough) {
  const double power = (put_in - put_in_) / h, change = std::abs(power - power_);
  put_in_ = put_in, power_ = power, most_power_ = std::max(most_power_, std::abs(power));
  if (!change_ || most_power_ == 0) return 0;
  return (pending_ > 0 ? 2 : 1) * h * change * std::pow(std::max(rough, change / most_power_), order_ - 1);
}

// Per step: (|dv| (|dv| + |h F|) + missed_work) rho^(p-1), where rho is the change of acceleration in a step relative
// to the largest so far. dv does not show joint forces against the turning of a tensor, so the larger dv, with or
// without that turning, counts.
void Accounts::step(const Motion& now, std::vector<SpringRow> springs, double energy, double operations,
                    long long taken, double h, AtJoints joints) {
  const VelocityChange d = change(last_, now);
  pushed_ = std::max(pushed_, constant_ + push_of(springs, substep_));
  for (const SpringRow& spring : springs_)
    fastest_ =
        std::max(fastest_,
                 std::sqrt(spring.mass * (order_ > 1 ? std::abs(spring.stiffness) : std::max(0.0, -spring.stiffness))));
  const double size = std::sqrt(square(now, d));
  const double done = std::max(
      {size, std::sqrt(square(now, d, turning(last_, step_))), order_ == 1 ? parts_of_change(last_, now, d, h) : 0});
  const double first_order = done * (done + pushed_), across = joints.left_across;
  largest_change_ = std::max(largest_change_, size);
  largest_speed_ = std::max(largest_speed_, std::sqrt(2 * now.kinetic));
  largest_energy_ = std::max({largest_energy_, now.kinetic, std::abs(energy - start_energy_)});
  add_error(now, (size + step_ / substep_ * pushed_) * (across_ + across) / 2);
  if (!change_) roughest_ = largest_speed_ > 0 ? size / largest_speed_ : 0;
  if (change_) {
    const double noise = 1000 * epsilon_ * largest_speed_;
    const double rough = largest_change_ > noise ? std::sqrt(square(now, d, *change_)) / largest_change_ : 0;
    const double most = std::max(rough, rough_before_), rho = std::pow(most, order_ - 1);
    add_error(now, (first_order + pending_) * rho + by_order(pending_springs_, most) +
                       by_order(work_missed(springs, size), most));
    driven_error_ += (joints.kicks * done + pending_drives_) * rho;
    driven_error_ += missed_by_numbers_in_time(joints.put_in, h, most);
    roughest_ = std::max(roughest_, rough);
    rough_before_ = rough;
    pending_ = pending_drives_ = 0, pending_springs_.clear();
  } else {
    pending_ = first_order, pending_drives_ = joints.kicks * done, pending_springs_ = work_missed(springs, size);
    missed_by_numbers_in_time(joints.put_in, h, 0);
  }
  // An error of local_error in every pose and velocity, at the end of each step taken.
  add_error(now, double(taken - taken_) * local_error_ *
                     (now.linear_size + now.spin_size + largest_change_ / step_ * now.root_mass));
  if (order_ == 1) angular_order_ += torques_of_corrections(last_, now, h);
  add_round_off(now, operations);
  change_ = d, across_ = across;
  springs_ = std::move(springs);
  last_ = now;
  taken_ = taken;
}

}  // namespace cdot::torture
