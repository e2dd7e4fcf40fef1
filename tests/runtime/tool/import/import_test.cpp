// Robot descriptions -> scenes: masses by hand, motions by minimal coordinates, mistakes by file and line.
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <string>

#include "runtime/tool/import/model.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::import_test {
namespace {

std::string double_pendulum() { return (source_dir() / "specs/scenes/spatial/double_pendulum.urdf").string(); }

Scene imported(const std::string& urdf, const std::string& more = "", bool floating = false) {
  Model model = read_urdf(urdf, "model.urdf");
  std::string text = scene_text(model, {.floating = floating});
  const std::string head = "dimension = 3\n";
  text.insert(text.find(head) + head.size(), more);
  return read_scene(text, "scene.toml");
}

const BodyState& state_of(const Scene& scene, const Frame& frame, const std::string& name) {
  for (std::size_t k = 0; k < scene.bodies.size(); ++k)
    if (scene.bodies[k].name == name) return frame.bodies[k];
  throw std::out_of_range(name);
}

// The lower rod and its bob: centre 0.6 m below the elbow, 0.168 + 2 0.1^2 + 0.001 + 0.5 0.4^2 = 0.269 kg m^2 across.
TEST(Import, LinksOfAFixedJointAreOneBody) {
  const Scene scene = imported(read_text(double_pendulum()));
  ASSERT_EQ(scene.bodies.size(), 2u);
  ASSERT_EQ(scene.joints.size(), 2u);
  EXPECT_EQ(scene.bodies[1].name, "lower");
  const SpatialBodyDefinition& lower = scene.bodies[1].spatial;
  EXPECT_NEAR(lower.mass, 2.5, 1e-12);
  EXPECT_NEAR(lower.z, 0.4, 1e-12);
  EXPECT_NEAR(lower.inertia.xx, 0.269, 1e-12);
  EXPECT_NEAR(lower.inertia.yy, 0.003, 1e-12);  // along the rod
  EXPECT_NEAR(lower.inertia.zz, 0.269, 1e-12);
}

// Two absolute angles from the vertical, after R. M. Murray, Z. Li, S. S. Sastry, "A Mathematical Introduction to
// Robotic Manipulation", 1994, 4.2, with rods of 1 m, a damped elbow, and gravity along x and z.
struct Pendulum {
  static constexpr double m1 = 1, c1 = 0.5, I1 = 0.084, l1 = 1, m2 = 2.5, c2 = 0.6, I2 = 0.269, damping = 0.1;
  static constexpr double gx = 4, gz = -9.81;
  double q[4] = {};  // angles, rates

