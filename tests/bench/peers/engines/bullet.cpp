// Bullet's rigid bodies: space, double precision, constraints at velocity level: by sweeps or by Dantzig's method.
#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>
#include <cmath>
#include <map>
#include <string>

#include "tests/bench/peers/engines/bullet_world.hpp"
#include "tests/bench/peers/words.hpp"

namespace cdot::peers {
namespace {

// Changes from a new world's defaults.
struct Way {
  std::string name, changed;
  int sweeps = 10;  // 0: Dantzig
  double erp = 0.2;
  bool gyroscope_in_world = false;
  bool free_first = false;  // free rotation first, in six-degree joints
};

class BulletRun final : public SteppedRun {
 public:
  BulletRun(const Problem& problem, const Way& way, double h)
      : SteppedRun(h),
        dantzig_solver_(&dantzig_),
        world_(&parts_.dispatcher, &parts_.broadphase,
               way.sweeps > 0 ? static_cast<btConstraintSolver*>(&sweeps_) : &dantzig_solver_, &parts_.configuration),
        free_first_(way.free_first) {
    if (problem.sleep_after > 0) gDeactivationTime = problem.sleep_after;
    world_.setGravity(bt(problem.gravity));
    btContactSolverInfo& info = world_.getSolverInfo();
    info.m_erp = way.erp;
    if (way.sweeps > 0) info.m_numIterations = way.sweeps;
    else info.m_minimumSolverBatchSize = 1;
    for (const Body& body : problem.bodies) add(body, way, problem.sleep_after > 0);
    for (const Joint& joint : problem.joints)
      if (joint.kind == JointKind::contact) touch(problem, joint);
      else add(problem, joint);
  }
  ~BulletRun() override {
    if (floor_) world_.removeRigidBody(floor_.get());
    for (const auto& [number, made] : joints_) drop(made);
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
    for (const auto& [hinge, motor] : motors_) hinge->enableAngularMotor(true, -speed_of(motor, time_), motor.most * h);
    for (const auto& [hinge, servo] : servos_)
      hinge->enableAngularMotor(true, -speed_of(servo, -hinge->getHingeAngle(), h), servo.most * h);
    for (const auto& [body, torque] : torques_) body->applyTorque(torque);
    for (const auto& [hinge, damping] : dampers_) damp(*hinge, damping);
    world_.stepSimulation(h, 0, h);
    time_ += h;
  }

  void strike(int body, const Vec3& impulse) override {
    bodies_[std::size_t(body)]->activate(true);
    bodies_[std::size_t(body)]->applyCentralImpulse(bt(impulse));
  }
  bool remove(int joint) override {
    drop(joints_.at(joint));
    joints_.erase(joint);
    return true;
  }
  bool add(const Problem& problem, const Joint& joint) override {
    made_ = &joints_[joint.number];
    connect(problem, joint);
    return true;
  }
  bool change(const Problem& now, const Joint& joint) override {
    if (joint.kind != JointKind::revolute) return SteppedRun::change(now, joint);
    auto& hinge = static_cast<btHingeConstraint&>(*joints_.at(joint.number).constraints.front());
    hinge.getAFrame().setOrigin(bt(local_point(now, joint.a, joint.anchor)));
    hinge.getBFrame().setOrigin(bt(local_point(now, joint.b, joint.anchor_b)));
    return true;
  }
  double force(int joint) const override { return joints_.at(joint).felt->m_appliedForceBodyB.length(); }
  bool asleep(int body) const override { return !bodies_[std::size_t(body)]->isActive(); }

 private:
  struct Made {
    std::vector<std::unique_ptr<btTypedConstraint>> constraints;  // the first is the constraint itself
    std::unique_ptr<btJointFeedback> felt = std::make_unique<btJointFeedback>();
  };

  void drop(const Made& made) {
    for (const auto& constraint : made.constraints) world_.removeConstraint(constraint.get());
  }

