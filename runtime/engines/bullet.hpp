// A joint as a constraint of Bullet 3: a btTypedConstraint that any world of rigid bodies takes by addConstraint().
//
// Points and directions of `parameters` are those of the bodies' frames at their centres of mass, as Bullet's own.
// Rows answer to C by the solver's ERP and CFM, or by a frequency: see `stiffness`. Bullet starts the impulses of
// joints at zero in each step, so there is nothing to warm-start. A breaking impulse, JointFeedback, setEnabled() and
// an own number of iterations work as for any constraint.
#pragma once

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <cdot/kernel.hpp>

#include "runtime/engines/plain.hpp"

namespace cdot::bullet {

inline spatial::Pose<btScalar> pose_of(const btRigidBody& body) {
  const btVector3& x = body.getCenterOfMassPosition();
  const btQuaternion e = body.getOrientation();
  return plain::pose<btScalar>(x.x(), x.y(), x.z(), e.w(), e.x(), e.y(), e.z());
}
inline spatial::Velocity<btScalar> velocity_of(const btVector3& v, const btVector3& w) {
  return {v.x(), v.y(), v.z(), w.x(), w.y(), w.z()};
}
inline spatial::InverseMass<btScalar> inverse_mass_of(const btRigidBody& body) {
  const btMatrix3x3& I = body.getInvInertiaTensorWorld();
  return {body.getInvMass(), I[0][0], I[1][1], I[2][2], I[0][1], I[0][2], I[1][2]};
}

template <class Block, class... Coordinates>
class Constraint : public btTypedConstraint {
  static_assert(Block::bodies <= 2, "a constraint of Bullet joins two bodies");

 public:
  using Parameters = typename Block::template Parameters<btScalar>;

  Parameters parameters;
  plain::Stiffness<btScalar> stiffness;  // hertz: above 0 instead of ERP and CFM
  btScalar time = 0;                     // yours to set before a step, where C depends on time
  plain::Drive<btScalar> drives[sizeof...(Coordinates) + 1];

  explicit Constraint(btRigidBody& a, const Parameters& p) : Constraint(a, getFixedBody(), p) {
    static_assert(Block::bodies == 1, "this joint joins two bodies; btTypedConstraint::getFixedBody() is the world");
  }
  Constraint(btRigidBody& a, btRigidBody& b, const Parameters& p)
      : btTypedConstraint(MAX_CONSTRAINT_TYPE, a, b), parameters(p) {}

  // Sets parameter number `first` (Block::index_of_pb) and those after it to their defaults at the present poses.
  void by_default(int first) {
    const auto q = bodies(&pose_of);
    for (int i = first; i < Block::index_end; ++i) Block::default_value(i, q.of, parameters, time);
  }

  void getInfo1(btConstraintInfo1* info) override {
    info->m_numConstraintRows = Block::rows;
    for (int i = 0; i < int(sizeof...(Coordinates)); ++i) {
      const plain::Drive<btScalar>& d = drives[i];
      info->m_numConstraintRows += d.has_motor() + is_limit(d.lower) + is_limit(d.upper);
    }
    info->nub = 0;
  }

  void getInfo2(btConstraintInfo2* info) override {
    int next = 0;
    write_rows(*info, next);
    int i = 0;
    (write_drive<Coordinates>(*info, i++, next), ...);
  }

  // BT_CONSTRAINT_ERP and BT_CONSTRAINT_CFM of all rows; the axis is ignored.
  void setParam(int number, btScalar value, int = -1) override {
    if (number == BT_CONSTRAINT_ERP || number == BT_CONSTRAINT_STOP_ERP) erp_ = value;
    if (number == BT_CONSTRAINT_CFM || number == BT_CONSTRAINT_STOP_CFM) cfm_ = value;
  }
  btScalar getParam(int number, int = -1) const override {
    return number == BT_CONSTRAINT_CFM || number == BT_CONSTRAINT_STOP_CFM ? cfm_ : erp_;
  }

 private:
  static bool is_limit(btScalar bound) { return btFabs(bound) < btScalar(HUGE_VAL); }

  // The bodies of the kernel: a, b.
  template <class Of>
  struct Bodies {
    Of of[Block::bodies];
  };
  template <class Of>
  Bodies<Of> bodies(Of (*get)(const btRigidBody&)) const {
    if constexpr (Block::bodies == 1) return {{get(m_rbA)}};
    else return {{get(m_rbA), get(m_rbB)}};
  }
  // With what forces do to them in this step: what the rows have to answer.
  Bodies<spatial::Velocity<btScalar>> velocities(btScalar h) const {
    const auto of = [h](const btRigidBody& body) {
      return velocity_of(body.getLinearVelocity() + body.getTotalForce() * body.getInvMass() * h,
                         body.getAngularVelocity() + body.getInvInertiaTensorWorld() * body.getTotalTorque() * h);
    };
    if constexpr (Block::bodies == 1) return {{of(m_rbA)}};
    else return {{of(m_rbA), of(m_rbB)}};
  }

