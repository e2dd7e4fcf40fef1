// Chipmunk 7: planar, double precision, sequential impulses; joint errors are fed back into the velocities.
#include <chipmunk/chipmunk.h>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "tests/bench/peers/geometry.hpp"
#include "tests/bench/peers/words.hpp"

namespace cdot::peers {
namespace {

cpVect vec(const Vec3& a) { return cpv(a[0], a[1]); }

// The share of a joint's error that remains after a second.
double left_after_a_second(double left_per_step, double h) { return std::pow(left_per_step, 1 / h); }

class ChipmunkRun final : public SteppedRun {
 public:
  // left_per_step < 0: the default errorBias
  ChipmunkRun(const Problem& problem, int iterations, double left_per_step, double h)
      : SteppedRun(h), space_(cpSpaceNew()), last_(h) {
    if (left_per_step >= 0) left_after_a_second_ = left_after_a_second(left_per_step, h);
    cpSpaceSetIterations(space_, iterations);
    cpSpaceSetGravity(space_, vec(problem.gravity));
    cpSpaceSetDamping(space_, std::exp(-damping(problem)));
    if (problem.sleep_after > 0) cpSpaceSetSleepTimeThreshold(space_, problem.sleep_after);
    for (const Body& body : problem.bodies) add(body);
    for (const Joint& joint : problem.joints) add(problem, joint);
  }
  ~ChipmunkRun() override {
    for (const auto& [number, made] : joints_) drop(made);
    for (cpShape* shape : shapes_) {
      cpSpaceRemoveShape(space_, shape);
      cpShapeFree(shape);
    }
    for (cpBody* body : bodies_) {
      cpSpaceRemoveBody(space_, body);
      cpBodyFree(body);
    }
    cpSpaceFree(space_);
  }
  ChipmunkRun(const ChipmunkRun&) = delete;
  ChipmunkRun& operator=(const ChipmunkRun&) = delete;

  void step(double h) override {
    for (const auto& [body, torque] : torques_) cpBodySetTorque(body, torque);
    for (const auto& [made, motor] : motors_) cpSimpleMotorSetRate(made, -speed_of(motor, time_));
    for (const auto& [made, servo] : servos_) cpSimpleMotorSetRate(made, -speed_of(servo, angle_of(made), h));
    cpSpaceStep(space_, h);
    last_ = h;
    time_ += h;
  }
  State state(int body) const override {
    const cpBody* b = bodies_[std::size_t(body)];
    const cpVect x = cpBodyGetPosition(b), v = cpBodyGetVelocity(b);
    return {{x.x, x.y, 0}, about_z(cpBodyGetAngle(b)), {v.x, v.y, 0}, {0, 0, cpBodyGetAngularVelocity(b)}};
  }

  void strike(int body, const Vec3& impulse) override {
    cpBody* b = bodies_[std::size_t(body)];
    cpBodyApplyImpulseAtWorldPoint(b, vec(impulse), cpBodyGetPosition(b));
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
    cpPivotJointSetAnchorA(joints_.at(joint.number).front(), vec(local_point(now, joint.a, joint.anchor)));
    cpPivotJointSetAnchorB(joints_.at(joint.number).front(), vec(local_point(now, joint.b, joint.anchor_b)));
    return true;
  }
  double force(int joint) const override { return cpConstraintGetImpulse(joints_.at(joint).front()) / last_; }
  bool asleep(int body) const override { return cpBodyIsSleeping(bodies_[std::size_t(body)]); }

 private:
  // Chipmunk has one damping for all bodies.
  static double damping(const Problem& problem) {
    for (const Body& body : problem.bodies)
      if (body.damping != problem.bodies[0].damping) throw CannotSay("one damping for all bodies only");
    return problem.bodies[0].damping;
  }

  void drop(const std::vector<cpConstraint*>& made) {
    for (cpConstraint* constraint : made) {
      cpSpaceRemoveConstraint(space_, constraint);
      cpConstraintFree(constraint);
    }
  }

  void add(const Body& body) {
    cpBody* b = body.moves ? cpBodyNew(body.mass, body.turns ? body.inertia[2] : INFINITY) : cpBodyNewStatic();
    cpBodySetPosition(b, vec(body.start.x));
    cpBodySetAngle(b, angle(body.start.q));
    cpBodySetVelocity(b, vec(body.start.v));
    cpBodySetAngularVelocity(b, body.start.w[2]);
    bodies_.push_back(cpSpaceAddBody(space_, b));
    if (body.torque[2] != 0) torques_.emplace_back(b, body.torque[2]);
  }

  cpBody* body(int index) const {
    return index == peers::world ? cpSpaceGetStaticBody(space_) : bodies_[std::size_t(index)];
  }

  void make(cpConstraint* constraint) {
    made_->push_back(cpSpaceAddConstraint(space_, constraint));
    if (left_after_a_second_ >= 0) cpConstraintSetErrorBias(constraint, left_after_a_second_);
  }

  static double angle_of(const cpConstraint* made) {
    return cpBodyGetAngle(cpConstraintGetBodyB(made)) - cpBodyGetAngle(cpConstraintGetBodyA(made));
  }

  cpConstraint* make_motor(const Joint& joint, double speed, double most) {
    make(cpSimpleMotorNew(body(joint.a), body(joint.b), -speed));
    cpConstraintSetMaxForce(made_->back(), most);
    return made_->back();
  }