  void add(const Body& body, const Way& way, bool sleeps) {
    const State& s = body.start;
    const btVector3 inertia = body.turns ? bt(body.inertia) : btVector3(0, 0, 0);  // 0: it cannot rotate
    btRigidBody::btRigidBodyConstructionInfo info(body.moves ? body.mass : 0, nullptr, &parts_.shape, inertia);
    info.m_startWorldTransform = btTransform(bt(s.q), bt(s.x));
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    btRigidBody& made = *bodies_.back();
    made.setLinearVelocity(bt(s.v));
    made.setAngularVelocity(bt(s.w));
    made.setDamping(1 - std::exp(-body.damping), 1 - std::exp(-body.damping));
    if (!sleeps) made.setActivationState(DISABLE_DEACTIVATION);
    if (norm(body.torque) > 0) torques_.emplace_back(&made, bt(body.torque));
    if (way.gyroscope_in_world) made.setFlags(BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_WORLD);
    world_.addRigidBody(&made);
  }

  // The frame of a joint at the start, x along the axis, in a body's frame.
  static btTransform frame(const Problem& problem, const Joint& joint, int body, const Vec3& anchor) {
    const btVector3 x = norm(joint.axis) == 0 ? btVector3(1, 0, 0) : bt(joint.axis).normalized();
    btVector3 y, z;
    btPlaneSpace1(x, y, z);
    return frame(problem, x, y, z, body, anchor);
  }
  static btTransform frame(const Problem& problem, const btVector3& x, const btVector3& y, const btVector3& z, int body,
                           const Vec3& anchor) {
    const btMatrix3x3 axes(x.x(), y.x(), z.x(), x.y(), y.y(), z.y(), x.z(), y.z(), z.z());
    if (body == peers::world) return btTransform(axes, bt(anchor));
    const State& s = problem.bodies[std::size_t(body)].start;
    return btTransform(bt(s.q), bt(s.x)).inverse() * btTransform(axes, bt(anchor));
  }

  btRigidBody& body(int index) {
    return index == peers::world ? btTypedConstraint::getFixedBody() : *bodies_[std::size_t(index)];
  }

  // A ball on a plane. Coefficients of friction are multiplied.
  void touch(const Problem& problem, const Joint& joint) {
    if (floor_) throw CannotSay("the adapter knows one contact");
    btRigidBody& a = body(joint.a);
    const btTransform at(btQuaternion::getIdentity(), bt(local_point(problem, joint.a, joint.anchor)));
    ball_about_tip_.addChildShape(at, &ball_);
    plane_ = std::make_unique<btStaticPlaneShape>(bt(joint.axis), dot(joint.anchor_b, joint.axis) - tip);
    floor_ = std::make_unique<btRigidBody>(0, nullptr, plane_.get());
    floor_->setFriction(1);
    world_.removeRigidBody(&a);
    a.setCollisionShape(&ball_about_tip_);
    a.setFriction(joint.friction);
    world_.addRigidBody(&a);
    world_.addRigidBody(floor_.get());
    world_.collides = true;
  }

  static void damp(btHingeConstraint& hinge, double damping) {
    btRigidBody &a = hinge.getRigidBodyA(), &b = hinge.getRigidBodyB();
    const btVector3 axis = a.getWorldTransform().getBasis() * hinge.getAFrame().getBasis().getColumn(2);
    const btVector3 torque = damping * axis.dot(b.getAngularVelocity() - a.getAngularVelocity()) * axis;
    a.applyTorque(torque);
    b.applyTorque(-torque);
  }

  // Bullet's angle is that from b to a.
  std::unique_ptr<btTypedConstraint> hinge(const Problem& problem, const Joint& joint, btRigidBody& a, btRigidBody& b) {
    auto made = std::make_unique<btHingeConstraint>(
        a, b, bt(local_point(problem, joint.a, joint.anchor)), bt(local_point(problem, joint.b, joint.anchor_b)),
        bt(local_direction(problem, joint.a, joint.axis)),
        bt(local_direction(problem, joint.b, joint.axis_b.value_or(joint.axis))));
    if (joint.motor) motors_.emplace_back(made.get(), *joint.motor);
    if (joint.servo) servos_.emplace_back(made.get(), *joint.servo);
    if (joint.stops) made->setLimit(-joint.stops->upper, -joint.stops->lower, 0.9, 0.3, 0);  // without bouncing
    if (!joint.spring) return made;
    if (joint.spring->stiffness != 0) throw CannotSay("no spring of a hinge");
    dampers_.emplace_back(made.get(), joint.spring->damping);
    return made;
  }

