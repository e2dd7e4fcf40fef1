// Imported MJCF files move as in MuJoCo itself, of which Debian has version 2.2.
#include <Eigen/Core>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <mujoco/mujoco.h>
#include <string>

#include "runtime/tool/import/model.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::mujoco_test {
namespace {

using Positions = std::map<std::string, Eigen::Vector3d>;
constexpr double until = 1, every = 0.25;

// By Runge-Kutta with steps of 0.1 ms, without contacts: the centres of mass of the bodies that move, with those that
// have no joint.
class MujocoRun {
 public:
  explicit MujocoRun(const std::string& mjcf) {
    const TemporaryFolder folder;
    const std::string file = (folder / "model.xml").string();
    std::ofstream(file) << mjcf;
    char error[500] = "";
    model_.reset(mj_loadXML(file.c_str(), nullptr, error, sizeof error));
    if (!model_) throw std::runtime_error(error);
    model_->opt.timestep = step_, model_->opt.integrator = mjINT_RK4;
    model_->opt.disableflags |= mjDSBL_CONTACT;
    data_.reset(mj_makeData(model_.get()));
    for (int joint = 0; joint < model_->njnt;
         ++joint)  // MuJoCo starts where coordinates are 0, also beyond their limits
      if (model_->jnt_limited[joint])
        data_->qpos[model_->jnt_qposadr[joint]] = std::clamp(
            data_->qpos[model_->jnt_qposadr[joint]], model_->jnt_range[2 * joint], model_->jnt_range[2 * joint + 1]);
    mj_forward(model_.get(), data_.get());
  }

  void run(double time) {
    while (data_->time < time - step_ / 2) mj_step(model_.get(), data_.get());
    mj_forward(model_.get(), data_.get());
  }

  Positions positions() const {
    Positions found;
    for (int body = 1; body < model_->nbody; ++body) {
      if (model_->body_jntnum[body] == 0) continue;
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      double mass = 0;
      for (int part = body; part < model_->nbody; ++part) {
        int holds = part;
        while (holds != body && holds > 0 && model_->body_jntnum[holds] == 0) holds = model_->body_parentid[holds];
        if (holds != body) continue;
        sum += model_->body_mass[part] * Eigen::Map<const Eigen::Vector3d>(data_->xipos + 3 * part);
        mass += model_->body_mass[part];
      }
      found[mj_id2name(model_.get(), mjOBJ_BODY, body)] = sum / mass;
    }
    return found;
  }

 private:
  static constexpr double step_ = 1e-4;
  std::unique_ptr<mjModel, decltype(&mj_deleteModel)> model_{nullptr, mj_deleteModel};
  std::unique_ptr<mjData, decltype(&mj_deleteData)> data_{nullptr, mj_deleteData};
};

// The imported scene by an accurate method, beside it: the largest distance, and how far anything moved.
struct Beside {
  double distance = 0, way = 0;
  std::size_t bodies = 0;
};
Beside beside(const std::string& mjcf) {
  Model model = read_model(mjcf, "model.xml");
  std::string text = scene_text(model, {});
  const std::string head = "dimension = 3\n";
  text.insert(text.find(head) + head.size(), "integrator = \"dop853\"\nlocal_error = 1e-10\n");
  const TemporaryFolder folder;
  for (const ModelSpec& spec : model.specs) std::ofstream(folder / spec.file) << spec.text;
  const Scene scene = read_scene(text, (folder / "model.toml").string());
  MujocoRun mujoco(mjcf);
  const Positions start = mujoco.positions();
  Beside result;
  for (const Frame& frame : run_of(scene, until, every)) {
    mujoco.run(frame.time);
    const Positions there = mujoco.positions();
    for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
      const auto same = there.find(scene.bodies[k].name);
      if (same == there.end()) continue;  // a light body between joints of one body
      const BodyState& here = frame.bodies[k];
      result.distance = std::max(result.distance, (Eigen::Vector3d(here.x, here.y, here.z) - same->second).norm());
      result.way = std::max(result.way, (same->second - start.at(same->first)).norm());
    }
    result.bodies = there.size();
  }
  return result;
}

