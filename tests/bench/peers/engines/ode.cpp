// ODE: space, double precision, constraints at velocity level: by a direct factorisation (Step) or by sweeps
// (QuickStep); joint errors are fed back.
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <map>
#include <ode/ode.h>
#include <stdexcept>
#include <string>

#include "tests/bench/peers/geometry.hpp"
#include "tests/bench/peers/words.hpp"

namespace cdot::peers {
namespace {

static_assert(sizeof(dReal) == sizeof(double));

// Changes from a new dWorld's defaults.
struct Way {
  std::string name, changed;
  int sweeps = 0;  // 0: Step
  double erp = 0.2, cfm = 1e-10;
  bool finite_rotation = false;
  bool free_first = false;  // free rotation first, in six-degree joints
};

[[noreturn]] void give_up(int, const char* format, va_list values) {
  char text[256];
  std::vsnprintf(text, sizeof text, format, values);
  throw std::runtime_error(text);
}
void ignore(int, const char*, va_list) {}

class OdeRun final : public SteppedRun {
 public:
  OdeRun(const Problem& problem, const Way& way, double h)
      : SteppedRun(h), world_(made()), sweeps_(way.sweeps), h_(h), free_first_(way.free_first) {
    check(problem, {.held_orientations = true, .two_axes = true, .mounts = true});
    dWorldSetAutoDisableFlag(world_, problem.sleep_after > 0);
    dWorldSetAutoDisableTime(world_, problem.sleep_after);
    dWorldSetGravity(world_, problem.gravity[0], problem.gravity[1], problem.gravity[2]);
    dWorldSetERP(world_, way.erp);
    dWorldSetCFM(world_, way.cfm);
    if (sweeps_ > 0) dWorldSetQuickStepNumIterations(world_, sweeps_);
    for (const Body& body : problem.bodies) add(body, way.finite_rotation);
    for (const Joint& joint : problem.joints) add(problem, joint);
  }
  ~OdeRun() override {
    dJointGroupDestroy(touching_);
    dWorldDestroy(world_);
  }
  OdeRun(const OdeRun&) = delete;
  OdeRun& operator=(const OdeRun&) = delete;

  void step(double h) override {
    for (const auto& [body, torque] : torques_) dBodyAddTorque(body, torque[0], torque[1], torque[2]);
    dJointGroupEmpty(touching_);
    for (const Contact& contact : contacts_) touch(contact);
    for (const Tuned& tuned : tuned_) tuned.set(time_, h);
    time_ += h;
    const int done = sweeps_ > 0 ? dWorldQuickStep(world_, h) : dWorldStep(world_, h);
    if (!done) throw std::runtime_error("ODE: no memory for the step");
  }
  State state(int body) const override {
    const dBodyID b = bodies_[std::size_t(body)];
    const dReal *x = dBodyGetPosition(b), *q = dBodyGetQuaternion(b), *v = dBodyGetLinearVel(b),
                *w = dBodyGetAngularVel(b);
    return {{x[0], x[1], x[2]}, {q[0], q[1], q[2], q[3]}, {v[0], v[1], v[2]}, {w[0], w[1], w[2]}};
  }

  void strike(int body, const Vec3& impulse) override {
    const dBodyID b = bodies_[std::size_t(body)];
    dMass mass;
    dBodyGetMass(b, &mass);
    const dReal* v = dBodyGetLinearVel(b);
    dBodyEnable(b);
    dBodySetLinearVel(b, v[0] + impulse[0] / mass.mass, v[1] + impulse[1] / mass.mass, v[2] + impulse[2] / mass.mass);
  }
  bool remove(int joint) override {
    for (const dJointID id : joints_.at(joint).ids) dJointDestroy(id);
    joints_.erase(joint);
    return true;
  }
  // Of a body's point on a plane, as an application makes one before each step.
  struct Contact {
    dBodyID body;
    Vec3 point, normal;  // of the body, of the world
    double height, friction;
  };
  void touch(const Contact& contact) {
    dContact made{};
    dBodyGetRelPointPos(contact.body, contact.point[0], contact.point[1], contact.point[2], made.geom.pos);
    const Vec3 at{made.geom.pos[0], made.geom.pos[1], made.geom.pos[2]};
    made.geom.depth = contact.height - dot(at, contact.normal);
    if (made.geom.depth < 0) return;
    std::copy(contact.normal.begin(), contact.normal.end(), made.geom.normal);
    made.surface.mode = dContactApprox1;
    made.surface.mu = contact.friction;
    dJointAttach(dJointCreateContact(world_, touching_, &made), contact.body, nullptr);
  }