  // Six degrees of freedom: slides and the rotation about the axis are free, the other rotations locked.
  std::unique_ptr<btGeneric6DofSpring2Constraint> six(const Problem& problem, const Joint& joint) {
    auto made = std::make_unique<btGeneric6DofSpring2Constraint>(body(joint.a), body(joint.b),
                                                                 frame(problem, joint, joint.a, joint.anchor),
                                                                 frame(problem, joint, joint.b, joint.anchor_b));
    for (int k = 0; k < 3; ++k) made->setLimit(k, 1, -1);
    made->setLimit(3, 1, -1);
    for (int k = 4; k < 6; ++k) made->setLimit(k, 0, 0);
    return made;
  }
  // All free but what is set afterwards.
  std::unique_ptr<btGeneric6DofSpring2Constraint> six_free(const Problem& problem, const Joint& joint) {
    auto made = six(problem, joint);
    for (int k = 4; k < 6; ++k) made->setLimit(k, 1, -1);
    return made;
  }
  std::unique_ptr<btTypedConstraint> brake(const Problem& problem, const Joint& joint, double torque) {
    auto made = six_free(problem, joint);
    made->enableMotor(3, true);
    made->setTargetVelocity(3, 0);
    made->setMaxMotorForce(3, torque);
    return made;
  }
  std::unique_ptr<btTypedConstraint> mount(const Problem& problem, const Joint& joint) {
    auto made = six_free(problem, joint);
    const auto& [along, across, twist, bend] = *joint.mount;
    const double stiffness[] = {along, across, across, twist, bend, bend};
    for (int k = 0; k < 6; ++k) add_spring(*made, k, {stiffness[k], 0});
    return made;
  }
  std::unique_ptr<btTypedConstraint> slider(const Joint& joint, const btTransform& in_a, const btTransform& in_b) {
    auto made = std::make_unique<btSliderConstraint>(body(joint.a), body(joint.b), in_a, in_b, true);
    if (!joint.motor) return made;
    if (joint.motor->speed_at) throw CannotSay("the adapter changes the speed of hinges only");
    made->setPoweredLinMotor(true);
    made->setTargetLinMotorVelocity(joint.motor->speed);
    made->setMaxLinMotorForce(joint.motor->most);
    return made;
  }
  // Rotations about x of a, y and z of b; a universal joint frees the last two, so the second may turn without bound.
  std::unique_ptr<btTypedConstraint> turning(const Problem& problem, const Joint& joint) {
    std::vector<Turn> turns = turns_of(joint, free_first_);
    if (joint.kind == JointKind::universal)
      turns.insert(turns.begin(), Turn{cross(turns[0].axis, turns[1].axis), true, {}});
    const btVector3 x = bt(turns[0].axis), y = bt(turns[1].axis), z = bt(turns[2].axis);
    auto made = std::make_unique<btGeneric6DofSpring2Constraint>(
        body(joint.a), body(joint.b), frame(problem, x, y, z, joint.a, joint.anchor),
        frame(problem, x, y, z, joint.b, joint.anchor_b), RO_ZYX);
    for (int k = 0; k < 3; ++k) {
      const Turn& turn = turns[std::size_t(k)];
      made->setLimit(k, 0, 0);
      made->setLimit(3 + k, turn.held ? 0 : 1, turn.held ? 0 : -1);
      if (!turn.motor) continue;
      made->enableMotor(3 + k, true);
      made->setTargetVelocity(3 + k, -turn.motor->speed);  // positive from b to a
      made->setMaxMotorForce(3 + k, turn.motor->most);
    }
    return made;
  }
  static void add_spring(btGeneric6DofSpring2Constraint& made, int coordinate, const Spring& spring) {
    made.enableSpring(coordinate, true);
    made.setStiffness(coordinate, spring.stiffness);
    made.setDamping(coordinate, spring.damping);
    made.setEquilibriumPoint(coordinate, 0);
  }