  static void rates(const double* q, double* to) {
    const double across = m2 * l1 * c2, M11 = I1 + m1 * c1 * c1 + m2 * l1 * l1, M22 = I2 + m2 * c2 * c2,
                 M12 = across * std::cos(q[0] - q[1]), C = across * std::sin(q[0] - q[1]);
    const auto weight = [](double angle) { return gx * std::cos(angle) + gz * std::sin(angle); };
    const double drag = damping * (q[2] - q[3]);
    const double f1 = (m1 * c1 + m2 * l1) * weight(q[0]) - C * q[3] * q[3] - drag;
    const double f2 = m2 * c2 * weight(q[1]) + C * q[2] * q[2] + drag;
    const double det = M11 * M22 - M12 * M12;
    to[0] = q[2], to[1] = q[3], to[2] = (M22 * f1 - M12 * f2) / det, to[3] = (M11 * f2 - M12 * f1) / det;
  }
  void step(double h) {
    double k[4][4], at[4];
    for (int stage = 0; stage < 4; ++stage) {
      const double part = stage == 0 ? 0 : stage == 3 ? h : h / 2;
      for (int i = 0; i < 4; ++i) at[i] = q[i] + (stage == 0 ? 0 : part * k[stage - 1][i]);
      rates(at, k[stage]);
    }
    for (int i = 0; i < 4; ++i) q[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
  }
};

TEST(Import, MovesAsByMinimalCoordinates) {
  const Scene scene = imported(read_text(double_pendulum()),
                               "gravity = [4, 0, -9.81]\nintegrator = \"dop853\"\nlocal_error = 1e-10\nduration = 3\n");
  const std::vector<Frame> frames = run_of(scene, 3, 0.5);
  Pendulum pendulum;
  double worst = 0, moved = 0;
  for (const Frame& frame : frames) {
    for (double t = frame.time - 0.5; frame.time > 0 && t < frame.time - 1e-9; t += 0.001) pendulum.step(0.001);
    const double *q = pendulum.q, x = std::sin(q[0]) + 0.6 * std::sin(q[1]),
                 z = 2 - std::cos(q[0]) - 0.6 * std::cos(q[1]);
    const BodyState& lower = state_of(scene, frame, "lower");
    worst = std::max(worst, std::hypot(lower.x - x, lower.y, lower.z - z));
    moved = std::max(moved, std::abs(x));
  }
  fmt::print("{:.1e} m apart at {} times, after {:.2f} m\n", worst, frames.size(), moved);
  EXPECT_GT(moved, 0.5);
  EXPECT_LT(worst, 1e-7);
}

constexpr const char* lift = R"(<robot name="lift">
<link name="world"/>
<link name="cage"><inertial><mass value="3"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>
<joint name="shaft" type="prismatic"><origin xyz="1 2 3"/><parent link="world"/><child link="cage"/><axis xyz="0 0 2"/>
<limit lower="-0.25" upper="1"/><dynamics friction="10"/></joint>
</robot>)";

// It falls by (9.81 - 10/3) t^2 / 2 until it stands on the lower end.
TEST(Import, SlidesWithFrictionToTheEnd) {
  const Scene scene = imported(lift, "step = 0.0005\nintegrator = \"rk4\"\nduration = 1\n");
  const std::vector<Frame> frames = run_of(scene, 1, 0.1);
  EXPECT_NEAR(frames[2].bodies[0].z, 3 - (9.81 - 10.0 / 3) * 0.2 * 0.2 / 2, 1e-6);
  EXPECT_NEAR(frames.back().bodies[0].z, 2.75, 1e-6);
  EXPECT_NEAR(frames.back().bodies[0].x, 1, 1e-9);
}

TEST(Import, AFloatingRootIsABody) {
  std::string urdf = lift;
  urdf.replace(
      urdf.find("<link name=\"world\"/>"), 20,
      "<link name=\"world\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial></link>");
  const Scene scene = imported(urdf, "duration = 1\n", true);
  ASSERT_EQ(scene.bodies.size(), 2u);
  EXPECT_EQ(scene.bodies[0].name, "world_link");  // "world" is what never moves
  EXPECT_NEAR(run_of(scene, 1, 1).back().bodies[0].z, -9.81 / 2, 1e-4);
}

std::string message_of(const std::string& urdf) {
  try {
    Model model = read_urdf(urdf, "model.urdf");
    scene_text(model, {});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// `lift` with one change.
std::string changed(const std::string& from, const std::string& to) {
  std::string urdf = lift;
  urdf.replace(urdf.find(from), from.size(), to);
  return urdf;
}

TEST(Import, MistakesAreToldByFileAndLine) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"<robot", "model.urdf:1: this is no XML"},
      {"", "model.urdf:0: this is no XML"},
      {"<robot name=\"r\"/>", "model.urdf:1: the robot has no <link>"},
      {changed("\"cage\"/>", "\"cagf\"/>"), "model.urdf:4: there is no link \"cagf\"; did you mean \"cage\"?"},
      {changed("prismatic", "slider"), "model.urdf:4: a joint has no type \"slider\""},
      {changed("0 0 2", "0 0 0"), "model.urdf:4: `xyz` of <axis> is a direction of length 0"},
      {changed("0 0 2", "0 0"), "model.urdf:4: `xyz` of <axis> is \"0 0\": it takes 3 finite numbers"},
      {changed("1 2 3", "1 2 nan"), "model.urdf:4: `xyz` of <origin> is \"1 2 nan\": it takes 3 finite numbers"},
      {changed("izz=\"1\"", "izz=\"9\""), "model.urdf:3: link \"cage\": no rigid body has this inertia tensor"},
      {changed("<inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/>", ""), "model.urdf:3: link \"cage\" turns and has no inertia"},
      {changed("<limit lower=\"-0.25\" upper=\"1\"/>", ""), "model.urdf:4: joint \"shaft\" needs a <limit>"},
      {changed("friction=\"10\"", "friction=\"-1\""), "model.urdf:5: `friction` of <dynamics> is -1"},
      {changed("value=\"3\"", "value=\"0\""), "model.urdf:3: link \"cage\" moves and has no mass"},
      {"<robot name=\"floor\"><link name=\"plane\"/></robot>", "model.urdf:1: no link moves, and none has a mass"},
      {changed("</robot>", "<link name=\"lost\"/></robot>"), "no joint holds link \"lost\", nor \"world\""},
      {changed("name=\"cage\"", "name=\"world\""), "model.urdf:3: a second link has the name \"world\""},
      {changed("<parent link=\"world\"/>", "<parent link=\"cage\"/>"), "link \"cage\" hangs from itself"},
      {changed("<link name=\"world\"/>", "<xacro:macro/>"), "model.urdf:2: this is a macro of xacro"},
  };
  for (const auto& [urdf, message] : cases)
    EXPECT_NE(message_of(urdf).find(message), std::string::npos) << message << "\n" << message_of(urdf);
}

