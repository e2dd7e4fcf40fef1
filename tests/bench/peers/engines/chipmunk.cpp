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
    cpBody* b = cpBodyNew(body.mass, body.inertia[2]);
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
    if (joint.kind != JointKind::prismatic) {
      add(cpPivotJointNew2(body(joint.a), body(joint.b), vec(local_point(problem, joint.a, joint.anchor)),
                           vec(local_point(problem, joint.b, joint.anchor_b))));
      return;
    }
    // A groove that is long enough on both sides, and equal angles.
    const double half = 10;
    const auto end = [&](double side) {
      return vec(local_point(problem, joint.a, joint.anchor + (side * half) * joint.axis));
    };
    add(cpGrooveJointNew(body(joint.a), body(joint.b), end(-1), end(1),
                         vec(local_point(problem, joint.b, joint.anchor_b))));
    const double turn = cpBodyGetAngle(body(joint.b)) - cpBodyGetAngle(body(joint.a));
    add(cpGearJointNew(body(joint.a), body(joint.b), turn, 1));
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

const Registration registration{
    {"Chipmunk", cpVersionString, "double", "#8250df", "no shapes; a slider is a groove and a gear", series}};

}  // namespace
}  // namespace cdot::peers
