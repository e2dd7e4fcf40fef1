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
#include "runtime/engines/rows.hpp"

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

// With `parameters`, `stiffness`, `time` and `drives` of rows::Joint.
template <class Block, class... Coordinates>
class Constraint : public btTypedConstraint, public rows::Joint<btScalar, Block, Coordinates...> {
  static_assert(Block::bodies <= 2, "a constraint of Bullet joins two bodies");
  using Joint = rows::Joint<btScalar, Block, Coordinates...>;
  using Row = rows::Row<btScalar, Block::bodies>;

 public:
  using Parameters = typename Joint::Parameters;

  explicit Constraint(btRigidBody& a, const Parameters& p) : Constraint(a, getFixedBody(), p) {
    static_assert(Block::bodies == 1, "this joint joins two bodies; btTypedConstraint::getFixedBody() is the world");
  }
  Constraint(btRigidBody& a, btRigidBody& b, const Parameters& p)
      : btTypedConstraint(MAX_CONSTRAINT_TYPE, a, b), Joint(p) {}

  // Sets parameter number `first` (Block::index_of_pb) and those after it to their defaults at the present poses.
  void by_default(int first) { Joint::by_default(first, bodies_as(&pose_of).of); }

  void getInfo1(btConstraintInfo1* info) override {
    info->m_numConstraintRows = this->count();
    info->nub = 0;
  }

  void getInfo2(btConstraintInfo2* info) override {
    const btScalar h = 1 / info->fps, erp = erp_ >= 0 ? erp_ : info->erp;
    const auto q = bodies_as(&pose_of);
    this->count_turns(q.of);
    int next = 0;
    this->write_rows(q.of, h, erp, [&](const Row& row) {
      write(*info, next, row);
      if (this->is_soft()) info->cfm[next * info->rowskip] = row.softness;
      else if (cfm_ >= 0) info->cfm[next * info->rowskip] = cfm_;
      ++next;
    });
    const btScalar softness = plain::row_step(this->stiffness, h).softness;
    if (this->is_soft() && softness > btScalar(0.5)) write_impulses(*info, q.of, softness, h);
    for (int i = 0; i < Joint::coordinates; ++i)  // `erp` as for its own stops
      this->write_drive(i, q.of, h, erp, [&](const Row& row) { write(*info, next++, row); });
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
  // Of the bodies of the kernel: a, b.
  template <class Of>
  struct Bodies {
    Of of[Block::bodies];
  };
  template <class Get>
  auto bodies_as(Get get) const -> Bodies<decltype(get(m_rbA))> {
    if constexpr (Block::bodies == 1) return {{get(m_rbA)}};
    else return {{get(m_rbA), get(m_rbB)}};
  }

  static void write(btConstraintInfo2& info, int number, const Row& row) {
    const int at = number * info.rowskip;
    for (int k = 0; k < 3; ++k) {
      info.m_J1linearAxis[at + k] = row.J[k];
      info.m_J1angularAxis[at + k] = row.J[3 + k];
      if constexpr (Block::bodies == 2) {
        info.m_J2linearAxis[at + k] = row.J[6 + k];
        info.m_J2angularAxis[at + k] = row.J[9 + k];
      }
    }
    info.m_constraintError[at] = row.aim;
    info.m_lowerLimit[at] = plain::larger(row.least, -SIMD_INFINITY);
    info.m_upperLimit[at] = -plain::larger(-row.most, -SIMD_INFINITY);
  }

  // Bullet's sweeps add rhs - cfm lambda, which diverges for cfm > 1. Rows that are so soft get the impulse of an
  // implicit spring, (K + softness diag K) lambda = -(J v + bias), as both of their bounds.
  void write_impulses(btConstraintInfo2& info, const spatial::Pose<btScalar> (&q)[Block::bodies], btScalar softness,
                      btScalar h) const {
    constexpr int n = Block::rows;
    typename Block::template Jacobian<btScalar> J;
    btScalar C[n], K[n * (n + 1) / 2], F[n * (n + 1) / 2], b[n], lambda[n];
    Block::jacobian(q, this->parameters, this->time, C, J);
    Block::effective_mass(J, bodies_as(&inverse_mass_of).of, K);
    for (int i = 0; i < n; ++i) K[plain::diagonal(i)] *= 1 + softness;
    Block::factor(K, F);
    // Velocities with what forces do to them in this step: what the rows have to answer.
    Block::velocity(J, bodies_as([h](const btRigidBody& body) {
                         return velocity_of(
                             body.getLinearVelocity() + body.getTotalForce() * body.getInvMass() * h,
                             body.getAngularVelocity() + body.getInvInertiaTensorWorld() * body.getTotalTorque() * h);
                       }).of,
                    b);
    for (int i = 0; i < n; ++i) b[i] = info.m_constraintError[i * info.rowskip] - b[i];
    Block::solve(F, b, lambda);
    for (int i = 0; i < n; ++i) {
      if (Block::row_kinds[i] == RowKind::inequality) lambda[i] = plain::larger(lambda[i], btScalar(0));
      const btScalar pull = lambda[i] < 0 ? -1 : 1;  // a velocity out of reach, so that the bound decides
      info.m_constraintError[i * info.rowskip] = pull * btScalar(1e6);
      info.m_lowerLimit[i * info.rowskip] = info.m_upperLimit[i * info.rowskip] = lambda[i];
      info.cfm[i * info.rowskip] = 0;
    }
  }

  btScalar erp_ = -1, cfm_ = -1;  // negative: the solver's
};

}  // namespace cdot::bullet
