// MuJoCo: space, double precision, minimal coordinates; soft equality constraints close loops.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <map>
#include <mujoco/mujoco.h>
#include <stdexcept>
#include <string>
#include <utility>

#include "tests/bench/peers/tree.hpp"
#include "tests/bench/peers/words.hpp"

namespace cdot::peers {
namespace {

std::string text(const Vec3& a) { return fmt::format("{} {} {}", a[0], a[1], a[2]); }
std::string text(const Quaternion& q) { return fmt::format("{} {} {} {}", q[0], q[1], q[2], q[3]); }

std::string name_of(int body) { return body == peers::world ? "world" : fmt::format("b{}", body); }

std::string text(const Spring& spring) {
  return fmt::format(" stiffness='{}' damping='{}'", spring.stiffness, spring.damping);
}

// Soft slides in all directions, before the hinge.
std::string soft_text(const Problem& problem, const Branch& branch, const Spring& soft) {
  std::string out;
  for (const Vec3& axis : {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}})
    out +=
        fmt::format("<joint type='slide' axis='{}'{}/>", text(local_direction(problem, branch.body, axis)), text(soft));
  return out;
}

// A series of hinges.
std::string turns_text(const Problem& problem, const Branch& branch, const std::vector<Turn>& turns) {
  std::string out;
  for (std::size_t k = 0; k < turns.size(); ++k)
    out += fmt::format("<joint name='j{}t{}' type='hinge' pos='{}' axis='{}'/>", branch.joint, k,
                       text(local_point(problem, branch.body, problem.joints[std::size_t(branch.joint)].anchor)),
                       text(local_direction(problem, branch.body, turns[k].axis)));
  return out;
}

std::string joint_text(const Problem& problem, const Branch& branch, bool free_first) {
  if (branch.joint < 0) return problem.bodies[std::size_t(branch.body)].moves ? "<freejoint/>" : "";
  const Joint& joint = problem.joints[std::size_t(branch.joint)];
  if (!joint.turns.empty()) return turns_text(problem, branch, turns_of(problem, branch, free_first));
  if (joint.kind == JointKind::fixed) return "";  // part of its parent
  if (joint.soft && joint.kind != JointKind::revolute) throw CannotSay("the adapter makes hinges soft only");
  const char* type = joint.kind == JointKind::revolute    ? "hinge"
                     : joint.kind == JointKind::prismatic ? "slide"
                                                          : "ball";
  std::string out = joint.soft ? soft_text(problem, branch, *joint.soft) : "";
  out += fmt::format("<joint name='j{}' type='{}' pos='{}'", branch.joint, type,
                     text(local_point(problem, branch.body, joint.anchor)));
  if (joint.kind != JointKind::spherical)
    out += fmt::format(" axis='{}'", text(local_direction(problem, branch.body, joint.axis)));
  if (joint.spring) out += text(*joint.spring);
  if (joint.stops) {
    const Stops stops = stops_from_start(problem, branch);
    out += fmt::format(" limited='true' range='{} {}'", stops.lower, stops.upper);
  }
  return out + "/>";
}

double rope_at_start(const Joint& joint) {
  if (joint.kind != JointKind::pulley) return norm(joint.anchor_b - joint.anchor);
  return norm(joint.anchor - joint.wheel) + joint.ratio * norm(joint.anchor_b - joint.wheel_b);
}

// The ends and wheels of ropes on a body or in the world.
std::string sites_text(const Problem& problem, int body) {
  std::string out;
  const auto add = [&](char side, std::size_t joint, const Vec3& at) {
    out += fmt::format("<site name='{}{}' pos='{}'/>", side, joint, text(local_point(problem, body, at)));
  };
  for (std::size_t k = 0; k < problem.joints.size(); ++k) {
    const Joint& joint = problem.joints[k];
    if (!only_closes(joint)) continue;
    if (joint.a == body) add('a', k, joint.anchor);
    if (joint.b == body) add('b', k, joint.anchor_b);
    if (joint.kind != JointKind::pulley || body != world) continue;
    add('v', k, joint.wheel);
    add('w', k, joint.wheel_b);
  }
  return out;
}

std::string ropes_text(const Problem& problem) {
  std::string out;
  for (std::size_t k = 0; k < problem.joints.size(); ++k) {
    const Joint& joint = problem.joints[k];
    if (!only_closes(joint)) continue;
    out += fmt::format("<spatial name='r{}'", k);
    if (joint.kind == JointKind::max_distance) out += fmt::format(" limited='true' range='0 {}'", joint.length);
    out += fmt::format("><site site='a{}'/>", k);
    if (joint.kind == JointKind::pulley)
      out += fmt::format("<site site='v{0}'/><pulley divisor='{1}'/><site site='w{0}'/>", k, 1 / joint.ratio);
    out += fmt::format("<site site='b{}'/></spatial>", k);
  }
  return out;
}

// Equality constraints of locked hinges.
std::string holds_text(const Problem& problem, const Tree& tree, bool free_first) {
  std::string out;
  for (const Branch& branch : tree.branches) {
    if (branch.joint < 0) continue;
    const std::vector<Turn> turns = turns_of(problem, branch, free_first);
    for (std::size_t k = 0; k < turns.size(); ++k)
      if (turns[k].held) out += fmt::format("<joint joint1='j{}t{}' polycoef='0 0 0 0 0'/>", branch.joint, k);
  }
  return out;
}

std::string motor_text(const std::string& joint, const Motor& motor) {
  std::string out = fmt::format("<velocity joint='{}'", joint);
  if (std::isfinite(motor.most)) out += fmt::format(" forcelimited='true' forcerange='{} {}'", -motor.most, motor.most);
  return out + "/>";
}
// Motors and their speeds.
std::string motors_text(const Problem& problem, const Tree& tree, bool free_first, std::vector<double>& speeds) {
  std::string out;
  for (const Branch& branch : tree.branches) {
    if (branch.joint < 0) continue;
    const Joint& joint = problem.joints[std::size_t(branch.joint)];
    const std::vector<Turn> turns = turns_of(problem, branch, free_first);
    for (std::size_t k = 0; k < turns.size(); ++k) {
      if (!turns[k].motor) continue;
      out += motor_text(fmt::format("j{}t{}", branch.joint, k), *turns[k].motor);
      speeds.push_back(turns[k].motor->speed);
    }
    if (!joint.motor) continue;
    out += motor_text(fmt::format("j{}", branch.joint), *joint.motor);
    speeds.push_back(sense(problem, branch) * joint.motor->speed);
  }
  return out;
}

std::string loop_text(const Problem& problem, const Tree& tree, const Joint& joint) {
  const std::size_t k = std::size_t(&joint - problem.joints.data());
  if (joint.kind == JointKind::max_distance) return "";  // its tendon's limit
  if (only_closes(joint))
    return fmt::format("<tendon tendon1='r{}' polycoef='{} 1 0 0 0'/>", k, joint.length - rope_at_start(joint));
  if (joint.kind == JointKind::orientation)
    return fmt::format("<joint joint1='j{}' polycoef='0 0 0 0 0'/>",
                       hinge_between(problem, tree, joint.a, joint.b).joint);
  return fmt::format("<connect body1='{}' body2='{}' anchor='{}'/>", name_of(joint.a), name_of(joint.b),
                     text(local_point(problem, joint.a, joint.anchor)));
}

std::string body_text(const Problem& problem, const Tree& tree, const Branch& branch, bool free_first) {
  const Body& body = problem.bodies[std::size_t(branch.body)];
  Quaternion q = body.start.q;
  if (branch.parent != world) q = conjugate(problem.bodies[std::size_t(branch.parent)].start.q) * q;
  std::string out =
      fmt::format("<body name='b{}' pos='{}' quat='{}'><inertial pos='0 0 0' mass='{}' diaginertia='{}'/>{}{}\n",
                  branch.body, text(local_point(problem, branch.parent, body.start.x)), text(q), body.mass,
                  text(body.inertia), joint_text(problem, branch, free_first), sites_text(problem, branch.body));
  for (const Branch& child : tree.branches)
    if (child.parent == branch.body) out += body_text(problem, tree, child, free_first);
  return out + "</body>\n";
}

std::string model_text(const Problem& problem, const Tree& tree, bool free_first, std::vector<double>& speeds) {
  std::string out = fmt::format(
      "<mujoco><compiler inertiafromgeom='false' angle='radian'/><option gravity='{}'><flag contact='disable'/>"
      "</option><worldbody>",
      text(problem.gravity));
  for (const Branch& branch : tree.branches)
    if (branch.parent == world) out += body_text(problem, tree, branch, free_first);
  out += sites_text(problem, world) + "</worldbody><tendon>" + ropes_text(problem) + "</tendon><equality>";
  for (const int loop : tree.loops) out += loop_text(problem, tree, problem.joints[std::size_t(loop)]);
  out += holds_text(problem, tree, free_first) + "</equality><actuator>";
  return out + motors_text(problem, tree, free_first, speeds) + "</actuator></mujoco>";
}

struct Model {
  std::shared_ptr<mjModel> made;
  std::vector<double> speeds;  // of its motors
};

Model model_of(const Problem& problem, bool free_first) {
  mju_user_warning = [](const char*) {};
  mju_user_error = [](const char* message) { throw std::runtime_error(message); };
  check(problem, {.held_orientations = true, .sleep = true, .two_axes = true});
  Model of;
  const std::string xml = model_text(problem, tree_of(problem), free_first, of.speeds);
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "model.xml", int(xml.size()));
  std::memcpy(files->filedata[0], xml.data(), xml.size());
  char error[500] = "";
  mjModel* model = mj_loadXML("model.xml", files.get(), error, sizeof error);
  mj_deleteVFS(files.get());
  if (model == nullptr) throw std::runtime_error(error);
  of.made = {model, mj_deleteModel};
  return of;
}

