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

#include "tests/bench/peers/engines/mujoco_model.hpp"
#include "tests/bench/peers/words.hpp"

namespace cdot::peers {
namespace {

struct Model {
  std::shared_ptr<mjModel> made;
  std::vector<Drive> drives;
};

Model model_of(const Problem& problem, bool free_first) {
  mju_user_warning = [](const char*) {};
  mju_user_error = [](const char* message) { throw std::runtime_error(message); };
  check(problem, {.held_orientations = true, .sleep = true, .two_axes = true});
  Model of;
  const std::string xml = model_text(problem, tree_of(problem), free_first, of.drives);
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
        drives_(model.drives),
        free_first_(way.free_first) {
    model_->opt.timestep = h;
    model_->opt.integrator = way.integrator;
    if (way.solref > 0) {
      model_->opt.disableflags |= mjDSBL_REFSAFE;
      for (int k = 0; k < model_->neq; ++k)
        harden(way.solref * h, model_->eq_solref + mjNREF * k, model_->eq_solimp + mjNIMP * k);
      for (int k = 0; k < model_->ngeom; ++k)
        harden(way.solref * h, model_->geom_solref + mjNREF * k, model_->geom_solimp + mjNIMP * k);
      for (int k = 0; k < model_->ntendon; ++k)
        harden(way.solref * h, model_->tendon_solref_lim + mjNREF * k, model_->tendon_solimp_lim + mjNIMP * k);
    }
    const Tree tree = tree_of(problem);
    int equality = 0;
    for (const int loop : tree.loops)
      if (const Joint& joint = problem.joints[std::size_t(loop)];
          joint.kind != JointKind::max_distance && joint.kind != JointKind::contact)
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
    } else if (const double along = rate(problem, branch); along != 0) {
      qvel[model_->body_dofnum[b] - 1] = along;  // after the coordinates of its softness
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

  // Motors are velocity servos, whose gain reaches the speed within a step; servos have their own gains.
  void tune_drives(double h) {
    for (int k = 0; k < model_->nu; ++k) {
      const Drive& drive = drives_[std::size_t(k)];
      const int dof = model_->jnt_dofadr[model_->actuator_trnid[2 * k]];
      double &gain = model_->actuator_gainprm[mjNGAIN * k], *const bias = model_->actuator_biasprm + mjNBIAS * k;
      if (drive.servo) gain = drive.servo->stiffness, bias[1] = -gain, bias[2] = -drive.servo->damping;
      else gain = 1 / (h * model_->dof_invweight0[dof]), bias[2] = -gain;
      data_->ctrl[k] = drive.servo ? drive.servo->target : drive.forth * speed_of(drive.motor, data_->time);
    }
  }

  void step(double h) override {
    model_->opt.timestep = h;
    tune_drives(h);
    push(h);
    mj_step(model_, data_);
    for (const int bad : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC})
      if (data_->warning[bad].number > 0) throw std::runtime_error("MuJoCo: the run is no number");
  }

  const Problem& problem_;
  mjModel* model_;
  mjData* data_;
  std::vector<Drive> drives_;
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
     "a tree of joints, loops closed by connect, distances and ropes kept by tendons; a contact is a ball of 0.1 mm on "
     "a plane; a soft pin is "
     "three sprung slides and a hinge; a motor a velocity servo; a brake a joint's frictionloss; damping a force put "
     "on before each step; made anew "
     "where joints come or go",
     series}};

}  // namespace
}  // namespace cdot::peers
