// Simbody: space, double precision, minimal coordinates, integrators that control their error; projected constraints
// close loops.
#include <Simbody.h>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <string>
#include <utility>

#include "tests/bench/peers/engines/simbody_damper.hpp"
#include "tests/bench/peers/tree.hpp"
#include "tests/bench/peers/words.hpp"

namespace cdot::peers {
namespace {

SimTK::Rotation rotation(const Quaternion& q) { return SimTK::Rotation(SimTK::Quaternion(q[0], q[1], q[2], q[3])); }

constexpr double stop_stiffness = 1e6, stop_dissipation = 100;  // [N m/rad], [s/rad]

// The limit of internal steps per requested step; lower if that would take hours.
int most_steps(const Problem& problem) { return problem.bodies.size() > 50 ? 100 : 1000; }

struct Way {
  std::string name, changed;
  enum Kind { merson, feldberg, rk3, cpodes, euler } kind;
  bool free_first = false;  // free rotation first, in six-degree joints
};

class SimbodyRun final : public Run {
 public:
  SimbodyRun(const Problem& problem, const Way& way, double knob)
      : matter_(system_),
        forces_(system_),
        gravity_(forces_, matter_, vec(problem.gravity)),
        bodies_(problem.bodies.size()),
        free_first_(way.free_first),
        most_steps_(most_steps(problem)) {
    Lacks lacks;
    lacks.held_orientations = lacks.sleep = lacks.two_axes = lacks.brakes = lacks.servos = lacks.contacts = true;
    check(problem, lacks);
    const Tree tree = tree_of(problem);
    for (const Branch& branch : tree.branches) {
      add(problem, branch);
      add_forces(problem, branch);
    }
    for (const int loop : tree.loops) close(problem, tree, problem.joints[std::size_t(loop)]);
    SimTK::State state = system_.realizeTopology();
    system_.realizeModel(state);
    for (const Branch& branch : tree.branches) {
      system_.realize(state, SimTK::Stage::Position);
      set_velocity(problem, branch, state);
    }
    make_compatible(state);
    choose(way, knob);
    integrator_->setAllowInterpolation(false);
    integrator_->initialize(state);
  }

  void advance(double to) override {
    while (integrator_->getTime() < to)
      if (integrator_->stepTo(to) == SimTK::Integrator::ReachedStepLimit)
        throw std::runtime_error(fmt::format("takes more than {} steps of its own in one", most_steps_));
  }

  void step(double by) override {
    integrator_->setInternalStepLimit(most_steps_);
    start_motors();
    advance(integrator_->getTime() + by);
  }

  State state(int body) const override {
    const SimTK::State& s = integrator_->getState();
    system_.realize(s, SimTK::Stage::Velocity);
    const SimTK::MobilizedBody& b = bodies_[std::size_t(body)];
    const SimTK::Quaternion q = b.getBodyRotation(s).convertRotationToQuaternion();
    return {vec(b.getBodyOriginLocation(s)),
            {q[0], q[1], q[2], q[3]},
            vec(b.getBodyOriginVelocity(s)),
            vec(b.getBodyAngularVelocity(s))};
  }

  // An impulse changes velocities by M^-1 J^T impulse.
  void strike(int body, const Vec3& impulse) override {
    SimTK::State& s = integrator_->updAdvancedState();
    system_.realize(s, SimTK::Stage::Velocity);
    SimTK::Vector generalised, jump;
    matter_.multiplyByStationJacobianTranspose(s, bodies_[std::size_t(body)].getMobilizedBodyIndex(), SimTK::Vec3(0),
                                               vec(impulse), generalised);
    matter_.multiplyByMInv(s, generalised, jump);
    s.updU() += jump;
    integrator_->reinitialize(SimTK::Stage::Velocity, false);
  }