std::string model_of(const std::string& world, const std::string& more = "", const std::string& gravity = "2 1 -9.81") {
  return fmt::format("<mujoco><option gravity=\"{}\"/>{}<worldbody>{}</worldbody></mujoco>", gravity, more, world);
}

void expect_beside(const char* name, const std::string& mjcf, double within = 1e-6) {
  const Beside found = beside(mjcf);
  fmt::print("{}: {} bodies, {:.1g} m apart after ways of {:.2g} m\n", name, found.bodies, found.distance, found.way);
  EXPECT_LT(found.distance, within) << name;
  EXPECT_GT(found.way, 0.1) << name;
}

TEST(BesideMujoco, ADoublePendulum) {
  std::string text = read_text(scenes_dir() / "spatial/double_pendulum.xml");
  text.insert(text.find("<default>"), "<option gravity=\"3 0 -9.81\"/>");
  expect_beside("double pendulum", text);
}

TEST(BesideMujoco, EachJoint) {
  const std::string box = "<geom type=\"box\" size=\"0.3 0.1 0.05\" pos=\"0.4 0.1 0\" euler=\"20 0 30\"/>";
  const std::pair<const char*, std::string> joints[] = {
      {"hinge", "<joint axis=\"0.3 1 0\" pos=\"0.1 0 0\" stiffness=\"40\" springref=\"30\" damping=\"2\"/>"},
      {"slide", "<joint type=\"slide\" axis=\"1 1 0\" stiffness=\"50\" springref=\"0.3\" ref=\"0.2\" damping=\"3\"/>"},
      {"ball", "<joint type=\"ball\" pos=\"0 0 0.1\"/>"},
      {"universal", "<joint axis=\"0 1 0\" stiffness=\"20\" damping=\"1\"/><joint axis=\"0 0 1\" stiffness=\"10\"/>"},
      {"plane", "<joint type=\"slide\" axis=\"1 0 0\"/><joint type=\"slide\" axis=\"0 0 1\"/><joint axis=\"0 1 0\"/>"},
      {"slide and hinge, skew", "<joint type=\"slide\" axis=\"1 0 1\" damping=\"2\"/><joint axis=\"1 1 0\"/>"},
      {"three hinges, skew",
       "<joint axis=\"1 0 0.2\" stiffness=\"20\"/><joint axis=\"0 0.3 1\" pos=\"0 0 0.1\" damping=\"1\"/><joint "
       "axis=\"0 1 0\"/>"},
      {"free", "<freejoint/>"},
  };
  for (const auto& [name, joint] : joints)
    expect_beside(name, model_of("<body name=\"b\" pos=\"0 0 1\" euler=\"10 20 30\">" + joint + box + "</body>"));
}

// The mass of the light body between the joints is a share of 1 kg then.
TEST(BesideMujoco, JointsOfABodyWhoseMassIsInAFixedOne) {
  expect_beside("mass in a fixed body",
                model_of(R"(<body name="b" pos="0 0 1"><joint axis="1 0 0.2"/><joint axis="0 1 0.5"/>
  <body pos="0.4 0 0"><geom size="0.2"/></body></body>)"));
}

// As the hip, the knee and the ankle of MuJoCo's humanoid: several skew hinges on one body, springs, dampers, and
// masses by capsules; the trunk is free.
TEST(BesideMujoco, ALegThatSwings) {
  expect_beside("leg", model_of(R"(<body name="trunk" pos="0 0 1.5"><freejoint/>
  <geom type="capsule" fromto="0 -.07 0 0 .07 0" size="0.07"/>
  <body name="thigh" pos="0 -0.1 -0.1"><joint axis="1 0 0" stiffness="10" damping="5" springref="20"/>
    <joint axis="0 0 1" stiffness="10" damping="5" springref="-30"/><joint axis="0 1 0" stiffness="20" damping="5" springref="-60"/>
    <geom type="capsule" fromto="0 0 0 0 0.01 -.34" size="0.06"/>
    <body name="shin" pos="0 .01 -.4"><joint axis="0 -1 0" pos="0 0 .02" damping="1" stiffness="1" springref="-90"/>
      <geom type="capsule" fromto="0 0 0 0 0 -.3" size="0.049"/>
      <body name="foot" pos="0 0 -.39"><joint axis="0 1 0" pos="0 0 .08" stiffness="6" damping="0.4" springref="30"/>
        <joint axis="1 0 .5" pos="0 0 .08" stiffness="3" damping="0.4"/>
        <geom type="capsule" fromto="-.07 -.02 0 .14 -.04 0" size="0.027"/>
        <geom type="capsule" fromto="-.07 0 0 .14 .02 0" size="0.027"/>
      </body></body></body></body>)",
                                "", "0 0 0"));
}