  // ODE places a joint once for both bodies. For a joint that starts open the second body is first moved to fit.
  bool add(const Problem& problem, const Joint& joint) override {
    if (joint.kind == JointKind::contact) {
      contacts_.push_back({body(joint.a), local_point(problem, joint.a, joint.anchor), joint.axis,
                           dot(joint.anchor_b, joint.axis), joint.friction});
      return true;
    }
    const bool meets = joint.kind != JointKind::orientation && joint.kind != JointKind::distance;
    const Vec3 gap = meets ? joint.anchor_b - joint.anchor : Vec3{};
    Made& made = joints_[joint.number];
    move(body(joint.b), -1.0 * gap);
    made.ids = {connect(joint)};
    move(body(joint.b), gap);
    dJointSetFeedback(made.ids[0], made.felt.get());
    if (joint.kind == JointKind::revolute && joint.spring) made.ids.push_back(damper(joint));
    for (const double torque : joint.brakes) made.ids.push_back(brake(joint, torque));
    if (joint.kind == JointKind::revolute) tune(made.ids[0], joint);
    if (joint.kind == JointKind::prismatic && joint.motor) made.ids.push_back(belt(joint));
    if (joint.kind == JointKind::six_dof) made.ids.push_back(turns(joint));
    return true;
  }
  double force(int joint) const override { return dCalcVectorLength3(joints_.at(joint).felt->f1); }
  bool asleep(int body) const override { return !dBodyIsEnabled(bodies_[std::size_t(body)]); }

 private:
  // A number of a joint that is set before each step.
  struct Tuned {
    std::function<void(double time, double h)> set;
  };
  struct Made {
    std::vector<dJointID> ids;  // the first is the constraint itself
    std::unique_ptr<dJointFeedback> felt = std::make_unique<dJointFeedback>();
  };

  static dWorldID made() {
    [[maybe_unused]] static const int once = [] {
      dSetErrorHandler(give_up);
      dSetDebugHandler(give_up);
      dSetMessageHandler(ignore);
      return dInitODE2(0);
    }();
    return dWorldCreate();
  }

  void add(const Body& body, bool finite_rotation) {
    const State& s = body.start;
    const dBodyID b = dBodyCreate(world_);
    dMass mass;
    dMassSetParameters(&mass, body.mass, 0, 0, 0, body.inertia[0], body.inertia[1], body.inertia[2], 0, 0, 0);
    dBodySetMass(b, &mass);
    dBodySetPosition(b, s.x[0], s.x[1], s.x[2]);
    dBodySetQuaternion(b, s.q.data());
    if (!body.moves) dBodySetKinematic(b);
    dBodySetLinearVel(b, s.v[0], s.v[1], s.v[2]);
    dBodySetAngularVel(b, s.w[0], s.w[1], s.w[2]);
    dBodySetFiniteRotationMode(b, finite_rotation);
    dBodySetLinearDampingThreshold(b, 0);
    dBodySetAngularDampingThreshold(b, 0);
    dBodySetLinearDamping(b, 1 - std::exp(-body.damping * h_));
    dBodySetAngularDamping(b, 1 - std::exp(-body.damping * h_));
    if (norm(body.torque) > 0) torques_.emplace_back(b, body.torque);
    bodies_.push_back(b);
  }