  void connect(const Problem& problem, const Joint& joint) {
    check(problem, {.mounts = true});
    cpBody *a = body(joint.a), *b = body(joint.b);
    const cpVect pa = vec(local_point(problem, joint.a, joint.anchor)),
                 pb = vec(local_point(problem, joint.b, joint.anchor_b));
    if (joint.soft) {
      if (joint.kind != JointKind::revolute) throw CannotSay("no joint that gives like a spring but a spring");
      return make(cpDampedSpringNew(a, b, pa, pb, 0, joint.soft->stiffness, joint.soft->damping));
    }
    if (joint.kind == JointKind::contact) return touch(problem, joint);
    if (joint.kind == JointKind::pulley) throw no_such(joint);
    if (joint.kind == JointKind::distance) {
      cpConstraint* rod = cpPinJointNew(a, b, pa, pb);
      cpPinJointSetDist(rod, joint.length);
      return make(rod);
    }
    if (joint.kind == JointKind::max_distance) return make(cpSlideJointNew(a, b, pa, pb, 0, joint.length));
    if (joint.kind == JointKind::prismatic)
      make(cpGrooveJointNew(a, b, end(problem, joint, -1), end(problem, joint, 1), pb));
    else if (joint.kind != JointKind::orientation) make(cpPivotJointNew2(a, b, pa, pb));
    if (joint.kind == JointKind::prismatic || joint.kind == JointKind::fixed || joint.kind == JointKind::orientation)
      make(cpGearJointNew(a, b, cpBodyGetAngle(b) - cpBodyGetAngle(a), 1));
    if (joint.spring) add_spring(problem, joint);
    if (joint.stops) make(cpRotaryLimitJointNew(a, b, joint.stops->lower, joint.stops->upper));
    if (joint.servo) servos_.emplace_back(make_motor(joint, 0, joint.servo->most), *joint.servo);
    for (const double torque : joint.brakes) make_motor(joint, 0, torque);
    if (!joint.motor) return;
    if (joint.kind == JointKind::prismatic) throw CannotSay("no motor of a slider");
    cpConstraint* const made = make_motor(joint, joint.motor->speed, joint.motor->most);
    if (joint.motor->speed_at) motors_.emplace_back(made, *joint.motor);
  }

  // A disc on a segment. Coefficients of friction are multiplied.
  void touch(const Problem& problem, const Joint& joint) {
    constexpr double half = 100;
    const Vec3 top = joint.anchor_b - tip * joint.axis, along = cross({0, 0, half}, joint.axis);
    cpShape* const disc = cpCircleShapeNew(body(joint.a), tip, vec(local_point(problem, joint.a, joint.anchor)));
    cpShape* const line = cpSegmentShapeNew(body(joint.b), vec(top + along), vec(top - along), 0);
    cpShapeSetFriction(disc, joint.friction);
    cpShapeSetFriction(line, 1);
    for (cpShape* shape : {disc, line}) shapes_.push_back(cpSpaceAddShape(space_, shape));
    cpSpaceSetCollisionSlop(space_, 0);
  }

  // The spring of a slider, from a point far down its axis.
  void add_spring(const Problem& problem, const Joint& joint) {
    cpBody *a = body(joint.a), *b = body(joint.b);
    const Spring& spring = *joint.spring;
    if (joint.kind == JointKind::revolute)
      return make(
          cpDampedRotarySpringNew(a, b, cpBodyGetAngle(b) - cpBodyGetAngle(a), spring.stiffness, spring.damping));
    make(cpDampedSpringNew(a, b, vec(local_point(problem, joint.a, joint.anchor - joint.axis)),
                           vec(local_point(problem, joint.b, joint.anchor_b)), norm(joint.axis), spring.stiffness,
                           spring.damping));
  }

  // One end of a groove that is long enough on both sides; a point without an axis.
  static cpVect end(const Problem& problem, const Joint& joint, double side) {
    const double half = 10, length = norm(joint.axis);
    return vec(local_point(problem, joint.a, joint.anchor + (length > 0 ? side * half / length : 0) * joint.axis));
  }

  cpSpace* space_;
  std::vector<cpBody*> bodies_;
  std::vector<cpShape*> shapes_;                      // of contacts
  std::map<int, std::vector<cpConstraint*>> joints_;  // by number; the first is the constraint itself
  std::vector<cpConstraint*>* made_ = nullptr;        // of the joint in add()
  std::vector<std::pair<cpBody*, double>> torques_;
  double left_after_a_second_ = -1;  // of a joint's error; below 0: the default
  double last_;                      // step
  double time_ = 0;
  std::vector<std::pair<cpConstraint*, Motor>> motors_;  // whose speed changes
  std::vector<std::pair<cpConstraint*, Servo>> servos_;
};

std::vector<Series> series(const Problem& problem) {
  if (!problem.planar) return {};
  struct Bias {
    const char* name;
    const char* changed;
    double left;
  };
  std::vector<Series> all;
  for (const Bias& bias : {Bias{"", "", -1}, Bias{", half the error per step", ", errorBias = 0.5^(1/h)", 0.5},
                           Bias{", all the error per step", ", errorBias = 0.01^(1/h)", 0.01}}) {
    for (const int iterations : {10, 1, 2, 5, 30, 100}) {
      const std::string count = std::to_string(iterations);
      all.push_back({count + " iterations" + bias.name, "iterations " + count + bias.changed, "h", steps(problem),
                     [&problem, iterations, left = bias.left](double h) {
                       return std::make_unique<ChipmunkRun>(problem, iterations, left, h);
                     }});
    }
  }
  return all;
}

const Registration registration{{"Chipmunk", cpVersionString, "double", "#8250df",
                                 "no shapes but a disc of 0.1 mm where a contact is, which may not sink in, collision "
                                 "slop 0; a slider is a groove and a gear, a weld a pivot and a gear, a soft pin a "
                                 "damped spring, a brake a motor of speed 0, "
                                 "a servo a motor whose speed is set before each step; sleeps "
                                 "where the case does",
                                 series}};

}  // namespace
}  // namespace cdot::peers
