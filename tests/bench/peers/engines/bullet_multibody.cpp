// Bullet's multibodies: space, double precision, minimal coordinates; loops are closed by points fed back.
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <BulletDynamics/Featherstone/btMultiBodyPoint2Point.h>

#include <algorithm>
#include <string>

#include "tests/bench/peers/engines/bullet_world.hpp"
#include "tests/bench/peers/tree.hpp"

namespace cdot::peers {
namespace {

struct Way {
  std::string name, changed;
  bool rk4;
  double erp = 0.2;
};

class MultibodyRun final : public SteppedRun {
 public:
  MultibodyRun(const Problem& problem, const Way& way, double h)
      : SteppedRun(h),
        world_(&parts_.dispatcher, &parts_.broadphase, &solver_, &parts_.configuration),
        link_of_(problem.bodies.size(), -1) {
    world_.setGravity(bt(problem.gravity));
    world_.getSolverInfo().m_erp = way.erp;
    need_all_turn(problem);
    need_free_hinges(problem);
    const Tree tree = tree_of(problem);
    make(problem, tree);
    multibody_->setLinearDamping(0);
    multibody_->setAngularDamping(0);
    multibody_->setUseGyroTerm(true);
    multibody_->setMaxCoordinateVelocity(1e9);
    multibody_->setMaxAppliedImpulse(1e9);
    multibody_->useRK4Integration(way.rk4);
    world_.addMultiBody(multibody_.get());
    // Without colliders the constraint would do nothing, and say nothing.
    for (int link = -1; link < multibody_->getNumLinks() && !tree.loops.empty(); ++link) collide(link);
    for (const int loop : tree.loops) close(problem, problem.joints[std::size_t(loop)]);
  }
  ~MultibodyRun() override {
    for (const auto& loop : loops_) world_.removeMultiBodyConstraint(loop.get());
    for (const auto& collider : colliders_) world_.removeCollisionObject(collider.get());
    world_.removeMultiBody(multibody_.get());
  }
  MultibodyRun(const MultibodyRun&) = delete;
  MultibodyRun& operator=(const MultibodyRun&) = delete;

  void step(double h) override { world_.stepSimulation(h, 0, h); }
  State state(int body) const override {
    const int link = link_of_[std::size_t(body)];
    const btMultiBody& m = *multibody_;
    if (link < 0)
      return {from(m.getBasePos()), from(m.getWorldToBaseRot().inverse()), from(m.getBaseVel()),
              from(m.getBaseOmega())};
    std::vector<btVector3> w(std::size_t(m.getNumLinks()) + 1), v(w.size());
    m.compTreeLinkVelocities(w.data(), v.data());
    const btMatrix3x3 R = m.localFrameToWorld(link, btMatrix3x3::getIdentity());
    btQuaternion q;
    R.getRotation(q);
    return {from(m.localPosToWorld(link, btVector3(0, 0, 0))), from(q), from(R * v[std::size_t(link) + 1]),
            from(R * w[std::size_t(link) + 1])};
  }

 private:
  // The world is the base, or the one body that nothing holds.
  void make(const Problem& problem, const Tree& tree) {
    const bool rootless =
        std::any_of(tree.branches.begin(), tree.branches.end(), [](const Branch& branch) { return branch.joint < 0; });
    if (rootless && problem.bodies.size() > 1)
      throw CannotSay("the adapter makes one tree that hangs from the world, or one free body");
    if (problem.joints.empty()) {
      const Body& body = problem.bodies.at(0);
      multibody_ = std::make_unique<btMultiBody>(0, body.mass, bt(body.inertia), false, false);
      multibody_->finalizeMultiDof();
      multibody_->setBasePos(bt(body.start.x));
      multibody_->setWorldToBaseRot(bt(body.start.q).inverse());
      multibody_->setBaseVel(bt(body.start.v));
      multibody_->setBaseOmega(bt(body.start.w));
      return;
    }
    const int links = int(tree.branches.size());
    multibody_ = std::make_unique<btMultiBody>(links, 0, btVector3(0, 0, 0), true, false);
    for (int link = 0; link < links; ++link) {
      link_of_[std::size_t(tree.branches[std::size_t(link)].body)] = link;
      setup(problem, tree.branches[std::size_t(link)], link);
    }
    multibody_->finalizeMultiDof();
    for (int link = 0; link < links; ++link) set_velocity(problem, tree.branches[std::size_t(link)], link);
  }

