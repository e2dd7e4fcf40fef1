// Box2D 2.4: planar, single precision, sequential impulses and a pass over positions.
#include <box2d/box2d.h>
#include <map>
#include <string>
#include <utility>

#include "tests/bench/peers/geometry.hpp"
#include "tests/bench/peers/words.hpp"

namespace cdot::peers {
namespace {

b2Vec2 vec(const Vec3& a) { return {float(a[0]), float(a[1])}; }

class Box2dRun final : public SteppedRun {
 public:
  Box2dRun(const Problem& problem, int velocity_iterations, int position_iterations, double h)
      : SteppedRun(h),
        world_(vec(problem.gravity)),
        velocity_iterations_(velocity_iterations),
        position_iterations_(position_iterations),
        last_(h) {
    world_.SetAllowSleeping(problem.sleep_after > 0);
    world_.SetContinuousPhysics(false);
    const b2BodyDef ground;
    ground_ = world_.CreateBody(&ground);
    for (const Body& body : problem.bodies) add(body);
    for (const Joint& joint : problem.joints) add(problem, joint);
    for (std::size_t k = 0; k < problem.bodies.size(); ++k)
      if (problem.bodies[k].torque[2] != 0) torques_.emplace_back(bodies_[k], float(problem.bodies[k].torque[2]));
  }

  State state(int body) const override {
    const b2Body& b = *bodies_[std::size_t(body)];
    const b2Vec2 x = b.GetWorldCenter(), v = b.GetLinearVelocity();
    return {{x.x, x.y, 0}, about_z(b.GetAngle()), {v.x, v.y, 0}, {0, 0, b.GetAngularVelocity()}};
  }
  void step(double h) override {
    for (const auto& [body, torque] : torques_) body->ApplyTorque(torque, true);
    tune_motors(h);
    for (const auto& [hinge, damping] : dampers_) {
      const float torque = damping * hinge->GetJointSpeed();
      hinge->GetBodyA()->ApplyTorque(torque, true);
      hinge->GetBodyB()->ApplyTorque(-torque, true);
    }
    world_.Step(float(h), velocity_iterations_, position_iterations_);
    last_ = h;
    time_ += h;
  }

  void strike(int body, const Vec3& impulse) override {
    bodies_[std::size_t(body)]->ApplyLinearImpulseToCenter(vec(impulse), true);
  }
  bool remove(int joint) override {
    for (b2Joint* made : joints_[joint]) world_.DestroyJoint(made);
    joints_[joint].clear();
    return true;
  }
  double force(int joint) const override {
    return double(joints_.at(joint).front()->GetReactionForce(float(1 / last_)).Length());
  }
  bool asleep(int body) const override { return !bodies_[std::size_t(body)]->IsAwake(); }

  bool add(const Problem& problem, const Joint& joint) override {
    made_ = &joints_[joint.number];
    connect(problem, joint);
    return true;
  }

 private:
  void tune_motors(double h) {
    for (const auto& [hinge, motor] : motors_) hinge->SetMotorSpeed(float(speed_of(motor, time_)));
    for (const auto& [hinge, servo] : servos_)
      hinge->SetMotorSpeed(float(speed_of(servo, hinge->GetJointAngle() + hinge->GetReferenceAngle(), h)));
  }

  void add(const Body& body) {
    b2BodyDef def;
    def.type = body.moves ? b2_dynamicBody : b2_staticBody;
    def.position = vec(body.start.x);
    def.angle = float(angle(body.start.q));
    def.linearVelocity = vec(body.start.v);
    def.angularVelocity = float(body.start.w[2]);
    def.fixedRotation = !body.turns;
    def.linearDamping = def.angularDamping = float(body.damping);
    b2Body* made = world_.CreateBody(&def);
    b2MassData mass;
    mass.mass = float(body.mass);
    mass.center.SetZero();
    mass.I = float(body.inertia[2]);
    made->SetMassData(&mass);
    bodies_.push_back(made);
  }

  b2Body* body(int index) const { return index == peers::world ? ground_ : bodies_[std::size_t(index)]; }

  template <class Def>
  b2Joint* make(const Def& def) {
    return made_->emplace_back(world_.CreateJoint(&def));
  }
  template <class Def>
  b2Joint* make(Def& def, const Problem& problem, const Joint& joint) {
    def.localAnchorB = vec(local_point(problem, joint.b, joint.anchor_b));
    return make(def);
  }

  void connect(const Problem& problem, const Joint& joint) {
    check(problem, {.mounts = true});
    b2Body *a = body(joint.a), *b = body(joint.b);
    const b2Vec2 at = vec(joint.anchor);
    if (joint.kind == JointKind::contact) {
      add_contact(problem, joint);
    } else if (joint.soft) {
      hold_softly(joint);
    } else if (joint.kind == JointKind::prismatic) {
      b2PrismaticJointDef def;
      def.Initialize(a, b, at, vec(joint.axis));
      if ((def.enableMotor = joint.motor.has_value())) {
        def.motorSpeed = float(speed_of(*joint.motor, 0));
        def.maxMotorForce = float(joint.motor->most);
      }
      make(def, problem, joint);
      if (joint.spring) add_spring(joint);
    } else if (joint.kind == JointKind::revolute) {
      add_hinge(problem, joint);
    } else if (joint.kind == JointKind::fixed) {
      b2WeldJointDef def;
      def.Initialize(a, b, at);
      make(def, problem, joint);
    } else if (joint.kind == JointKind::pulley) {
      b2PulleyJointDef def;
      def.Initialize(a, b, vec(joint.wheel), vec(joint.wheel_b), at, vec(joint.anchor_b), float(joint.ratio));
      make(def);
    } else if (joint.kind == JointKind::orientation) {
      b2MotorJointDef def;
      def.Initialize(a, b);
      def.maxForce = 0;
      def.maxTorque = b2_maxFloat;
      make(def);
    } else {
      b2DistanceJointDef def;
      def.Initialize(a, b, at, vec(joint.anchor_b));
      def.length = def.maxLength = float(joint.length);
      def.minLength = joint.kind == JointKind::distance ? def.length : 0;
      make(def, problem, joint);
    }
  }

