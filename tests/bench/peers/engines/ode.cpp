// ODE: space, double precision, constraints at velocity level: by a direct factorisation (Step) or by sweeps
// (QuickStep); joint errors are fed back.
#include <ode/ode.h>

#include <cstdarg>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "tests/bench/peers/geometry.hpp"

namespace cdot::peers {
namespace {

static_assert(sizeof(dReal) == sizeof(double));

// What differs from a new dWorld.
struct Way {
  std::string name, changed;
  int sweeps = 0;  // 0: Step
  double erp = 0.2, cfm = 1e-10;
  bool finite_rotation = false;
};

[[noreturn]] void give_up(int, const char* format, va_list values) {
  char text[256];
  std::vsnprintf(text, sizeof text, format, values);
  throw std::runtime_error(text);
}
void ignore(int, const char*, va_list) {}

class OdeRun final : public SteppedRun {
 public:
  OdeRun(const Problem& problem, const Way& way, double h) : SteppedRun(h), world_(made()), sweeps_(way.sweeps) {
    need_all_turn(problem);
    dWorldSetGravity(world_, problem.gravity[0], problem.gravity[1], problem.gravity[2]);
    dWorldSetERP(world_, way.erp);
    dWorldSetCFM(world_, way.cfm);
    if (sweeps_ > 0) dWorldSetQuickStepNumIterations(world_, sweeps_);
    for (const Body& body : problem.bodies) add(body, way.finite_rotation);
    for (const Joint& joint : problem.joints) add(joint);
  }
  ~OdeRun() override { dWorldDestroy(world_); }
  OdeRun(const OdeRun&) = delete;
  OdeRun& operator=(const OdeRun&) = delete;

  void step(double h) override {
    if (sweeps_ > 0)
      dWorldQuickStep(world_, h);
    else
      dWorldStep(world_, h);
  }
  State state(int body) const override {
    const dBodyID b = bodies_[std::size_t(body)];
    const dReal *x = dBodyGetPosition(b), *q = dBodyGetQuaternion(b), *v = dBodyGetLinearVel(b),
                *w = dBodyGetAngularVel(b);
    return {{x[0], x[1], x[2]}, {q[0], q[1], q[2], q[3]}, {v[0], v[1], v[2]}, {w[0], w[1], w[2]}};
  }

 private:
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
    dBodySetLinearVel(b, s.v[0], s.v[1], s.v[2]);
    dBodySetAngularVel(b, s.w[0], s.w[1], s.w[2]);
    dBodySetFiniteRotationMode(b, finite_rotation);
    bodies_.push_back(b);
  }

  dBodyID body(int index) const { return index == peers::world ? nullptr : bodies_[std::size_t(index)]; }

  // A joint is told where it is, once for both bodies: one that starts open is made with the second where it would fit.
  void add(const Joint& joint) {
    const Vec3 gap = joint.anchor_b - joint.anchor;
    move(body(joint.b), -1.0 * gap);
    connect(joint);
    move(body(joint.b), gap);
  }

  // Its angle counts from b to a, but from the world to b where the world is a.
  static void drive(dJointID hinge, const Joint& joint) {
    const bool forth = joint.a == peers::world;
    if (joint.motor) {
      dJointSetHingeParam(hinge, dParamVel, forth ? joint.motor->speed : -joint.motor->speed);
      dJointSetHingeParam(hinge, dParamFMax, joint.motor->most);
    }
    if (joint.stops) {
      dJointSetHingeParam(hinge, dParamLoStop, forth ? joint.stops->lower : -joint.stops->upper);
      dJointSetHingeParam(hinge, dParamHiStop, forth ? joint.stops->upper : -joint.stops->lower);
    }
  }

  static void move(dBodyID b, const Vec3& by) {
    if (b == nullptr || norm(by) == 0) return;
    const dReal* x = dBodyGetPosition(b);
    dBodySetPosition(b, x[0] + by[0], x[1] + by[1], x[2] + by[2]);
  }

  void connect(const Joint& joint) {
    const Vec3 &p = joint.anchor, &n = joint.axis;
    const dBodyID a = body(joint.a), b = body(joint.b);
    if (joint.kind == JointKind::spherical) {
      const dJointID made = dJointCreateBall(world_, nullptr);
      dJointAttach(made, a, b);
      dJointSetBallAnchor(made, p[0], p[1], p[2]);
    } else if (joint.kind == JointKind::revolute) {
      const dJointID made = dJointCreateHinge(world_, nullptr);
      dJointAttach(made, a, b);
      dJointSetHingeAnchor(made, p[0], p[1], p[2]);
      dJointSetHingeAxis(made, n[0], n[1], n[2]);
      drive(made, joint);
    } else if (joint.kind == JointKind::fixed) {
      const dJointID made = dJointCreateFixed(world_, nullptr);
      dJointAttach(made, a, b);
      dJointSetFixed(made);
    } else if (joint.kind == JointKind::prismatic) {
      const dJointID made = dJointCreateSlider(world_, nullptr);
      dJointAttach(made, a, b);
      dJointSetSliderAxis(made, n[0], n[1], n[2]);
    } else {
      throw CannotSay("no joint that keeps a distance");
    }
  }

  dWorldID world_;
  int sweeps_;
  std::vector<dBodyID> bodies_;
};

std::vector<Series> series(const Problem& problem) {
  std::vector<Series> all;
  for (const Way& way : {
           Way{"Step", ""},
           Way{"Step, ERP 0.8", "ERP 0.8", 0, 0.8},
           Way{"Step, ERP 0.8, CFM 0", "ERP 0.8, CFM 0", 0, 0.8, 0},
           Way{"Step, finite rotation", "finite rotation mode", 0, 0.2, 1e-10, true},
           Way{"QuickStep, 20 sweeps", "", 20},
           Way{"QuickStep, 5 sweeps", "5 iterations", 5},
       })
    all.push_back({way.name, way.changed, "h", steps(problem),
                   [&problem, way](double h) { return std::make_unique<OdeRun>(problem, way, h); }});
  return all;
}

const Registration registration{
    {"ODE", "0.16.2", "double", "#0a7ea4", "CFM 1e-10 is its default; no geometry", series}};

}  // namespace
}  // namespace cdot::peers