TEST(BesideMujoco, Actuators) {
  const std::string arm =
      "<body name=\"upper\"><joint name=\"s\" axis=\"0 1 0\" ref=\"20\"/><geom type=\"capsule\" fromto=\"0 0 0 0.5 0 "
      "0\" size=\"0.05\"/>"
      "<body name=\"lower\" pos=\"0.5 0 0\"><joint name=\"e\" axis=\"0 1 0\"/><joint name=\"w\" axis=\"1 0 0\"/>"
      "<geom type=\"box\" size=\"0.2 0.05 0.1\" pos=\"0.2 0.02 0\"/></body></body>";
  expect_beside("actuators",
                model_of(arm,
                         "<actuator><position joint=\"s\" kp=\"30\" gear=\"2\"/><velocity joint=\"e\" kv=\"3\"/>"
                         "<position joint=\"w\" kp=\"5\"/></actuator>"));
}

// A gripper whose fingers mirror each other, with a tip that bends as a polynomial of the wrist says: specs beside the
// scene. MuJoCo's couplings are soft.
TEST(BesideMujoco, CoupledJoints) {
  const std::string finger = "<geom type=\"box\" size=\"0.02 0.02 0.1\"/>",
                    stiff = R"(solref="0.001 1" solimp="0.999 0.999 0.001")";
  expect_beside(
      "coupled joints",
      model_of(R"(<body name="palm" pos="0 0 1"><joint name="wrist" axis="1 0 0" pos="0 0 0.1"/>
  <geom type="box" size="0.1 0.2 0.05"/>
  <body name="left" pos="0 0.1 -0.1"><joint name="left" type="slide" axis="0 1 0" stiffness="20" springref="0.2"/>)" +
                   finger + R"(</body>
  <body name="right" pos="0 -0.1 -0.1"><joint name="right" type="slide" axis="0 -1 0"/>)" +
                   finger + R"(
    <body name="tip" pos="0 0 -0.1"><joint name="tip" axis="1 0 0.2"/><geom type="capsule" fromto="0 0 0 0 0.1 -0.2" size="0.02"/>
    </body></body></body>)",
               "<equality><joint name=\"mirror\" joint1=\"right\" joint2=\"left\" " + stiff +
                   "/><joint joint1=\"tip\" joint2=\"wrist\" polycoef=\"0 0.5 0.3 0 0\" " + stiff + "/></equality>"),
      5e-4);
}

// MuJoCo's loops are soft, so the answers agree as far as its loop is closed.
TEST(BesideMujoco, ALoop) {
  const auto rod = [](const std::string& name, const std::string& at, const std::string& to,
                      const std::string& inside) {
    return "<body name=\"" + name + "\" pos=\"" + at +
           "\"><joint axis=\"0 1 0\"/><geom type=\"capsule\" fromto=\"0 0 0 " + to + "\" size=\"0.03\"/>" + inside +
           "</body>";
  };
  const std::string loop =
      rod("a", "0 0 0", "0 0 0.5", rod("b", "0 0 0.5", "1 0 0.2", rod("c", "1 0 0.2", "0 0 -0.7", "")));
  expect_beside("loop",
                model_of(loop,
                         "<equality><connect body1=\"c\" anchor=\"0 0 -0.7\" solref=\"0.001 1\" "
                         "solimp=\"0.999 0.999 0.001\"/></equality>"),
                2e-4);
}

}  // namespace
}  // namespace cdot::test::mujoco_test