  std::unique_ptr<btTypedConstraint> holding(const Problem& problem, const Joint& joint) {
    btRigidBody &a = body(joint.a), &b = body(joint.b);
    const btTransform in_a = frame(problem, joint, joint.a, joint.anchor),
                      in_b = frame(problem, joint, joint.b, joint.anchor_b);
    if (joint.soft) {
      if (joint.kind != JointKind::revolute) throw CannotSay("the adapter makes hinges soft only");
      auto made = six(problem, joint);
      for (int k = 0; k < 3; ++k) add_spring(*made, k, *joint.soft);
      return made;
    }
    if (joint.kind == JointKind::mount) return mount(problem, joint);
    if (joint.kind == JointKind::orientation) {
      auto made = six(problem, joint);
      made->setLimit(3, 0, 0);
      return made;
    }
    if (joint.kind == JointKind::distance || joint.kind == JointKind::max_distance || joint.kind == JointKind::pulley)
      throw no_such(joint);
    if (!joint.turns.empty()) return turning(problem, joint);
    if (joint.kind == JointKind::spherical)
      return std::make_unique<btPoint2PointConstraint>(a, b, in_a.getOrigin(), in_b.getOrigin());
    if (joint.kind == JointKind::revolute) return hinge(problem, joint, a, b);
    if (joint.kind == JointKind::fixed) return std::make_unique<btFixedConstraint>(a, b, in_a, in_b);
    if (norm(joint.axis) == 0) throw CannotSay("its sliders take a frame, of which no axis is zero");
    return slider(joint, in_a, in_b);
  }

  void connect(const Problem& problem, const Joint& joint) {
    made_->constraints.push_back(holding(problem, joint));
    made_->constraints.back()->setJointFeedback(made_->felt.get());
    if (joint.spring && joint.kind == JointKind::prismatic) {
      auto free = six_free(problem, joint);
      add_spring(*free, 0, *joint.spring);
      made_->constraints.push_back(std::move(free));
    }
    for (const double torque : joint.brakes) made_->constraints.push_back(brake(problem, joint, torque));
    for (const auto& constraint : made_->constraints) world_.addConstraint(constraint.get(), true);
  }

  BulletParts parts_;
  btSequentialImpulseConstraintSolver sweeps_;
  btDantzigSolver dantzig_;
  btMLCPSolver dantzig_solver_;
  Untouched<btDiscreteDynamicsWorld> world_;
  bool free_first_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  btSphereShape ball_{tip};
  btCompoundShape ball_about_tip_;
  std::unique_ptr<btStaticPlaneShape> plane_;
  std::unique_ptr<btRigidBody> floor_;  // of a contact
  std::map<int, Made> joints_;          // by number
  Made* made_ = nullptr;                // of the joint in add()
  std::vector<std::pair<btRigidBody*, btVector3>> torques_;
  std::vector<std::pair<btHingeConstraint*, Motor>> motors_;
  std::vector<std::pair<btHingeConstraint*, Servo>> servos_;
  std::vector<std::pair<btHingeConstraint*, double>> dampers_;
  double time_ = 0;
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
  for (const Way& way : with_free_turns_first(problem, ways))
    all.push_back({way.name, way.changed, "h", steps(problem),
                   [&problem, way](double h) { return std::make_unique<BulletRun>(problem, way, h); }});
  return all;
}

const Registration registration{
    {"Bullet", "3.24", "double", "#57606a",
     "the build in doubles; collision detection skipped without a contact, which is a ball of 0.1 mm on a plane; "
     "springs, soft joints and brakes are "
     "btGeneric6DofSpring2Constraint, a servo a motor whose speed is set before each step, a damper of a hinge a "
     "torque put on before each step; a stop's relaxation 0; "
     "sleeps where the case does",
     series}};

}  // namespace
}  // namespace cdot::peers