  dBodyID body(int index) const { return index == peers::world ? nullptr : bodies_[std::size_t(index)]; }

  // ODE's angle is that from b to a, or from the world to b if a is the world.
  static void drive(dJointID hinge, const Joint& joint) {
    const bool forth = joint.a == peers::world;
    if (joint.motor) {
      const double speed = speed_of(*joint.motor, 0);
      dJointSetHingeParam(hinge, dParamVel, forth ? speed : -speed);
      dJointSetHingeParam(hinge, dParamFMax, joint.motor->most);
    }
    if (joint.stops) {
      dJointSetHingeParam(hinge, dParamLoStop, forth ? joint.stops->lower : -joint.stops->upper);
      dJointSetHingeParam(hinge, dParamHiStop, forth ? joint.stops->upper : -joint.stops->lower);
    }
  }

  // A motor whose speed changes, and a servo by a motor.
  void tune(dJointID hinge, const Joint& joint) {
    const double forth = joint.a == peers::world ? 1 : -1;
    const auto set = [=](double speed) { dJointSetHingeParam(hinge, dParamVel, forth * speed); };
    if (joint.motor && joint.motor->speed_at)
      tuned_.push_back({[=, motor = *joint.motor](double time, double) { set(speed_of(motor, time)); }});
    if (!joint.servo) return;
    if (joint.motor) throw CannotSay("one motor for a hinge");
    dJointSetHingeParam(hinge, dParamFMax, joint.servo->most);
    tuned_.push_back(
        {[=, servo = *joint.servo](double, double h) { set(speed_of(servo, -dJointGetHingeAngle(hinge), h)); }});
  }

  // An angular motor of speed 0, up to a torque.
  dJointID brake(const Joint& joint, double torque) {
    const dJointID made = dJointCreateAMotor(world_, nullptr);
    dJointAttach(made, body(joint.a), body(joint.b));
    dJointSetAMotorNumAxes(made, 1);
    dJointSetAMotorAxis(made, 0, joint.a == peers::world ? 2 : 1, joint.axis[0], joint.axis[1], joint.axis[2]);
    dJointSetAMotorParam(made, dParamFMax, torque);
    return made;
  }

  // The same with the softness of a damper.
  dJointID damper(const Joint& joint) {
    if (joint.spring->stiffness != 0) throw CannotSay("no spring of a hinge");
    const dJointID made = brake(joint, dInfinity);
    dJointSetAMotorParam(made, dParamCFM, 1 / joint.spring->damping);
    return made;
  }

  // A linear motor along a slider, whose own motor does not act beside a spring.
  dJointID belt(const Joint& joint) {
    if (joint.motor->speed_at) throw CannotSay("the adapter changes the speed of hinges only");
    const dJointID made = dJointCreateLMotor(world_, nullptr);
    attach(made, joint);
    dJointSetLMotorNumAxes(made, 1);
    const Vec3 axis = (1 / norm(joint.axis)) * joint.axis;
    dJointSetLMotorAxis(made, 0, 1, axis[0], axis[1], axis[2]);
    dJointSetLMotorParam(made, dParamVel, forth(joint) ? joint.motor->speed : -joint.motor->speed);
    dJointSetLMotorParam(made, dParamFMax, joint.motor->most);
    return made;
  }

  // By ODE's manual equal stops with ERP and CFM act as a spring.
  double erp(const Spring& spring) const { return h_ * spring.stiffness / (h_ * spring.stiffness + spring.damping); }
  double cfm(const Spring& spring) const { return 1 / (h_ * spring.stiffness + spring.damping); }

  dJointID ball(const Joint& joint) {
    const dJointID made = dJointCreateBall(world_, nullptr);
    dJointAttach(made, body(joint.a), body(joint.b));
    dJointSetBallAnchor(made, joint.anchor[0], joint.anchor[1], joint.anchor[2]);
    if (joint.soft) dJointSetBallParam(made, dParamERP, erp(*joint.soft));
    if (joint.soft) dJointSetBallParam(made, dParamCFM, cfm(*joint.soft));
    return made;
  }