  double force(int joint) const override {
    const auto held = held_by_.find(joint);
    if (held == held_by_.end()) throw CannotSay("the adapter does not read what a loop carries");
    const SimTK::State& s = integrator_->getState();
    system_.realize(s, SimTK::Stage::Acceleration);
    SimTK::Vector_<SimTK::SpatialVec> all;
    matter_.calcMobilizerReactionForces(s, all);
    return all[bodies_[std::size_t(held->second)].getMobilizedBodyIndex()][1].norm();
  }

 private:
  SimTK::MobilizedBody& mobile(int body) {
    return body == peers::world ? static_cast<SimTK::MobilizedBody&>(matter_.Ground()) : bodies_[std::size_t(body)];
  }

  // The frame of a joint in the world at the start, expressed in a body's frame.
  static SimTK::Transform frame(const Problem& problem, int body, const SimTK::Rotation& axes, const Vec3& anchor) {
    const Quaternion q = body == peers::world ? Quaternion{1, 0, 0, 0} : problem.bodies[std::size_t(body)].start.q;
    return {SimTK::Rotation(~rotation(q) * axes), vec(local_point(problem, body, anchor))};
  }

  void add(const Problem& problem, const Branch& branch) {
    const Body& body = problem.bodies[std::size_t(branch.body)];
    const SimTK::Body::Rigid rigid(SimTK::MassProperties(body.mass, SimTK::Vec3(0), SimTK::Inertia(vec(body.inertia))));
    SimTK::MobilizedBody& parent = mobile(branch.parent);
    SimTK::MobilizedBody& made = bodies_[std::size_t(branch.body)];
    if (branch.joint < 0) {
      const SimTK::Transform start(rotation(body.start.q), vec(body.start.x));
      if (body.moves) made = SimTK::MobilizedBody::Free(parent, start, rigid, SimTK::Transform());
      else made = SimTK::MobilizedBody::Weld(parent, start, rigid, SimTK::Transform());
      return;
    }
    const Joint& joint = problem.joints[std::size_t(branch.joint)];
    held_by_[joint.number] = branch.body;
    const auto both = [&](const SimTK::Rotation& axes) {
      return std::pair{frame(problem, branch.parent, axes, joint.anchor),
                       frame(problem, branch.body, axes, joint.anchor)};
    };
    if (!joint.turns.empty()) {
      add_turning(problem, branch, rigid);
    } else if (joint.kind == JointKind::fixed) {
      const auto [in, out] = both(SimTK::Rotation());
      made = SimTK::MobilizedBody::Weld(parent, in, rigid, out);
    } else if (joint.kind == JointKind::spherical) {
      const auto [in, out] = both(SimTK::Rotation());
      made = SimTK::MobilizedBody::Ball(parent, in, rigid, out);
    } else if (joint.kind == JointKind::mount) {
      if (joint.b != branch.body) throw CannotSay("the adapter knows mounts of leaves only");
      const SimTK::Rotation axes(SimTK::UnitVec3(vec(joint.axis)), SimTK::XAxis);
      made = SimTK::MobilizedBody::Bushing(parent, frame(problem, branch.parent, axes, joint.anchor_b), rigid,
                                           frame(problem, branch.body, axes, joint.anchor_b));
    } else if (joint.soft) {
      if (joint.kind != JointKind::revolute || !problem.planar) throw CannotSay("the adapter makes pins soft only");
      const auto [in, out] = both(SimTK::Rotation());
      made = SimTK::MobilizedBody::Planar(parent, in, rigid, out);
    } else if (joint.kind == JointKind::revolute) {
      const auto [in, out] = both(SimTK::Rotation(SimTK::UnitVec3(vec(joint.axis)), SimTK::ZAxis));
      made = SimTK::MobilizedBody::Pin(parent, in, rigid, out);
    } else {
      const auto [in, out] = both(SimTK::Rotation(SimTK::UnitVec3(vec(joint.axis)), SimTK::XAxis));
      made = SimTK::MobilizedBody::Slider(parent, in, rigid, out);
    }
  }

