// Bullet's rigid bodies: space, double precision, constraints at velocity level: by sweeps or by Dantzig's method.
#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>

#include <string>

#include "tests/bench/peers/engines/bullet_world.hpp"

namespace cdot::peers {
namespace {

// What differs from a new world.
struct Way {
  std::string name, changed;
  int sweeps = 10;  // 0: Dantzig
  double erp = 0.2;
  bool gyroscope_in_world = false;
};

class BulletRun final : public SteppedRun {
 public:
  BulletRun(const Problem& problem, const Way& way, double h)
      : SteppedRun(h),
        dantzig_solver_(&dantzig_),
        world_(&parts_.dispatcher, &parts_.broadphase,
               way.sweeps > 0 ? static_cast<btConstraintSolver*>(&sweeps_) : &dantzig_solver_, &parts_.configuration) {
    world_.setGravity(bt(problem.gravity));
    btContactSolverInfo& info = world_.getSolverInfo();
    info.m_erp = way.erp;
    if (way.sweeps > 0)
      info.m_numIterations = way.sweeps;
    else
      info.m_minimumSolverBatchSize = 1;
    for (const Body& body : problem.bodies) add(body, way);
    for (const Joint& joint : problem.joints) add(problem, joint);
  }
  ~BulletRun() override {
    for (const auto& joint : joints_) world_.removeConstraint(joint.get());
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }
  BulletRun(const BulletRun&) = delete;
  BulletRun& operator=(const BulletRun&) = delete;

  State state(int body) const override {
    const btRigidBody& b = *bodies_[std::size_t(body)];
    return {from(b.getCenterOfMassPosition()), from(b.getOrientation()), from(b.getLinearVelocity()),
            from(b.getAngularVelocity())};
  }
  void step(double h) override {
    for (const auto& [hinge, motor] : motors_) hinge->enableAngularMotor(true, -motor.speed, motor.most * h);
    world_.stepSimulation(h, 0, h);
  }

 private:
  void add(const Body& body, const Way& way) {
    const State& s = body.start;
    const btVector3 inertia = body.turns ? bt(body.inertia) : btVector3(0, 0, 0);  // 0: it cannot turn
    btRigidBody::btRigidBodyConstructionInfo info(body.mass, nullptr, &parts_.shape, inertia);
    info.m_startWorldTransform = btTransform(bt(s.q), bt(s.x));
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    btRigidBody& made = *bodies_.back();
    made.setLinearVelocity(bt(s.v));
    made.setAngularVelocity(bt(s.w));
    made.setActivationState(DISABLE_DEACTIVATION);
    if (way.gyroscope_in_world) made.setFlags(BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_WORLD);
    world_.addRigidBody(&made);
  }

  // The frame of a slider at the start, its x along the axis, in a body's own.
  static btTransform frame(const Problem& problem, const Joint& joint, int body, const Vec3& anchor) {
    const btVector3 x = joint.kind == JointKind::fixed ? btVector3(1, 0, 0) : bt(joint.axis).normalized();
    btVector3 y, z;
    btPlaneSpace1(x, y, z);
    const btMatrix3x3 axes(x.x(), y.x(), z.x(), x.y(), y.y(), z.y(), x.z(), y.z(), z.z());
    if (body == peers::world) return btTransform(axes, bt(anchor));
    const State& s = problem.bodies[std::size_t(body)].start;
    return btTransform(bt(s.q), bt(s.x)).inverse() * btTransform(axes, bt(anchor));
  }

  btRigidBody& body(int index) {
    return index == peers::world ? btTypedConstraint::getFixedBody() : *bodies_[std::size_t(index)];
  }

  // Its motor counts from b to a, its limits from a to b.
  std::unique_ptr<btTypedConstraint> hinge(const Problem& problem, const Joint& joint, btRigidBody& a, btRigidBody& b) {
    auto made = std::make_unique<btHingeConstraint>(
        a, b, bt(local_point(problem, joint.a, joint.anchor)), bt(local_point(problem, joint.b, joint.anchor_b)),
        bt(local_direction(problem, joint.a, joint.axis)), bt(local_direction(problem, joint.b, joint.axis)));
    if (joint.motor) motors_.emplace_back(made.get(), *joint.motor);
    if (joint.stops) made->setLimit(joint.stops->lower, joint.stops->upper);
    return made;
  }

  void add(const Problem& problem, const Joint& joint) {
    btRigidBody &a = body(joint.a), &b = body(joint.b);
    const btVector3 pa = bt(local_point(problem, joint.a, joint.anchor)),
                    pb = bt(local_point(problem, joint.b, joint.anchor_b));
    std::unique_ptr<btTypedConstraint> made;
    if (joint.kind == JointKind::distance || joint.kind == JointKind::max_distance)
      throw CannotSay("no joint that keeps a distance");
    if (joint.kind == JointKind::spherical)
      made = std::make_unique<btPoint2PointConstraint>(a, b, pa, pb);
    else if (joint.kind == JointKind::revolute)
      made = hinge(problem, joint, a, b);
    else if (joint.kind == JointKind::fixed)
      made = std::make_unique<btFixedConstraint>(a, b, frame(problem, joint, joint.a, joint.anchor),
                                                 frame(problem, joint, joint.b, joint.anchor_b));
    else
      made = std::make_unique<btSliderConstraint>(a, b, frame(problem, joint, joint.a, joint.anchor),
                                                  frame(problem, joint, joint.b, joint.anchor_b), true);
    world_.addConstraint(made.get(), true);
    joints_.push_back(std::move(made));
  }

  BulletParts parts_;
  btSequentialImpulseConstraintSolver sweeps_;
  btDantzigSolver dantzig_;
  btMLCPSolver dantzig_solver_;
  Untouched<btDiscreteDynamicsWorld> world_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;
  std::vector<std::pair<btHingeConstraint*, Motor>> motors_;
};

std::vector<Series> series(const Problem& problem) {
  std::vector<Way> ways{{"10 sweeps", ""},
                        {"10 sweeps, ERP 0.8", "ERP 0.8", 10, 0.8},
                        {"50 sweeps, ERP 0.8", "50 iterations, ERP 0.8", 50, 0.8},
                        {"Dantzig, ERP 0.8", "MLCP solver of Dantzig, batch size 1, ERP 0.8", 0, 0.8}};
  if (!problem.planar)
    ways.push_back(
        {"10 sweeps, gyroscope in the world", "gyroscopic force implicit in world coordinates", 10, 0.2, true});
  std::vector<Series> all;
  for (const Way& way : ways)
    all.push_back({way.name, way.changed, "h", steps(problem),
                   [&problem, way](double h) { return std::make_unique<BulletRun>(problem, way, h); }});
  return all;
}

const Registration registration{
    {"Bullet", "3.24", "double", "#57606a", "the build in doubles; collision detection skipped; no sleep", series}};

}  // namespace
}  // namespace cdot::peers