struct Way {
  std::string name, changed;
  int integrator;
  double solref = 0;        // steps in which the error of a loop or of a locked hinge decays; 0: the default, 0.02 s
  bool free_first = false;  // free rotation first, in six-degree joints
};

// Sets the stiffness of constraints.
void harden(double seconds, double* solref, double* solimp) {
  *solref = seconds;
  solimp[0] = solimp[1] = 0.9999;
}

class MujocoRun final : public SteppedRun {
 public:
  MujocoRun(const Problem& problem, const Model& model, const Way& way, double h)
      : SteppedRun(h),
        problem_(problem),
        model_(mj_copyModel(nullptr, model.made.get())),
        data_(mj_makeData(model_)),
        free_first_(way.free_first) {
    model_->opt.timestep = h;
    model_->opt.integrator = way.integrator;
    if (way.solref > 0) {
      model_->opt.disableflags |= mjDSBL_REFSAFE;
      for (int k = 0; k < model_->neq; ++k)
        harden(way.solref * h, model_->eq_solref + mjNREF * k, model_->eq_solimp + mjNIMP * k);
      for (int k = 0; k < model_->ntendon; ++k)
        harden(way.solref * h, model_->tendon_solref_lim + mjNREF * k, model_->tendon_solimp_lim + mjNIMP * k);
    }
    const Tree tree = tree_of(problem);
    std::copy(model.speeds.begin(), model.speeds.end(), data_->ctrl);
    int equality = 0;
    for (const int loop : tree.loops)
      if (const Joint& joint = problem.joints[std::size_t(loop)]; joint.kind != JointKind::max_distance)
        open(problem, joint, equality++);
    for (const Branch& branch : tree.branches) {
      bodies_.push_back(0);
      set_velocity(problem, branch);
    }
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      bodies_[k] = mj_name2id(model_, mjOBJ_BODY, name_of(int(k)).c_str());
    }
    for (const Branch& branch : tree.branches)
      if (branch.joint >= 0) held_by_[problem.joints[std::size_t(branch.joint)].number] = branch.body;
  }
  ~MujocoRun() override {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }
  MujocoRun(const MujocoRun&) = delete;
  MujocoRun& operator=(const MujocoRun&) = delete;

  State state(int body) const override {
    mj_kinematics(model_, data_);
    mj_comPos(model_, data_);
    mj_comVel(model_, data_);
    const int b = bodies_[std::size_t(body)];
    const double *x = data_->xpos + 3 * b, *q = data_->xquat + 4 * b;
    double v[6];  // spin, then velocity
    mj_objectVelocity(model_, data_, mjOBJ_BODY, b, v, 0);
    return {{x[0], x[1], x[2]}, {q[0], q[1], q[2], q[3]}, {v[3], v[4], v[5]}, {v[0], v[1], v[2]}};
  }

  // Acts as a force during the next step.
  void strike(int body, const Vec3& impulse) override { struck_.emplace_back(body, impulse); }

  double force(int joint) const override {
    const auto held = held_by_.find(joint);
    if (held == held_by_.end()) throw CannotSay("the adapter does not read what a loop carries");
    mj_rnePostConstraint(model_, data_);
    const double* f = data_->cfrc_int + 6 * bodies_[std::size_t(held->second)];  // torque, then force
    return norm({f[3], f[4], f[5]});
  }

 private:
  // A loop that starts open: the compiler places its second point at the first.
  void open(const Problem& problem, const Joint& joint, int loop) {
    if (joint.kind == JointKind::orientation || only_closes(joint) || norm(joint.anchor_b - joint.anchor) == 0) return;
    const Vec3 at = local_point(problem, joint.b, joint.anchor_b);
    std::copy(at.begin(), at.end(), model_->eq_data + mjNEQDATA * loop + 3);
  }

  void set_velocity(const Problem& problem, const Branch& branch) {
    const int b = mj_name2id(model_, mjOBJ_BODY, name_of(branch.body).c_str());
    if (model_->body_dofnum[b] == 0) return;
    double* qvel = data_->qvel + model_->body_dofadr[b];
    const State& s = problem.bodies[std::size_t(branch.body)].start;
    const auto put = [](double* to, const Vec3& u) { std::copy(u.begin(), u.end(), to); };
    if (branch.joint < 0) {
      put(qvel, s.v);
      put(qvel + 3, turned(conjugate(s.q), s.w));
    } else if (!problem.joints[std::size_t(branch.joint)].turns.empty()) {
      for (const Turn& turn : turns_of(problem, branch, free_first_)) *qvel++ = dot(spin(problem, branch), turn.axis);
    } else if (problem.joints[std::size_t(branch.joint)].kind == JointKind::spherical) {
      put(qvel, turned(conjugate(s.q), spin(problem, branch)));
    } else {
      qvel[model_->body_dofnum[b] - 1] = rate(problem, branch);  // after the coordinates of its softness
    }
  }

  // Applies the forces of the next step.
  void push(double h) {
    std::vector<Push> all;
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      const Body& body = problem_.bodies[k];
      all.push_back(body.damping > 0 ? damping(body, state(int(k))) : Push{});
      all.back().torque = all.back().torque + body.torque;
    }
    for (const auto& [body, impulse] : struck_)
      all[std::size_t(body)].force = all[std::size_t(body)].force + (1 / h) * impulse;
    struck_.clear();
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      double* to = data_->xfrc_applied + 6 * bodies_[k];
      std::copy(all[k].force.begin(), all[k].force.end(), to);
      std::copy(all[k].torque.begin(), all[k].torque.end(), to + 3);
    }
  }

  // A motor is a velocity servo; its gain reaches the speed within a step.
  void tune_motors(double h) {
    for (int k = 0; k < model_->nu; ++k) {
      const int dof = model_->jnt_dofadr[model_->actuator_trnid[2 * k]];
      const double gain = 1 / (h * model_->dof_invweight0[dof]);
      model_->actuator_gainprm[mjNGAIN * k] = gain;
      model_->actuator_biasprm[mjNBIAS * k + 2] = -gain;
    }
  }

  void step(double h) override {
    model_->opt.timestep = h;
    tune_motors(h);
    push(h);
    mj_step(model_, data_);
    for (const int bad : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC})
      if (data_->warning[bad].number > 0) throw std::runtime_error("MuJoCo: the run is no number");
  }

  const Problem& problem_;
  mjModel* model_;
  mjData* data_;
  bool free_first_;
  std::vector<int> bodies_;
  std::map<int, int> held_by_;  // bodies, by the numbers of the joints that they hang from
  std::vector<std::pair<int, Vec3>> struck_;
};