  // About x, then y, then z: a universal mobilizer, or a gimbal.
  void add_turning(const Problem& problem, const Branch& branch, const SimTK::Body& rigid) {
    const std::vector<Turn> turns = turns_of(problem, branch, free_first_);
    const SimTK::Rotation axes(SimTK::UnitVec3(vec(turns[0].axis)), SimTK::XAxis, vec(turns[1].axis), SimTK::YAxis);
    const Vec3& anchor = problem.joints[std::size_t(branch.joint)].anchor;
    const SimTK::Transform in = frame(problem, branch.parent, axes, anchor),
                           out = frame(problem, branch.body, axes, anchor);
    SimTK::MobilizedBody& made = bodies_[std::size_t(branch.body)];
    if (turns.size() == 2) made = SimTK::MobilizedBody::Universal(mobile(branch.parent), in, rigid, out);
    else made = SimTK::MobilizedBody::Gimbal(mobile(branch.parent), in, rigid, out);
    for (std::size_t k = 0; k < turns.size(); ++k) {
      if (turns[k].held) SimTK::Constraint::ConstantCoordinate(made, SimTK::MobilizerQIndex(int(k)), 0);
      if (turns[k].motor) add_motor(made, int(k), turns[k].motor->speed, *turns[k].motor);
    }
  }
  void add_motor(SimTK::MobilizedBody& made, int coordinate, double speed, const Motor& motor) {
    if (std::isfinite(motor.most)) throw CannotSay("no motor that has a speed and a greatest torque");
    motors_.emplace_back(made, SimTK::MobilizerUIndex(coordinate), speed);
    motors_.back().setDisabledByDefault(true);
  }

  // Adds the forces in a branch's joint; its coordinates are 0 at the start.
  void add_forces(const Problem& problem, const Branch& branch) {
    const SimTK::MobilizedBody& made = bodies_[std::size_t(branch.body)];
    const Body& body = problem.bodies[std::size_t(branch.body)];
    if (norm(body.torque) > 0) SimTK::Force::ConstantTorque(forces_, made, vec(body.torque));
    if (body.damping > 0) SimTK::Force::Custom(forces_, new BodyDamper(made, body));
    if (branch.joint < 0) return;
    const Joint& joint = problem.joints[std::size_t(branch.joint)];
    const auto add_spring = [&](int coordinate, const Spring& spring) {
      SimTK::Force::MobilityLinearSpring(forces_, made, coordinate, spring.stiffness, 0);
      SimTK::Force::MobilityLinearDamper(forces_, made, coordinate, spring.damping);
    };
    if (joint.spring) add_spring(0, *joint.spring);
    if (joint.mount) hold_in_mount(joint, made);
    if (joint.soft) add_spring(1, *joint.soft);  // after the angle
    if (joint.soft) add_spring(2, *joint.soft);
    if (joint.stops) {
      const Stops stops = stops_from_start(problem, branch);
      SimTK::Force::MobilityLinearStop(forces_, made, SimTK::MobilizerQIndex(0), stop_stiffness, stop_dissipation,
                                       stops.lower, stops.upper);
    }
    if (joint.motor)
      add_motor(bodies_[std::size_t(branch.body)], 0, sense(problem, branch) * joint.motor->speed, *joint.motor);
  }

  // Springs of its turns, then of its slides.
  void hold_in_mount(const Joint& joint, const SimTK::MobilizedBody& made) {
    const auto& [along, across, twist, bend] = *joint.mount;
    const SimTK::Rotation axes(SimTK::UnitVec3(vec(joint.axis)), SimTK::XAxis);
    const SimTK::Vec3 off = ~axes * vec(joint.anchor_b - joint.anchor);
    const double stiffness[] = {twist, bend, bend, along, across, across};
    for (int k = 0; k < 6; ++k)
      SimTK::Force::MobilityLinearSpring(forces_, made, k, stiffness[k], k < 3 ? 0 : -off[k - 3]);
  }

