// A joint as a constraint of DART 6: a ConstraintBase that any world takes by getConstraintSolver()->addConstraint().
//
// It joins body nodes of any skeletons, at most two of one; a null pointer is the world. Points and directions of
// `parameters` are those of the frames of the body nodes. Rigid rows take DART's own error reduction and constraint
// force mixing, those of DynamicJointConstraint. Impulses of the last step are a start for solvers that take one.
#pragma once

#include <dart/constraint/DynamicJointConstraint.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/Skeleton.hpp>

#include <cdot/kernel.hpp>

#include "runtime/engines/plain.hpp"
#include "runtime/engines/rows.hpp"

namespace cdot::dart {

using ::dart::dynamics::BodyNode;

inline spatial::Pose<double> pose_of(const BodyNode* body) {
  if (body == nullptr) return plain::pose<double>(0, 0, 0, 1, 0, 0, 0);
  const Eigen::Vector3d x = body->getWorldTransform().translation();
  const Eigen::Quaterniond e(body->getWorldTransform().linear());
  return plain::pose<double>(x[0], x[1], x[2], e.w(), e.x(), e.y(), e.z());
}

// With `parameters`, `stiffness`, `time` and `drives` of rows::Joint.
template <class Block, class... Coordinates>
class Constraint : public ::dart::constraint::ConstraintBase, public rows::Joint<double, Block, Coordinates...> {
  using Joint = rows::Joint<double, Block, Coordinates...>;
  using Row = rows::Row<double, Block::bodies>;
  using Own = ::dart::constraint::DynamicJointConstraint;
  static constexpr int bodies = Block::bodies;

 public:
  using Parameters = typename Joint::Parameters;

  double erp = -1, cfm = -1;  // negative: DART's

  // The bodies a, b and so on of the joint.
  template <class... Bodies>
  explicit Constraint(const Parameters& p, Bodies... of_joint) : Joint(p), bodies_{of_joint...} {
    static_assert(sizeof...(Bodies) == bodies, "give each body of the joint; nullptr is the world");
    refuse_three_of_a_skeleton();
  }

  // Sets parameter number `first` (Block::index_of_pb) and those after it to their defaults at the present poses.
  void by_default(int first) { Joint::by_default(first, poses().of); }

  // Of the last step, first those of the joint's rows: the time step times force or torque.
  const double* impulses() const { return impulse_; }

  const std::string& getType() const override {
    static const std::string type = std::string("cdot::") + Block::name;
    return type;
  }

 protected:
  // Calls f for each body that answers to impulses.
  template <class F>
  void each_reactive(F f) const {
    for (int k = 0; k < bodies; ++k)
      if (bodies_[k] != nullptr && bodies_[k]->isReactive()) f(k, *bodies_[k]);
  }

  bool isActive() const override {
    bool active = false;
    each_reactive([&](int, BodyNode&) { active = true; });
    return active;
  }

  void update() override {
    const auto q = poses();
    this->count_turns(q.of);
    double h = 0;
    each_reactive([&](int, BodyNode& body) { h = body.getSkeleton()->getTimeStep(); });
    if (!(h > 0)) return;  // nothing can move
    const double reduction = erp >= 0 ? erp : Own::getErrorReductionParameter();
    const double mixing = cfm >= 0 ? cfm : Own::getConstraintForceMixing();
    mDim = 0;
    const auto take = [&](const Row& row, bool soft) {
      rows_[mDim] = row;
      if (!soft) rows_[mDim].softness = mixing;
      for (int k = 0; k < bodies; ++k) J_[mDim][k] = in_body(q.of[k], row.J + 6 * k);
      ++mDim;
    };
    this->write_rows(q.of, h, reduction, [&](const Row& row) { take(row, this->is_soft()); });
    for (int i = 0; i < Joint::coordinates; ++i)
      this->write_drive(i, q.of, h, reduction, [&](const Row& row) { take(row, false); });
  }

  void getInformation(::dart::constraint::ConstraintInfo* info) override {
    for (std::size_t i = 0; i < mDim; ++i) {
      info->lo[i] = rows_[i].least;
      info->hi[i] = rows_[i].most;
      info->x[i] = impulse_[i];
      info->b[i] = rows_[i].aim;
      for (int k = 0; k < bodies; ++k)
        if (bodies_[k] != nullptr) info->b[i] -= J_[i][k].dot(bodies_[k]->getSpatialVelocity());
    }
  }