std::vector<Series> series(const Problem& problem) {
  std::vector<Way> ways{{"RK4", "integrator RK4", mjINT_RK4},
                        {"Euler", "", mjINT_EULER},
                        {"implicit", "integrator implicit", mjINT_IMPLICIT}};
  const bool holds = std::any_of(problem.joints.begin(), problem.joints.end(), [](const Joint& joint) {
    return std::any_of(joint.turns.begin(), joint.turns.end(), [](const Turn& turn) { return turn.held; });
  });
  if (holds || !tree_of(problem).loops.empty()) {
    const std::string hard = "loop: solimp 0.9999, refsafe off, solref ";
    ways.push_back({"RK4, loop 1 h", "integrator RK4; " + hard + "1 h", mjINT_RK4, 1});
    ways.push_back({"RK4, loop 2 h", "integrator RK4; " + hard + "2 h", mjINT_RK4, 2});
    ways.push_back({"Euler, loop 2 h", hard + "2 h", mjINT_EULER, 2});
  }
  std::vector<Series> all;
  const Model plain = model_of(problem, false);
  for (const Way& way : with_free_turns_first(problem, ways)) {
    const Model model = way.free_first ? model_of(problem, true) : plain;
    all.push_back({way.name, way.changed, "h", way.integrator == mjINT_RK4 ? fine_steps(problem) : steps(problem),
                   [&problem, model, way](double h) { return std::make_unique<MujocoRun>(problem, model, way, h); }});
  }
  return all;
}

const Registration registration{
    {"MuJoCo", mj_versionString(), "double", "#1a7f37",
     "a tree of joints, loops closed by connect, distances and ropes kept by tendons; contacts disabled; a soft pin is "
     "three sprung slides and a hinge; a motor a velocity servo; damping a force put on before each step; made anew "
     "where joints come or go",
     series}};

}  // namespace
}  // namespace cdot::peers
