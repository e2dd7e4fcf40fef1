// Bullet's multibodies: space, double precision, minimal coordinates; feedback on points closes loops.
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointFeedback.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointLimitConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <BulletDynamics/Featherstone/btMultiBodyPoint2Point.h>
#include <map>
#include <string>
#include <utility>

#include "tests/bench/peers/engines/bullet_world.hpp"
#include "tests/bench/peers/tree.hpp"
#include "tests/bench/peers/words.hpp"

namespace cdot::peers {
namespace {

struct Way {
  std::string name, changed;
  bool rk4;
  double erp = 0.2;
  bool free_first = false;  // free rotation first, in six-degree joints
};

class MultibodyRun final : public SteppedRun {
 public:
  MultibodyRun(const Problem& problem, const Way& way, double h)
      : SteppedRun(h),
        problem_(problem),
        world_(&parts_.dispatcher, &parts_.broadphase, &solver_, &parts_.configuration),
        places_(problem.bodies.size()),
        h_(h),
        free_first_(way.free_first) {
    check(problem,
          {.held_orientations = true, .soft_joints = true, .two_axes = true, .mounts = true, .contacts = true});
    world_.setGravity(bt(problem.gravity));
    world_.getSolverInfo().m_erp = way.erp;
    world_.getSolverInfo().m_jointFeedbackInWorldSpace = true;
    const Tree tree = tree_of(problem);
    make(problem, tree);
    for (const auto& made : multibodies_) {
      made->setLinearDamping(0);
      made->setAngularDamping(0);
      made->setUseGyroTerm(true);
      made->setMaxCoordinateVelocity(1e9);
      made->setMaxAppliedImpulse(1e9);
      made->useRK4Integration(way.rk4);
      made->setCanSleep(problem.sleep_after > 0);
      made->setSleepTimeout(problem.sleep_after);
      world_.addMultiBody(made.get());
    }
    for (const int loop : tree.loops) close(problem, tree, problem.joints[std::size_t(loop)]);
    for (const Branch& branch : tree.branches) drive(problem, branch);
    // Without colliders Bullet silently ignores constraints and sleep.
    if (!constraints_.empty() || problem.sleep_after > 0) collide();
  }
  ~MultibodyRun() override {
    for (const auto& constraint : constraints_) world_.removeMultiBodyConstraint(constraint.get());
    for (const auto& collider : colliders_) world_.removeCollisionObject(collider.get());
    for (const auto& made : multibodies_) world_.removeMultiBody(made.get());
  }
  MultibodyRun(const MultibodyRun&) = delete;
  MultibodyRun& operator=(const MultibodyRun&) = delete;

  void step(double h) override {
    for (std::size_t k = 0; k < places_.size(); ++k) {
      const Body& body = problem_.bodies[k];
      push(places_[k], {Vec3{}, body.torque});
      if (body.damping > 0) push(places_[k], damping(body, state(int(k))));
    }
    for (const auto& [at, impulse] : struck_) push(at, {(1 / h) * impulse, Vec3{}});
    struck_.clear();
    for (const auto& [at, damping] : dampers_)
      at.multibody->addJointTorque(at.link, -damping * at.multibody->getJointVel(at.link));
    for (const Tuned& tuned : tuned_) tuned.made->setVelocityTarget(tuned.speed(time_, h));
    world_.stepSimulation(h, 0, h);
    time_ += h;
  }
  State state(int body) const override {
    const Place at = places_[std::size_t(body)];
    const btMultiBody& m = *at.multibody;
    if (at.link < 0)
      return {from(m.getBasePos()), from(m.getWorldToBaseRot().inverse()), from(m.getBaseVel()),
              from(m.getBaseOmega())};
    std::vector<btVector3> w(std::size_t(m.getNumLinks()) + 1), v(w.size());
    m.compTreeLinkVelocities(w.data(), v.data());
    const btMatrix3x3 R = m.localFrameToWorld(at.link, btMatrix3x3::getIdentity());
    btQuaternion q;
    R.getRotation(q);
    return {from(m.localPosToWorld(at.link, btVector3(0, 0, 0))), from(q), from(R * v[std::size_t(at.link) + 1]),
            from(R * w[std::size_t(at.link) + 1])};
  }