  // A right angle between directions of two bodies across a hinge.
  void keep_angle(const Problem& problem, const Tree& tree, const Joint& joint) {
    const Branch& hinge = hinge_between(problem, tree, joint.a, joint.b);
    const SimTK::UnitVec3 axis(vec(problem.joints[std::size_t(hinge.joint)].axis)), across = axis.perp();
    const SimTK::Vec3 side = SimTK::cross(axis, across);
    SimTK::Constraint::ConstantAngle(
        mobile(joint.a), SimTK::UnitVec3(vec(local_direction(problem, joint.a, vec(SimTK::Vec3(across))))),
        mobile(joint.b), SimTK::UnitVec3(vec(local_direction(problem, joint.b, vec(side)))));
  }

  void keep_distance(const Problem& problem, const Joint& joint) {
    SimTK::Constraint::Rod(mobile(joint.a), vec(local_point(problem, joint.a, joint.anchor)), mobile(joint.b),
                           vec(local_point(problem, joint.b, joint.anchor_b)), joint.length);
  }

  // The tree keeps the plane, so a pin that closes a loop needs two rows.
  void close(const Problem& problem, const Tree& tree, const Joint& joint) {
    if (joint.kind == JointKind::orientation) return keep_angle(problem, tree, joint);
    if (joint.kind == JointKind::prismatic) throw CannotSay("the adapter closes no loop by a slider");
    if (joint.kind == JointKind::distance) return keep_distance(problem, joint);
    if (only_closes(joint)) throw no_such(joint);
    if (!problem.planar) return close_in_space(problem, joint);
    for (const Vec3& side : {Vec3{1, 0, 0}, Vec3{0, 1, 0}}) {
      const Vec3 normal = local_direction(problem, joint.a, side);
      SimTK::Constraint::PointInPlane(mobile(joint.a), SimTK::UnitVec3(vec(normal)),
                                      dot(normal, local_point(problem, joint.a, joint.anchor)), mobile(joint.b),
                                      vec(local_point(problem, joint.b, joint.anchor_b)));
    }
  }
  // A ball; for a hinge also two right angles between one body's axis and two directions of the other.
  void close_in_space(const Problem& problem, const Joint& joint) {
    SimTK::Constraint::Ball(mobile(joint.a), vec(local_point(problem, joint.a, joint.anchor)), mobile(joint.b),
                            vec(local_point(problem, joint.b, joint.anchor_b)));
    if (joint.kind != JointKind::revolute) return;
    const auto in = [&](int body, const SimTK::Vec3& u) {
      return SimTK::UnitVec3(vec(local_direction(problem, body, vec(u))));
    };
    const SimTK::UnitVec3 axis(vec(joint.axis)), across = axis.perp();
    for (const SimTK::Vec3& side : {SimTK::Vec3(across), SimTK::cross(axis, across)})
      SimTK::Constraint::ConstantAngle(mobile(joint.a), in(joint.a, axis), mobile(joint.b), in(joint.b, side));
  }

  void set_velocity(const Problem& problem, const Branch& branch, SimTK::State& state) {
    SimTK::MobilizedBody& made = bodies_[std::size_t(branch.body)];
    const State& start = problem.bodies[std::size_t(branch.body)].start;
    if (branch.joint < 0) {
      const Quaternion back = conjugate(start.q);
      made.setUToFitVelocity(state, SimTK::SpatialVec(vec(turned(back, start.w)), vec(turned(back, start.v))));
    } else if (const auto turns = turns_of(problem, branch, free_first_); !turns.empty()) {
      for (std::size_t k = 0; k < turns.size(); ++k)
        made.setOneU(state, int(k), dot(spin(problem, branch), turns[k].axis));
    } else if (problem.joints[std::size_t(branch.joint)].kind == JointKind::spherical) {
      made.setUToFitAngularVelocity(state, vec(spin(problem, branch)));
    } else if (problem.joints[std::size_t(branch.joint)].kind != JointKind::fixed) {
      made.setOneU(state, 0, rate(problem, branch));
    }
  }