  int link_of(int body) const { return body == peers::world ? -1 : link_of_[std::size_t(body)]; }

  void setup(const Problem& problem, const Branch& branch, int link) {
    const Body& body = problem.bodies[std::size_t(branch.body)];
    const Joint& joint = problem.joints[std::size_t(branch.joint)];
    const Quaternion parent =
        branch.parent == peers::world ? Quaternion{1, 0, 0, 0} : problem.bodies[std::size_t(branch.parent)].start.q;
    const btQuaternion turn = bt(conjugate(body.start.q) * parent);
    const btVector3 in = bt(local_point(problem, branch.parent, joint.anchor)),
                    out = -bt(local_point(problem, branch.body, joint.anchor)),
                    axis = bt(local_direction(problem, branch.body, joint.axis)), inertia = bt(body.inertia);
    const int above = link_of(branch.parent);
    if (joint.kind == JointKind::fixed)
      multibody_->setupFixed(link, body.mass, inertia, above, turn, in, out, true);
    else if (joint.kind == JointKind::spherical)
      multibody_->setupSpherical(link, body.mass, inertia, above, turn, in, out, true);
    else if (joint.kind == JointKind::revolute)
      multibody_->setupRevolute(link, body.mass, inertia, above, turn, axis, in, out, true);
    else
      multibody_->setupPrismatic(link, body.mass, inertia, above, turn, axis, in, out, true);
  }

  void set_velocity(const Problem& problem, const Branch& branch, int link) {
    if (problem.joints[std::size_t(branch.joint)].kind == JointKind::spherical) {
      const Quaternion& q = problem.bodies[std::size_t(branch.body)].start.q;
      const Vec3 w = turned(conjugate(q), spin(problem, branch));
      multibody_->setJointVelMultiDof(link, w.data());
    } else if (problem.joints[std::size_t(branch.joint)].kind != JointKind::fixed) {
      multibody_->setJointVel(link, rate(problem, branch));
    }
  }

  void collide(int link) {
    colliders_.push_back(std::make_unique<btMultiBodyLinkCollider>(multibody_.get(), link));
    btMultiBodyLinkCollider* made = colliders_.back().get();
    made->setCollisionShape(&parts_.shape);
    world_.addCollisionObject(made);
    if (link < 0)
      multibody_->setBaseCollider(made);
    else
      multibody_->getLink(link).m_collider = made;
  }

  void close(const Problem& problem, const Joint& joint) {
    loops_.push_back(std::make_unique<btMultiBodyPoint2Point>(
        multibody_.get(), link_of(joint.a), multibody_.get(), link_of(joint.b),
        bt(local_point(problem, joint.a, joint.anchor)), bt(local_point(problem, joint.b, joint.anchor_b))));
    loops_.back()->setMaxAppliedImpulse(1e9);
    world_.addMultiBodyConstraint(loops_.back().get());
  }

  BulletParts parts_;
  btMultiBodyConstraintSolver solver_;
  Untouched<btMultiBodyDynamicsWorld> world_;
  std::vector<int> link_of_;
  std::unique_ptr<btMultiBody> multibody_;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders_;
  std::vector<std::unique_ptr<btMultiBodyConstraint>> loops_;
};

std::vector<Series> series(const Problem& problem) {
  std::vector<Way> ways{{"RK4", "useRK4Integration", true}, {"Euler", "", false}};
  if (!tree_of(problem).loops.empty()) ways.push_back({"RK4, ERP 0.8", "useRK4Integration, ERP 0.8", true, 0.8});
  std::vector<Series> all;
  for (const Way& way : ways)
    all.push_back({way.name, way.changed, "h", way.rk4 ? fine_steps(problem) : steps(problem),
                   [&problem, way](double h) { return std::make_unique<MultibodyRun>(problem, way, h); }});
  return all;
}

const Registration registration{
    {"Bullet multibody", "3.24", "double", "#bf3989",
     "the build in doubles; a tree of links, loops closed by btMultiBodyPoint2Point; link damping 0; greatest "
     "coordinate velocity and impulse raised; collision detection skipped; no sleep",
     series}};

}  // namespace
}  // namespace cdot::peers