  // Acts as a force during the next step.
  void strike(int body, const Vec3& impulse) override {
    places_[std::size_t(body)].multibody->wakeUp();
    for (const auto& collider : colliders_) collider->activate(true);
    struck_.emplace_back(places_[std::size_t(body)], impulse);
  }
  bool asleep(int body) const override { return !places_[std::size_t(body)].multibody->isAwake(); }

  double force(int joint) const override {
    const auto felt = felt_.find(joint);
    if (felt == felt_.end()) throw CannotSay("the adapter does not read what a loop carries");
    return felt->second.m_reactionForces.m_topVec.length();
  }

 private:
  // A motor whose speed is set before each step.
  struct Tuned {
    btMultiBodyJointMotor* made;
    std::function<double(double time, double h)> speed;
  };
  struct Place {
    btMultiBody* multibody = nullptr;
    int link = -1;  // the base
  };

  static void push(const Place& at, const Push& by) {
    if (at.link < 0) {
      at.multibody->addBaseForce(bt(by.force));
      at.multibody->addBaseTorque(bt(by.torque));
    } else {
      at.multibody->addLinkForce(at.link, bt(by.force));
      at.multibody->addLinkTorque(at.link, bt(by.torque));
    }
  }

  // One multibody for the tree at the world, one for each free body and its tree.
  void make(const Problem& problem, const Tree& tree) {
    std::vector<int> links{0}, group(problem.bodies.size(), 0);
    for (const Branch& branch : tree.branches) {
      int& mine = group[std::size_t(branch.body)];
      if (branch.joint < 0) {
        mine = int(links.size());
        links.push_back(0);
        continue;
      }
      mine = branch.parent == peers::world ? 0 : group[std::size_t(branch.parent)];
      int& made = links[std::size_t(mine)];
      made += links_of(problem, branch);
      places_[std::size_t(branch.body)].link = made - 1;
    }
    multibodies_.resize(links.size());
    if (links[0] > 0) multibodies_[0] = std::make_unique<btMultiBody>(links[0], 0, btVector3(0, 0, 0), true, false);
    ground_.multibody = multibodies_[0].get();
    for (const Branch& branch : tree.branches) {
      const int mine = group[std::size_t(branch.body)];
      if (branch.joint < 0) multibodies_[std::size_t(mine)] = base(problem, branch, links[std::size_t(mine)]);
      places_[std::size_t(branch.body)].multibody = multibodies_[std::size_t(mine)].get();
      if (branch.joint >= 0) setup(problem, branch, places_[std::size_t(branch.body)]);
    }
    std::erase(multibodies_, nullptr);
    for (const auto& made : multibodies_) made->finalizeMultiDof();
    for (const Branch& branch : tree.branches) set_velocity(problem, branch, places_[std::size_t(branch.body)]);
  }

  // A joint with several axes becomes a hinge for each, between massless links.
  static int links_of(const Problem& problem, const Branch& branch) {
    return std::max(1, int(problem.joints[std::size_t(branch.joint)].turns.size()));
  }

  static int link_of(const Place& last, const std::vector<Turn>& turns, std::size_t turn) {
    return last.link + 1 - int(turns.size() - turn);
  }

  std::vector<Turn> turns_in(const Problem& problem, const Branch& branch) const {
    return branch.joint < 0 ? std::vector<Turn>() : turns_of(problem, branch, free_first_);
  }

  static std::unique_ptr<btMultiBody> base(const Problem& problem, const Branch& branch, int links) {
    const Body& body = problem.bodies[std::size_t(branch.body)];
    auto made = std::make_unique<btMultiBody>(links, body.mass, bt(body.inertia), !body.moves, false);
    made->setBasePos(bt(body.start.x));
    made->setWorldToBaseRot(bt(body.start.q).inverse());
    return made;
  }

  Place place(int body) const { return body == peers::world ? ground_ : places_[std::size_t(body)]; }