  dJointID hinge(const Joint& joint) {
    const dJointID made = dJointCreateHinge(world_, nullptr);
    dJointAttach(made, body(joint.a), body(joint.b));
    dJointSetHingeAnchor(made, joint.anchor[0], joint.anchor[1], joint.anchor[2]);
    dJointSetHingeAxis(made, joint.axis[0], joint.axis[1], joint.axis[2]);
    drive(made, joint);
    return made;
  }

  dJointID slider(const Joint& joint) {
    const dJointID made = dJointCreateSlider(world_, nullptr);
    dJointAttach(made, body(joint.a), body(joint.b));
    dJointSetSliderAxis(made, joint.axis[0], joint.axis[1], joint.axis[2]);
    if (!joint.spring) return made;
    dJointSetSliderParam(made, dParamLoStop, 0);
    dJointSetSliderParam(made, dParamHiStop, 0);
    dJointSetSliderParam(made, dParamStopERP, erp(*joint.spring));
    dJointSetSliderParam(made, dParamStopCFM, cfm(*joint.spring));
    return made;
  }

  // The first body must not be the world; angles are those from the second body to the first.
  bool forth(const Joint& joint) const { return joint.a == peers::world; }
  void attach(dJointID made, const Joint& joint) {
    dJointAttach(made, body(forth(joint) ? joint.b : joint.a), body(forth(joint) ? joint.a : joint.b));
  }

  dJointID universal(const Joint& joint) {
    const dJointID made = dJointCreateUniversal(world_, nullptr);
    attach(made, joint);
    const Turn &one = joint.turns[forth(joint) ? 1 : 0], &other = joint.turns[forth(joint) ? 0 : 1];
    dJointSetUniversalAnchor(made, joint.anchor[0], joint.anchor[1], joint.anchor[2]);
    dJointSetUniversalAxis1(made, one.axis[0], one.axis[1], one.axis[2]);
    dJointSetUniversalAxis2(made, other.axis[0], other.axis[1], other.axis[2]);
    for (const auto& [turn, group] : {std::pair{&one, dParamGroup1}, {&other, dParamGroup2}}) {
      for (const int stop : {dParamLoStop, dParamHiStop})
        if (turn->held) dJointSetUniversalParam(made, group + stop, 0);
      if (!turn->motor) continue;
      dJointSetUniversalParam(made, group + dParamVel, forth(joint) ? turn->motor->speed : -turn->motor->speed);
      dJointSetUniversalParam(made, group + dParamFMax, turn->motor->most);
    }
    return made;
  }

  // An angular motor for the rotations, beside a ball joint.
  dJointID turns(const Joint& joint) {
    std::vector<Turn> all = turns_of(joint, free_first_);
    if (forth(joint)) std::reverse(all.begin(), all.end());
    const dJointID made = dJointCreateAMotor(world_, nullptr);
    attach(made, joint);
    dJointSetAMotorMode(made, dAMotorEuler);
    for (const int k : {0, 2}) {
      const Vec3& axis = all[std::size_t(k)].axis;
      dJointSetAMotorAxis(made, k, k == 0 ? 1 : 2, axis[0], axis[1], axis[2]);
    }
    const int groups[] = {dParamGroup1, dParamGroup2, dParamGroup3};
    for (std::size_t k = 0; k < all.size(); ++k)
      for (const int stop : {dParamLoStop, dParamHiStop})
        if (all[k].held) dJointSetAMotorParam(made, groups[k] + stop, 0);
    return made;
  }

