// Box2D 2.4: planar, single precision, sequential impulses and a pass over positions.
#include <box2d/box2d.h>

#include <string>
#include <utility>

#include "tests/bench/peers/geometry.hpp"

namespace cdot::peers {
namespace {

b2Vec2 vec(const Vec3& a) { return {float(a[0]), float(a[1])}; }

class Box2dRun final : public SteppedRun {
 public:
  Box2dRun(const Problem& problem, int velocity_iterations, int position_iterations, double h)
      : SteppedRun(h),
        world_(vec(problem.gravity)),
        velocity_iterations_(velocity_iterations),
        position_iterations_(position_iterations) {
    world_.SetAllowSleeping(false);
    world_.SetContinuousPhysics(false);
    const b2BodyDef ground;
    ground_ = world_.CreateBody(&ground);
    for (const Body& body : problem.bodies) add(body);
    for (const Joint& joint : problem.joints) add(problem, joint);
  }

  State state(int body) const override {
    const b2Body& b = *bodies_[std::size_t(body)];
    const b2Vec2 x = b.GetWorldCenter(), v = b.GetLinearVelocity();
    return {{x.x, x.y, 0}, about_z(b.GetAngle()), {v.x, v.y, 0}, {0, 0, b.GetAngularVelocity()}};
  }
  void step(double h) override { world_.Step(float(h), velocity_iterations_, position_iterations_); }

 private:
  void add(const Body& body) {
    b2BodyDef def;
    def.type = b2_dynamicBody;
    def.position = vec(body.start.x);
    def.angle = float(angle(body.start.q));
    def.linearVelocity = vec(body.start.v);
    def.angularVelocity = float(body.start.w[2]);
    def.fixedRotation = !body.turns;
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
  void add(Def& def, const Problem& problem, const Joint& joint) {
    def.localAnchorB = vec(local_point(problem, joint.b, joint.anchor_b));
    world_.CreateJoint(&def);
  }

  void add(const Problem& problem, const Joint& joint) {
    b2Body *a = body(joint.a), *b = body(joint.b);
    const b2Vec2 at = vec(joint.anchor);
    if (joint.kind == JointKind::prismatic) {
      b2PrismaticJointDef def;
      def.Initialize(a, b, at, vec(joint.axis));
      add(def, problem, joint);
    } else if (joint.kind == JointKind::revolute) {
      b2RevoluteJointDef def;
      def.Initialize(a, b, at);
      if ((def.enableMotor = joint.motor.has_value())) {
        def.motorSpeed = float(joint.motor->speed);
        def.maxMotorTorque = float(joint.motor->most);
      }
      if ((def.enableLimit = joint.stops.has_value())) {
        def.lowerAngle = float(joint.stops->lower) - def.referenceAngle;
        def.upperAngle = float(joint.stops->upper) - def.referenceAngle;
      }
      add(def, problem, joint);
    } else if (joint.kind == JointKind::fixed) {
      b2WeldJointDef def;
      def.Initialize(a, b, at);
      add(def, problem, joint);
    } else {
      b2DistanceJointDef def;
      def.Initialize(a, b, at, vec(joint.anchor_b));
      def.length = def.maxLength = float(joint.length);
      def.minLength = joint.kind == JointKind::distance ? def.length : 0;
      add(def, problem, joint);
    }
  }

  b2World world_;
  int velocity_iterations_, position_iterations_;
  b2Body* ground_ = nullptr;
  std::vector<b2Body*> bodies_;
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

// The library calls itself 2.4.0 still.
const Registration registration{
    {"Box2D", "2.4.1", "float", "#1f6feb", "no shapes; sleeping and continuous collision off", series}};

}  // namespace
}  // namespace cdot::peers