TEST(Import, ListsWhatItLeavesOut) {
  const Model model = read_urdf(read_text(double_pendulum()), "model.urdf");
  EXPECT_EQ(model.left_out,
            (std::vector<std::string>{"<collision> of links", "<transmission>", "the largest effort of joints",
                                      "the largest velocity of joints"}));
}

// Limits in the wrong order are no limits to some programs: they are told, and left out.
TEST(Import, LimitsInTheWrongOrderAreLeftOut) {
  Model model = read_urdf(changed("-0.25", "2"), "model.urdf");
  EXPECT_EQ(model.left_out.at(0), "the limits of joint \"shaft\", which run from 2 to 1");
  EXPECT_EQ(scene_text(model, {}).find("limit ="), std::string::npos);
}

// 0 is no place for a lift between 0.5 m and 1 m: it starts at 0.5 m and stands there.
TEST(Import, StartsWithinItsLimits) {
  Model model = read_urdf(changed("-0.25", "0.5"), "model.urdf");
  EXPECT_NE(scene_text(model, {}).find("slide.limit = { lower = 0, upper = 0.5 }"), std::string::npos);
  EXPECT_EQ(model.changed.at(0), "joint \"shaft\" starts at 0.5, its limit, and its coordinate counts from there");
  const Scene scene = imported(changed("-0.25", "0.5"), "step = 0.001\nintegrator = \"rk4\"\nduration = 1\n");
  EXPECT_NEAR(run_of(scene, 1, 1).back().bodies[0].z, 3.5, 1e-6);
}

// A plate's largest moment is the sum of the other two: no rounding of the turned tensor may make it more.
TEST(Import, PlatesKeepTheirInertia) {
  const Scene scene = imported(changed("<mass value=\"3\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/>",
                                       "<origin rpy=\"0.3 0.4 0.5\"/><mass value=\"3\"/><inertia ixx=\"0.01\" "
                                       "iyy=\"0.02\" izz=\"0.03\"/>"));
  const Inertia& I = scene.bodies.at(0).spatial.inertia;
  const double determinant =
      I.xx * (I.yy * I.zz - I.yz * I.yz) - I.xy * (I.xy * I.zz - I.yz * I.xz) + I.xz * (I.xy * I.yz - I.yy * I.xz);
  EXPECT_NEAR(I.xx + I.yy + I.zz, 0.06, 1e-16);
  EXPECT_NEAR(determinant, 0.01 * 0.02 * 0.03, 1e-19);
  EXPECT_GT(std::abs(I.xy) + std::abs(I.xz) + std::abs(I.yz), 1e-3);
}

TEST(Import, BalancesInertiasOnRequest) {
  Model model = read_urdf(changed("izz=\"1\"", "izz=\"7\""), "model.urdf");
  const std::string text = scene_text(model, {.balance = true});
  EXPECT_EQ(model.changed.at(0), "the inertia of link \"cage\", which no rigid body has: it is 3 about all axes");
  EXPECT_NE(text.find("inertia     = [[3, 0, 0], [0, 3, 0], [0, 0, 3]]"), std::string::npos);
}

// A single link is an object, not the world.
TEST(Import, ASingleLinkFalls) {
  const Scene scene = imported(
      "<robot name=\"r\"><link name=\"cube\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" "
      "iyy=\"1\" izz=\"1\"/></inertial></link></robot>",
      "duration = 1\n");
  ASSERT_EQ(scene.bodies.size(), 1u);
  EXPECT_NEAR(run_of(scene, 1, 1).back().bodies[0].z, -9.81 / 2, 1e-4);
}

TEST(Import, NamesMayHoldLineEndsAndQuotes) {
  Model model = read_urdf(changed("robot name=\"lift\"", "robot name=\"a &quot;lift&quot;&#10;up\""), "model\n.urdf");
  const Scene scene = read_scene(scene_text(model, {}), "scene.toml");
  EXPECT_EQ(scene.title, "a \"lift\"\nup");
}

TEST(Import, TheCommandWritesASceneOrNothing) {
  const TemporaryFolder folder;
  const std::string scene = (folder / "arm.toml").string(), wrong = (folder / "wrong.urdf").string();
  const CommandResult well = cdot_run(fmt::format("import '{}' -o '{}'", double_pendulum(), scene));
  EXPECT_EQ(well.status, 0) << well.err;
  EXPECT_NE(well.out.find("2 bodies and 2 joints, of 4 links and 3 joints"), std::string::npos) << well.out;
  EXPECT_EQ(cdot_run(fmt::format("simulate '{}'", scene)).status, 0);
  std::ofstream(wrong) << changed("izz=\"1\"", "izz=\"9\"");  // more than the other two together
  const CommandResult refused = cdot_run(fmt::format("import '{}' -o '{}'", wrong, (folder / "none.toml").string()));
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("inertia"), std::string::npos) << refused.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "none.toml"));
}

}  // namespace
}  // namespace cdot::test::import_test