  void applyUnitImpulse(std::size_t index) override {
    each_reactive([&](int k, BodyNode& body) {
      const int last = last_of_skeleton(k);
      if (last < 0) return;  // done with an earlier body
      auto& skeleton = *body.getSkeleton();
      skeleton.clearConstraintImpulses();
      if (last == k) skeleton.updateBiasImpulse(&body, J_[index][k]);
      else skeleton.updateBiasImpulse(&body, J_[index][k], bodies_[last], J_[index][last]);
      skeleton.updateVelocityChange();
    });
    applied_ = index;
  }
  // `withCfm`: of a row's own unit impulse.
  void getVelocityChange(double* vel, bool withCfm) override {
    for (std::size_t i = 0; i < mDim; ++i) {
      vel[i] = 0;
      each_reactive([&](int k, BodyNode& body) {
        if (body.getSkeleton()->isImpulseApplied()) vel[i] += J_[i][k].dot(body.getBodyVelocityChange());
      });
    }
    if (withCfm) vel[applied_] *= 1 + rows_[applied_].softness;
  }
  void excite() override {
    each_reactive([](int, BodyNode& body) { body.getSkeleton()->setImpulseApplied(true); });
  }
  void unexcite() override {
    each_reactive([](int, BodyNode& body) { body.getSkeleton()->setImpulseApplied(false); });
  }
  void applyImpulse(double* lambda) override {
    for (std::size_t i = 0; i < mDim; ++i) {
      impulse_[i] = lambda[i];
      each_reactive([&](int k, BodyNode& body) { body.addConstraintImpulse(lambda[i] * J_[i][k]); });
    }
  }

  ::dart::dynamics::SkeletonPtr getRootSkeleton() const override {
    ::dart::dynamics::SkeletonPtr root;
    each_reactive([&](int, BodyNode& body) { root = ConstraintBase::getRootSkeleton(body.getSkeleton()); });
    return root;
  }
  // Skeletons that the joint connects are solved as one group.
  void uniteSkeletons() override {
    ::dart::dynamics::SkeletonPtr first;
    each_reactive([&](int, BodyNode& body) {
      const auto other = compressPath(body.getSkeleton());
      if (first != nullptr) first = compressPath(first);
      if (first == nullptr || first == other) {
        first = other;
      } else if (first->mUnionSize < other->mUnionSize) {
        first->mUnionRootSkeleton = other;
        other->mUnionSize += first->mUnionSize;
      } else {
        other->mUnionRootSkeleton = first;
        first->mUnionSize += other->mUnionSize;
      }
    });
  }

 private:
  struct Poses {
    spatial::Pose<double> of[bodies];
  };
  Poses poses() const {
    Poses q;
    for (int k = 0; k < bodies; ++k) q.of[k] = pose_of(bodies_[k]);
    return q;
  }
  bool of_one_skeleton(int k, int l) const {
    return bodies_[k] != nullptr && bodies_[l] != nullptr && bodies_[k]->getSkeleton() == bodies_[l]->getSkeleton();
  }
  // The last body of the skeleton of body k, k itself if it is the only one; -1 if there is one before k.
  int last_of_skeleton(int k) const {
    int last = k;
    for (int l = 0; l < bodies; ++l)
      if (of_one_skeleton(k, l)) {
        if (l < k) return -1;
        last = l;
      }
    return last;
  }
  // DART tests unit impulses on one body or on two at once.
  void refuse_three_of_a_skeleton() const {
    for (int k = 0; k < bodies; ++k) {
      int count = 0;
      for (int l = 0; l < bodies; ++l) count += of_one_skeleton(k, l);
      if (count > 2) throw std::invalid_argument("a constraint of DART takes at most two bodies of one skeleton");
    }
  }
  // DART's vectors have the angular part first, in the axes of the body.
  static Eigen::Vector6d in_body(const spatial::Pose<double>& q, const double* D) {
    Eigen::Matrix3d R;
    R << q.xx, q.xy, q.xz, q.yx, q.yy, q.yz, q.zx, q.zy, q.zz;
    Eigen::Vector6d J;
    J << R.transpose() * Eigen::Vector3d(D[3], D[4], D[5]), R.transpose() * Eigen::Vector3d(D[0], D[1], D[2]);
    return J;
  }

  BodyNode* bodies_[bodies];
  Row rows_[Joint::most_rows];
  Eigen::Vector6d J_[Joint::most_rows][bodies];
  double impulse_[Joint::most_rows] = {};
  std::size_t applied_ = 0;
};

}  // namespace cdot::dart