  void setup(const Problem& problem, const Branch& branch, const Place& at) {
    const Body& body = problem.bodies[std::size_t(branch.body)];
    const Joint& joint = problem.joints[std::size_t(branch.joint)];
    const Quaternion parent =
        branch.parent == peers::world ? Quaternion{1, 0, 0, 0} : problem.bodies[std::size_t(branch.parent)].start.q;
    btQuaternion turn = bt(conjugate(body.start.q) * parent);
    btVector3 in = bt(local_point(problem, branch.parent, joint.anchor));
    const btVector3 out = -bt(local_point(problem, branch.body, joint.anchor)),
                    axis = bt(local_direction(problem, branch.body, joint.axis)), inertia = bt(body.inertia);
    int above = place(branch.parent).link;
    const int link = at.link;
    btMultiBody& made = *at.multibody;
    const std::vector<Turn> turns = turns_in(problem, branch);
    for (std::size_t k = 0; k + 1 < turns.size(); ++k) {
      const int between = link_of(at, turns, k);
      made.setupRevolute(between, 0, btVector3(0, 0, 0), above, turn,
                         bt(local_direction(problem, branch.body, turns[k].axis)), in, btVector3(0, 0, 0), true);
      above = between;
      turn = btQuaternion::getIdentity();
      in = btVector3(0, 0, 0);
    }
    if (joint.kind == JointKind::fixed) made.setupFixed(link, body.mass, inertia, above, turn, in, out, true);
    else if (joint.kind == JointKind::spherical)
      made.setupSpherical(link, body.mass, inertia, above, turn, in, out, true);
    else if (joint.kind == JointKind::revolute)
      made.setupRevolute(link, body.mass, inertia, above, turn, axis, in, out, true);
    else if (!turns.empty())
      made.setupRevolute(link, body.mass, inertia, above, turn,
                         bt(local_direction(problem, branch.body, turns.back().axis)), in, out, true);
    else made.setupPrismatic(link, body.mass, inertia, above, turn, axis, in, out, true);
    made.getLink(link).m_jointFeedback = &felt_[joint.number];
  }

  void set_velocity(const Problem& problem, const Branch& branch, const Place& at) const {
    const State& start = problem.bodies[std::size_t(branch.body)].start;
    const std::vector<Turn> turns = turns_in(problem, branch);
    for (std::size_t k = 0; k < turns.size(); ++k)
      at.multibody->setJointVel(link_of(at, turns, k), dot(spin(problem, branch), turns[k].axis));
    if (!turns.empty()) return;
    if (branch.joint < 0) {
      at.multibody->setBaseVel(bt(start.v));
      at.multibody->setBaseOmega(bt(start.w));
    } else if (problem.joints[std::size_t(branch.joint)].kind == JointKind::spherical) {
      const Vec3 w = turned(conjugate(start.q), spin(problem, branch));
      at.multibody->setJointVelMultiDof(at.link, w.data());
    } else if (problem.joints[std::size_t(branch.joint)].kind != JointKind::fixed) {
      // A slider moves by its coordinate times its axis.
      at.multibody->setJointVel(at.link, rate(problem, branch) / norm(problem.joints[std::size_t(branch.joint)].axis));
    }
  }

  void collide() {
    for (const auto& made : multibodies_)
      for (int link = -1; link < made->getNumLinks(); ++link) {
        colliders_.push_back(std::make_unique<btMultiBodyLinkCollider>(made.get(), link));
        btMultiBodyLinkCollider* collider = colliders_.back().get();
        collider->setCollisionShape(&parts_.shape);
        world_.addCollisionObject(collider);
        if (link < 0) made->setBaseCollider(collider);
        else made->getLink(link).m_collider = collider;
      }
    for (const auto& constraint : constraints_) world_.addMultiBodyConstraint(constraint.get());
  }

  void hold(std::unique_ptr<btMultiBodyConstraint> made) {
    made->setMaxAppliedImpulse(1e9);
    constraints_.push_back(std::move(made));
  }

  void close(const Problem& problem, const Tree& tree, const Joint& joint) {
    if (joint.kind == JointKind::orientation) {
      const Place at = place(hinge_between(problem, tree, joint.a, joint.b).body);
      return hold(std::make_unique<btMultiBodyJointLimitConstraint>(at.multibody, at.link, 0, 0));
    }
    if (only_closes(joint)) throw no_such(joint);
    const Place a = place(joint.a), b = place(joint.b);
    hold(std::make_unique<btMultiBodyPoint2Point>(a.multibody, a.link, b.multibody, b.link,
                                                  bt(local_point(problem, joint.a, joint.anchor)),
                                                  bt(local_point(problem, joint.b, joint.anchor_b))));
  }

