// Chipmunk 7: planar, double precision, sequential impulses; joint errors are fed back into the velocities.
#include <chipmunk/chipmunk.h>

#include <cmath>
#include <string>

#include "tests/bench/peers/geometry.hpp"

namespace cdot::peers {
namespace {

cpVect vec(const Vec3& a) { return cpv(a[0], a[1]); }

// How much of a joint's error is left after a second.
double left_after_a_second(double left_per_step, double h) { return std::pow(left_per_step, 1 / h); }

class ChipmunkRun final : public SteppedRun {
 public:
  // left_per_step < 0: the default errorBias
  ChipmunkRun(const Problem& problem, int iterations, double left_per_step, double h)
      : SteppedRun(h), space_(cpSpaceNew()) {
    cpSpaceSetIterations(space_, iterations);
    cpSpaceSetGravity(space_, vec(problem.gravity));
    for (const Body& body : problem.bodies) add(body);
    for (const Joint& joint : problem.joints) add(problem, joint);
    if (left_per_step < 0) return;
    for (cpConstraint* constraint : constraints_)
      cpConstraintSetErrorBias(constraint, left_after_a_second(left_per_step, h));
  }
  ~ChipmunkRun() override {
    for (cpConstraint* constraint : constraints_) {
      cpSpaceRemoveConstraint(space_, constraint);
      cpConstraintFree(constraint);
    }
    for (cpBody* body : bodies_) {
      cpSpaceRemoveBody(space_, body);
      cpBodyFree(body);
    }
    cpSpaceFree(space_);
  }
  ChipmunkRun(const ChipmunkRun&) = delete;
  ChipmunkRun& operator=(const ChipmunkRun&) = delete;

  void step(double h) override { cpSpaceStep(space_, h); }
  State state(int body) const override {
    const cpBody* b = bodies_[std::size_t(body)];
    const cpVect x = cpBodyGetPosition(b), v = cpBodyGetVelocity(b);
    return {{x.x, x.y, 0}, about_z(cpBodyGetAngle(b)), {v.x, v.y, 0}, {0, 0, cpBodyGetAngularVelocity(b)}};
  }

 private:
  void add(const Body& body) {
    cpBody* b = cpBodyNew(body.mass, body.turns ? body.inertia[2] : INFINITY);
    cpBodySetPosition(b, vec(body.start.x));
    cpBodySetAngle(b, angle(body.start.q));
    cpBodySetVelocity(b, vec(body.start.v));
    cpBodySetAngularVelocity(b, body.start.w[2]);
    bodies_.push_back(cpSpaceAddBody(space_, b));
  }

  cpBody* body(int index) const {
    return index == peers::world ? cpSpaceGetStaticBody(space_) : bodies_[std::size_t(index)];
  }

  void add(cpConstraint* constraint) { constraints_.push_back(cpSpaceAddConstraint(space_, constraint)); }

  void add(const Problem& problem, const Joint& joint) {
    cpBody *a = body(joint.a), *b = body(joint.b);
    const cpVect pa = vec(local_point(problem, joint.a, joint.anchor)),
                 pb = vec(local_point(problem, joint.b, joint.anchor_b));
    if (joint.kind == JointKind::distance) {
      cpConstraint* rod = cpPinJointNew(a, b, pa, pb);
      cpPinJointSetDist(rod, joint.length);
      return add(rod);
    }
    if (joint.kind == JointKind::max_distance) return add(cpSlideJointNew(a, b, pa, pb, 0, joint.length));
    if (joint.kind == JointKind::prismatic)
      add(cpGrooveJointNew(a, b, end(problem, joint, -1), end(problem, joint, 1), pb));
    else
      add(cpPivotJointNew2(a, b, pa, pb));
    if (joint.kind == JointKind::prismatic || joint.kind == JointKind::fixed)
      add(cpGearJointNew(a, b, cpBodyGetAngle(b) - cpBodyGetAngle(a), 1));
    if (joint.stops) add(cpRotaryLimitJointNew(a, b, joint.stops->lower, joint.stops->upper));
    if (!joint.motor) return;
    add(cpSimpleMotorNew(a, b, -joint.motor->speed));
    cpConstraintSetMaxForce(constraints_.back(), joint.motor->most);
  }

  // Of a groove that is long enough on both sides.
  static cpVect end(const Problem& problem, const Joint& joint, double side) {
    const double half = 10;
    return vec(local_point(problem, joint.a, joint.anchor + (side * half) * joint.axis));
  }

  cpSpace* space_;
  std::vector<cpBody*> bodies_;
  std::vector<cpConstraint*> constraints_;
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
                                 "no shapes; a slider is a groove and a gear, a weld a pivot and a gear", series}};

}  // namespace
}  // namespace cdot::peers