  // Projects the velocities by the least impulse after a constraint was added.
  void make_compatible(SimTK::State& state) {
    system_.realize(state, SimTK::Stage::Velocity);
    if (state.getNUErr() == 0 || state.getUErr().norm() < 1e-9) return;
    SimTK::Vector impulse, generalised, jump;
    matter_.solveForConstraintImpulses(state, -state.getUErr(), impulse);
    matter_.multiplyByGTranspose(state, impulse, generalised);
    matter_.multiplyByMInv(state, generalised, jump);
    state.updU() += jump;
  }

  // Starts motors at the first step, so the given start is unchanged.
  void start_motors() {
    if (motors_.empty()) return;
    SimTK::State state = integrator_->getState();
    for (const SimTK::Constraint::ConstantSpeed& motor : motors_) motor.enable(state);
    system_.realizeModel(state);
    integrator_->initialize(state);
    motors_.clear();
  }

  void choose(const Way& way, double knob) {
    if (way.kind == Way::merson) integrator_ = std::make_unique<SimTK::RungeKuttaMersonIntegrator>(system_);
    else if (way.kind == Way::feldberg) integrator_ = std::make_unique<SimTK::RungeKuttaFeldbergIntegrator>(system_);
    else if (way.kind == Way::rk3) integrator_ = std::make_unique<SimTK::RungeKutta3Integrator>(system_);
    else if (way.kind == Way::cpodes) integrator_ = std::make_unique<SimTK::CPodesIntegrator>(system_);
    else integrator_ = std::make_unique<SimTK::SemiExplicitEulerIntegrator>(system_, knob);
    if (way.kind != Way::euler) integrator_->setAccuracy(knob);
  }

  SimTK::MultibodySystem system_;
  SimTK::SimbodyMatterSubsystem matter_;
  SimTK::GeneralForceSubsystem forces_;
  SimTK::Force::UniformGravity gravity_;
  std::vector<SimTK::MobilizedBody> bodies_;
  std::vector<SimTK::Constraint::ConstantSpeed> motors_;  // not yet started
  std::map<int, int> held_by_;                            // bodies, by the numbers of the joints that they hang from
  bool free_first_;
  int most_steps_;
  std::unique_ptr<SimTK::Integrator> integrator_;
};

std::vector<Series> series(const Problem& problem) {
  std::vector<double> accuracies;
  for (int half_digits = 2; half_digits <= 26; ++half_digits) accuracies.push_back(std::pow(10.0, -half_digits / 2.0));
  const std::vector<Way> ways{{"Runge-Kutta-Merson", "", Way::merson},
                              {"Runge-Kutta-Fehlberg", "", Way::feldberg},
                              {"Runge-Kutta 3", "", Way::rk3},
                              {"CPodes", "", Way::cpodes},
                              {"semi-explicit Euler", "fixed steps", Way::euler}};
  std::vector<Series> all;
  for (const Way& way : with_free_turns_first(problem, ways)) {
    const bool fixed = way.kind == Way::euler;
    all.push_back({way.name, way.changed, fixed ? "h" : "accuracy", fixed ? steps(problem) : accuracies,
                   [&problem, way](double knob) { return std::make_unique<SimbodyRun>(problem, way, knob); }});
  }
  return all;
}

const Registration registration{
    {"Simbody", "3.7", "double", "#bf8700",
     "mobilizers; a planar loop is closed by two PointInPlane; no interpolation between steps; a soft pin is a sprung "
     "Planar; stops of 1e6 N m/rad; made anew where joints come or go",
     series}};

}  // namespace
}  // namespace cdot::peers