  void add_hinge(const Problem& problem, const Joint& joint) {
    b2RevoluteJointDef def;
    def.Initialize(body(joint.a), body(joint.b), vec(joint.anchor));
    if ((def.enableMotor = joint.motor.has_value())) {
      def.motorSpeed = float(speed_of(*joint.motor, 0));
      def.maxMotorTorque = float(joint.motor->most);
    }
    if (joint.servo) {
      if (joint.motor) throw CannotSay("one motor for a hinge");
      def.enableMotor = true;
      def.maxMotorTorque = float(joint.servo->most);
    }
    if ((def.enableLimit = joint.stops.has_value())) {
      def.lowerAngle = float(joint.stops->lower) - def.referenceAngle;
      def.upperAngle = float(joint.stops->upper) - def.referenceAngle;
    }
    auto* const hinge = static_cast<b2RevoluteJoint*>(make(def, problem, joint));
    if (joint.motor && joint.motor->speed_at) motors_.emplace_back(hinge, *joint.motor);
    if (joint.servo) servos_.emplace_back(hinge, *joint.servo);
    for (const double torque : joint.brakes) add_brake(joint, torque);
    if (!joint.spring) return;
    if (joint.spring->stiffness != 0) throw CannotSay("no spring of a hinge");
    dampers_.emplace_back(hinge, float(joint.spring->damping));
  }

  // A disc on an edge, which has a skin.
  void add_contact(const Problem& problem, const Joint& joint) {
    b2CircleShape disc;
    disc.m_radius = float(tip);
    disc.m_p = vec(local_point(problem, joint.a, joint.anchor));
    constexpr double half = 100;
    const Vec3 top = joint.anchor_b - (tip + b2_polygonRadius) * joint.axis, along = cross({0, 0, half}, joint.axis);
    b2EdgeShape edge;
    edge.SetTwoSided(vec(top + along), vec(top - along));
    b2FixtureDef def;
    def.friction = float(joint.friction);
    for (const auto& [owner, shape] : {std::pair<b2Body*, b2Shape*>{body(joint.a), &disc}, {ground_, &edge}}) {
      def.shape = shape;
      owner->CreateFixture(&def);
    }
  }

  void add_brake(const Joint& joint, double torque) {
    b2FrictionJointDef def;
    def.Initialize(body(joint.a), body(joint.b), vec(joint.anchor));
    def.maxTorque = float(torque);
    make(def);
  }

  // The spring of a slider: a soft distance joint from a point far down its axis.
  void add_spring(const Joint& joint) {
    b2DistanceJointDef def;
    def.Initialize(body(joint.a), body(joint.b), vec(joint.anchor - joint.axis), vec(joint.anchor));
    def.minLength = 0;
    def.maxLength = b2_maxFloat;
    def.stiffness = float(joint.spring->stiffness);
    def.damping = float(joint.spring->damping);
    make(def);
  }

  // A mouse joint to the world.
  void hold_softly(const Joint& joint) {
    if (joint.kind != JointKind::revolute || joint.a != peers::world)
      throw CannotSay("no joint that gives like a spring but a mouse joint's pin to the world");
    b2MouseJointDef def;
    def.bodyA = ground_;
    def.bodyB = body(joint.b);
    def.target = vec(joint.anchor);
    def.maxForce = b2_maxFloat;
    def.stiffness = float(joint.soft->stiffness);
    def.damping = float(joint.soft->damping);
    make(def);
  }

  b2World world_;
  int velocity_iterations_, position_iterations_;
  b2Body* ground_ = nullptr;
  double last_;  // step
  double time_ = 0;
  std::vector<b2Body*> bodies_;
  std::map<int, std::vector<b2Joint*>> joints_;  // by number; the first is the constraint itself
  std::vector<b2Joint*>* made_ = nullptr;        // of the joint in add()
  std::vector<std::pair<b2Body*, float>> torques_;
  std::vector<std::pair<b2RevoluteJoint*, float>> dampers_;
  std::vector<std::pair<b2RevoluteJoint*, Motor>> motors_;  // whose speed changes
  std::vector<std::pair<b2RevoluteJoint*, Servo>> servos_;
};

std::vector<Series> series(const Problem& problem) {
  if (!problem.planar) return {};
  std::vector<Series> all;
  for (const auto& [velocity, position] : {std::pair{8, 3}, {1, 1}, {2, 1}, {4, 2}, {20, 10}, {50, 1}, {100, 50}}) {
    const std::string name = "(" + std::to_string(velocity) + ", " + std::to_string(position) + ")";
    all.push_back(
        {name, "iterations (velocity, position) " + name, "h", steps(problem),
         [&problem, v = velocity, p = position](double h) { return std::make_unique<Box2dRun>(problem, v, p, h); }});
  }
  return all;
}

// The library still reports version 2.4.0.
const Registration registration{
    {"Box2D", "2.4.1", "float", "#1f6feb",
     "no shapes but a disc of 0.1 mm where a contact is; continuous collision off; sleeps where the case does; a "
     "damper of a hinge is a torque put on "
     "before each step, a spring of a slider a distance joint, a soft pin a mouse joint, a brake a friction joint, a "
     "servo a motor "
     "whose speed is set before each step",
     series}};

}  // namespace
}  // namespace cdot::peers