  dJointID rod(const Joint& joint) {
    const dJointID made = dJointCreateDBall(world_, nullptr);
    attach(made, joint);
    const Vec3 &one = forth(joint) ? joint.anchor_b : joint.anchor,
               &other = forth(joint) ? joint.anchor : joint.anchor_b;
    dJointSetDBallAnchor1(made, one[0], one[1], one[2]);
    dJointSetDBallAnchor2(made, other[0], other[1], other[2]);
    dJointSetDBallDistance(made, joint.length);
    return made;
  }

  // An angular motor with stops at its three present angles.
  dJointID orientation(const Joint& joint) {
    const dJointID made = dJointCreateAMotor(world_, nullptr);
    dJointAttach(made, body(joint.a), body(joint.b));
    dJointSetAMotorMode(made, dAMotorEuler);
    dJointSetAMotorAxis(made, 0, 1, 1, 0, 0);
    dJointSetAMotorAxis(made, 2, 2, 0, 0, 1);
    for (const int group : {dParamGroup1, dParamGroup2, dParamGroup3})
      for (const int stop : {dParamLoStop, dParamHiStop}) dJointSetAMotorParam(made, group + stop, 0);
    return made;
  }

  static void move(dBodyID b, const Vec3& by) {
    if (b == nullptr || norm(by) == 0) return;
    const dReal* x = dBodyGetPosition(b);
    dBodySetPosition(b, x[0] + by[0], x[1] + by[1], x[2] + by[2]);
  }

  // A soft hinge becomes a soft ball joint: ODE's hinges have no softness.
  dJointID connect(const Joint& joint) {
    if (joint.soft && joint.kind != JointKind::revolute) throw CannotSay("no soft joint but a ball");
    if (joint.kind == JointKind::spherical || joint.kind == JointKind::six_dof || joint.soft) return ball(joint);
    if (joint.kind == JointKind::revolute) return hinge(joint);
    if (joint.kind == JointKind::prismatic) return slider(joint);
    if (joint.kind == JointKind::orientation) return orientation(joint);
    if (joint.kind == JointKind::universal) return universal(joint);
    if (joint.kind == JointKind::distance) return rod(joint);
    if (joint.kind != JointKind::fixed) throw no_such(joint);
    const dJointID made = dJointCreateFixed(world_, nullptr);
    dJointAttach(made, body(joint.a), body(joint.b));
    dJointSetFixed(made);
    return made;
  }

  dWorldID world_;
  int sweeps_;
  double h_;
  bool free_first_;
  std::vector<dBodyID> bodies_;
  std::map<int, Made> joints_;  // by number
  std::vector<std::pair<dBodyID, Vec3>> torques_;
  std::vector<Tuned> tuned_;
  std::vector<Contact> contacts_;
  dJointGroupID touching_ = dJointGroupCreate(0);  // of a step
  double time_ = 0;
};

std::vector<Series> series(const Problem& problem) {
  const std::vector<Way> ways{
      {"Step", ""},
      {"QuickStep, 20 sweeps", "", 20},
      {"QuickStep, 5 sweeps", "5 iterations", 5},
      {"Step, ERP 0.8", "ERP 0.8", 0, 0.8},
      {"Step, ERP 0.8, CFM 0", "ERP 0.8, CFM 0", 0, 0.8, 0},
      {"Step, finite rotation", "finite rotation mode", 0, 0.2, 1e-10, true},
  };
  std::vector<Series> all;
  for (const Way& way : with_free_turns_first(problem, ways))
    all.push_back({way.name, way.changed, "h", steps(problem),
                   [&problem, way](double h) { return std::make_unique<OdeRun>(problem, way, h); }});
  return all;
}

const Registration registration{{"ODE", "0.16.2", "double", "#0a7ea4",
                                 "CFM 1e-10 is its default; no geometry, a contact is made of depth 0 or more; springs "
                                 "and dampers by ERP and CFM, a soft "
                                 "pin is a soft ball; a brake is an angular "
                                 "motor, a servo a motor whose speed is set before each step; sleeps "
                                 "where the case does",
                                 series}};

}  // namespace
}  // namespace cdot::peers