  void drive(const Problem& problem, const Branch& branch) {
    if (branch.joint < 0) return;
    const Joint& joint = problem.joints[std::size_t(branch.joint)];
    const Place at = place(branch.body);
    const std::vector<Turn> turns = turns_in(problem, branch);
    for (std::size_t k = 0; k < turns.size(); ++k) {
      const int link = link_of(at, turns, k);
      if (turns[k].held) hold(std::make_unique<btMultiBodyJointLimitConstraint>(at.multibody, link, 0, 0));
      if (turns[k].motor) move(at.multibody, link, turns[k].motor->speed, *turns[k].motor);
    }
    if (joint.stops) {
      const Stops stops = stops_from_start(problem, branch);
      hold(std::make_unique<btMultiBodyJointLimitConstraint>(at.multibody, at.link, stops.lower, stops.upper));
    }
    for (const double torque : joint.brakes) move(at.multibody, at.link, 0, {0, torque});
    if (joint.servo) add_servo(at, servo_from_start(problem, branch));
    if (joint.spring) add_damper(at, *joint.spring);
    if (joint.motor) add_motor(problem, branch, *joint.motor);
  }
  btMultiBodyJointMotor& move(btMultiBody* multibody, int link, double speed, const Motor& motor) {
    auto made = std::make_unique<btMultiBodyJointMotor>(multibody, link, speed, motor.most * h_);
    btMultiBodyJointMotor& set = *made;
    constraints_.push_back(std::move(made));
    return set;
  }
  // A slider moves by its coordinate times its axis.
  void add_motor(const Problem& problem, const Branch& branch, Motor motor) {
    const Joint& joint = problem.joints[std::size_t(branch.joint)];
    const double length = joint.kind == JointKind::prismatic ? norm(joint.axis) : 1,
                 per_speed = sense(problem, branch) / length;
    const Place at = place(branch.body);
    motor.most *= length;
    btMultiBodyJointMotor& made = move(at.multibody, at.link, per_speed * motor.speed, motor);
    if (motor.speed_at)
      tuned_.push_back({&made, [per_speed, motor](double time, double) { return per_speed * speed_of(motor, time); }});
  }
  void add_servo(const Place& at, const Servo& servo) {
    btMultiBodyJointMotor& made = move(at.multibody, at.link, 0, {0, servo.most});
    tuned_.push_back(
        {&made, [at, servo](double, double h) { return speed_of(servo, at.multibody->getJointPos(at.link), h); }});
  }
  void add_damper(const Place& at, const Spring& spring) {
    if (spring.stiffness != 0) throw CannotSay("no spring of a joint");
    dampers_.emplace_back(at, spring.damping);
  }

  const Problem& problem_;
  BulletParts parts_;
  btMultiBodyConstraintSolver solver_;
  Untouched<btMultiBodyDynamicsWorld> world_;
  std::map<int, btMultiBodyJointFeedback> felt_;  // by the joint's number
  std::vector<std::unique_ptr<btMultiBody>> multibodies_;
  Place ground_;
  std::vector<Place> places_;  // of bodies
  std::vector<std::pair<Place, Vec3>> struck_;
  double h_;
  bool free_first_;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders_;
  std::vector<std::unique_ptr<btMultiBodyConstraint>> constraints_;
  std::vector<Tuned> tuned_;
  std::vector<std::pair<Place, double>> dampers_;
  double time_ = 0;
};

std::vector<Series> series(const Problem& problem) {
  std::vector<Way> ways{{"RK4", "useRK4Integration", true}, {"Euler", "", false}};
  if (!tree_of(problem).loops.empty()) ways.push_back({"RK4, ERP 0.8", "useRK4Integration, ERP 0.8", true, 0.8});
  std::vector<Series> all;
  for (const Way& way : with_free_turns_first(problem, ways))
    all.push_back({way.name, way.changed, "h", way.rk4 ? fine_steps(problem) : steps(problem),
                   [&problem, way](double h) { return std::make_unique<MultibodyRun>(problem, way, h); }});
  return all;
}

const Registration registration{
    {"Bullet multibody", "3.24", "double", "#bf3989",
     "the build in doubles; a tree of links, loops closed by btMultiBodyPoint2Point; link damping 0; greatest "
     "coordinate velocity and impulse raised; collision detection skipped; damping a force and a "
     "damper of a joint a torque put on before each step; a brake a motor of speed 0, a servo a motor whose speed is "
     "set before each step; "
     "sleeps where the case does; made anew where joints come or go",
     series}};

}  // namespace
}  // namespace cdot::peers
