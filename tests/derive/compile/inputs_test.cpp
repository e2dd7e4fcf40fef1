// Numbers of a compiled scene that a run may change: the step is then that of a scene with these numbers.
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <unistd.h>

#include "arm_with_inputs.hpp"
#include "tailgate_with_inputs.hpp"
#include "tests/derive/compile/beside_world.hpp"
#include "tests/derive/compile/command.hpp"

namespace {

namespace fs = std::filesystem;
using cdot::Integrator;
using namespace cdot::scenes;

// The scene with other text in these places.
cdot::Scene changed(const std::string& file, const std::vector<std::pair<std::string, std::string>>& changes) {
  std::ifstream in(std::string(CDOT_SOURCE_DIR) + "/" + file);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  for (const auto& [from, to] : changes) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) text.replace(at, from.size(), to);
  }
  return cdot::read_scene(text, "changed.toml");
}

template <class Compiled>
double farthest(typename Compiled::State& state, cdot::World<double> world) {
  double most = 0;
  for (int k = 0; k < 700; ++k) {
    EXPECT_TRUE(world.step(0.001));
    Compiled::step(state, 0.001);
    most = std::max(most, cdot::distance<Compiled>(state, world));
  }
  return most;
}

TEST(CompiledInputs, BeginAsInTheScene) {
  cdot::runs_as_the_world<arm_with_inputs<double>>("specs/scenes/robot_arm.toml", Integrator::euler);
  cdot::runs_as_the_world<tailgate_with_inputs<double>>("specs/scenes/tailgate.toml", Integrator::rk4);
}

TEST(CompiledInputs, MoveAsASceneWithTheseNumbers) {
  arm_with_inputs<double>::State arm;
  arm_with_inputs<double>::reset(arm);
  arm.p.shoulder_angle_servo_target = 0.75, arm.p.wrist_angle_brake_torque = 2;
  const cdot::Scene other_arm =
      changed("specs/scenes/robot_arm.toml", {{"target = \"20 deg\"", "target = 0.75"}, {"brake = 6", "brake = 2"}});
  EXPECT_LT(farthest<arm_with_inputs<double>>(arm, cdot::world_of(other_arm, Integrator::euler)), 1e-10);

  tailgate_with_inputs<double>::State gate;
  tailgate_with_inputs<double>::reset(gate);
  gate.p.brake_d = 400;
  tailgate_with_inputs<double>::begin(gate);
  const cdot::Scene other_gate = changed("specs/scenes/tailgate.toml", {{"= 1000", "= 400"}});
  EXPECT_LT(farthest<tailgate_with_inputs<double>>(gate, cdot::world_of(other_gate, Integrator::rk4)), 1e-10);
}

// The same header as by the option, but for the command in its first lines.
TEST(CompiledInputs, AreMarkedByTheScene) {
  const auto lines = [](const cdot::ShellResult& header) {
    EXPECT_EQ(header.status, 0) << header.text;
    return header.text.substr(header.text.find("#pragma once"));
  };
  const fs::path folder = fs::temp_directory_path() / ("cdot_marked_inputs_" + std::to_string(getpid()));
  fs::create_directory(folder);
  const std::string marked = folder / "robot_arm.toml";
  std::ifstream in(CDOT_SOURCE_DIR "/specs/scenes/robot_arm.toml");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  std::ofstream(marked) << "inputs = [\"shoulder.angle.servo.target\"]\n" << text;
  const std::string header = lines(cdot::compile(marked + " --integrator euler"));
  EXPECT_NE(header.find("T shoulder_angle_servo_target;"), std::string::npos);
  EXPECT_EQ(header, lines(cdot::compile("specs/scenes/robot_arm.toml --integrator euler --input "
                                        "shoulder.angle.servo.target")));
  std::ofstream(marked) << "inputs = [\"shulder.angle.servo.target\"]\n" << text;
  const cdot::ShellResult wrong = cdot::compile(marked);
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.text.find(":1:11: error: no joint is called \"shulder\""), std::string::npos) << wrong.text;
  EXPECT_NE(wrong.text.find("did you mean `shoulder`?"), std::string::npos) << wrong.text;
  fs::remove_all(folder);
}

TEST(CompiledInputs, MisspeltNamesAreToldTheRightOne) {
  const cdot::ShellResult wrong =
      cdot::compile("specs/scenes/robot_arm.toml --integrator euler --input wrist.angle.brake.torqe");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.text.find("no number of this scene is called wrist_angle_brake_torqe (did you mean "
                            "wrist_angle_brake_torque?)"),
            std::string::npos)
      << wrong.text;
}

}  // namespace