  template <class Entries>
  static void write_jacobian(btConstraintInfo2& info, int row, const Entries& D, btScalar sign = 1) {
    for (int k = 0; k < 3; ++k) {
      info.m_J1linearAxis[row * info.rowskip + k] = sign * D[k];
      info.m_J1angularAxis[row * info.rowskip + k] = sign * D[3 + k];
      if constexpr (Block::bodies == 2) {
        info.m_J2linearAxis[row * info.rowskip + k] = sign * D[6 + k];
        info.m_J2angularAxis[row * info.rowskip + k] = sign * D[9 + k];
      }
    }
  }
  // The velocity J v that a row asks for, and the bounds of its impulse.
  static void write_aim(btConstraintInfo2& info, int row, btScalar aim, btScalar lower, btScalar upper) {
    info.m_constraintError[row * info.rowskip] = aim;
    info.m_lowerLimit[row * info.rowskip] = lower;
    info.m_upperLimit[row * info.rowskip] = upper;
  }

  void write_rows(btConstraintInfo2& info, int& next) {
    constexpr int n = Block::rows;
    const btScalar h = 1 / info.fps;
    const auto q = bodies(&pose_of);
    typename Block::template Jacobian<btScalar> J;
    btScalar C[n], bias[n], D[n][6 * Block::bodies];
    Block::jacobian(q.of, parameters, time, C, J);
    Block::time_derivative(q.of, parameters, time, bias);
    Block::dense(J, D);
    const bool soft = stiffness.hertz > 0;
    plain::RowStep<btScalar> step = plain::row_step(stiffness, h);
    if (!soft) step = {erp_ >= 0 ? erp_ : info.erp, 0};
    for (int i = 0; i < n; ++i, ++next) {
      const bool bound = Block::row_kinds[i] == RowKind::inequality;
      bias[i] += bound ? plain::bias_of_bound(C[i], step.reduction, h) : C[i] * step.reduction / h;
      write_jacobian(info, next, D[i]);
      write_aim(info, next, -bias[i], bound ? 0 : -SIMD_INFINITY, SIMD_INFINITY);
      if (soft) info.cfm[next * info.rowskip] = step.softness;
      else if (cfm_ >= 0) info.cfm[next * info.rowskip] = cfm_;
    }
    if (soft && step.softness > btScalar(0.5)) write_impulses(info, next - n, J, bias, step.softness, h);
  }

  // Bullet's sweeps add rhs - cfm lambda, which diverges for cfm > 1. Rows that are so soft get the impulse of an
  // implicit spring, (K + softness diag K) lambda = -(J v + bias), as both of their bounds.
  void write_impulses(btConstraintInfo2& info, int first, const typename Block::template Jacobian<btScalar>& J,
                      const btScalar (&bias)[Block::rows], btScalar softness, btScalar h) {
    constexpr int n = Block::rows;
    btScalar K[n * (n + 1) / 2], F[n * (n + 1) / 2], b[n], lambda[n];
    const auto m = bodies(&inverse_mass_of);
    const auto v = velocities(h);
    Block::effective_mass(J, m.of, K);
    for (int i = 0; i < n; ++i) K[plain::diagonal(i)] *= 1 + softness;
    Block::factor(K, F);
    Block::velocity(J, v.of, b);
    for (int i = 0; i < n; ++i) b[i] = -(b[i] + bias[i]);
    Block::solve(F, b, lambda);
    for (int i = 0; i < n; ++i) {
      if (Block::row_kinds[i] == RowKind::inequality) lambda[i] = plain::larger(lambda[i], btScalar(0));
      const btScalar pull = lambda[i] < 0 ? -1 : 1;  // a velocity out of reach, so that the bound decides
      write_aim(info, first + i, pull * btScalar(1e6), lambda[i], lambda[i]);
      info.cfm[(first + i) * info.rowskip] = 0;
    }
  }

  template <class Coordinate>
  void write_drive(btConstraintInfo2& info, int i, int& next) {
    const plain::Drive<btScalar>& drive = drives[i];
    const btScalar h = 1 / info.fps;
    const auto q = bodies(&pose_of);
    typename Coordinate::template Jacobian<btScalar> J;
    btScalar C[1], rate[1], D[1][6 * Block::bodies];
    Coordinate::jacobian(q.of, parameters, time, C, J);
    Coordinate::time_derivative(q.of, parameters, time, rate);
    Coordinate::dense(J, D);
    values_[i] = plain::with_turns<Coordinate>(C[0], values_[i]);
    const btScalar erp = erp_ >= 0 ? erp_ : info.erp;  // as for its own stops
    if (drive.has_motor()) {
      write_jacobian(info, next, D[0]);
      write_aim(info, next++, drive.speed - rate[0], -drive.most * h, drive.most * h);
    }
    if (is_limit(drive.lower)) {
      write_jacobian(info, next, D[0]);
      write_aim(info, next++, -rate[0] - plain::bias_of_bound(values_[i] - drive.lower, erp, h), 0, SIMD_INFINITY);
    }
    if (is_limit(drive.upper)) {
      write_jacobian(info, next, D[0], -1);
      write_aim(info, next++, rate[0] - plain::bias_of_bound(drive.upper - values_[i], erp, h), 0, SIMD_INFINITY);
    }
  }

  btScalar values_[sizeof...(Coordinates) + 1] = {};  // of the coordinates in the last step
  btScalar erp_ = -1, cfm_ = -1;                      // negative: the solver's
};

}  // namespace cdot::bullet
