// MJCF files -> scenes: masses by quadrature, motions in closed form and beside the URDF of the same mechanism, poses
// by hand, mistakes by file and line.
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <string>

#include "runtime/tool/import/model.hpp"
#include "runtime/tool/import/solids.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::mjcf_test {
namespace {

const double degree = std::acos(-1.0) / 180;

std::string text_of(const std::string& mjcf) {
  Model model = read_model(mjcf, "model.xml");
  return scene_text(model, {});
}
Scene imported(const std::string& mjcf, const std::string& more = "") {
  std::string text = text_of(mjcf);
  const std::string head = "dimension = 3\n";
  text.insert(text.find(head) + head.size(), more);
  return read_scene(text, "scene.toml");
}
// A model with this in its <worldbody>, and this beside it.
std::string model(const std::string& bodies, const std::string& beside = "") {
  return "<mujoco model=\"m\">\n" + beside + "<worldbody>\n" + bodies + "\n</worldbody></mujoco>";
}

// A body of elliptical slices with half axes a(z), b(z): its volume, and its moments about x and z.
template <class Slice>
Solid by_slices(double half, Slice slice) {
  constexpr int count = 20000;
  Solid sum;
  const double pi = std::acos(-1.0), dz = 2 * half / count;
  for (int k = 0; k < count; ++k) {
    const double z = -half + (k + 0.5) * dz;
    const auto [a, b] = slice(z);
    const double area = pi * a * b;
    sum.volume += area * dz;
    sum.inertia += dz * area * Eigen::Vector3d(b * b / 4 + z * z, a * a / 4 + z * z, (a * a + b * b) / 4);
  }
  sum.inertia /= sum.volume;
  return sum;
}

TEST(Mjcf, SolidsHaveTheMomentsOfTheirSlices) {
  const double r = 0.3, h = 0.5;
  const auto capsule = [&](double z) {
    const double beyond = std::max(0.0, std::abs(z) - h), s = std::sqrt(std::max(0.0, r * r - beyond * beyond));
    return std::pair(s, s);
  };
  const auto ellipsoid = [](double z) {
    const double s = std::sqrt(std::max(0.0, 1 - z * z / 0.49));
    return std::pair(0.2 * s, 0.4 * s);
  };
  const struct {
    const char* type;
    std::vector<double> size;
    Solid expected;
  } solids[] = {{"capsule", {r, h}, by_slices(h + r, capsule)},
                {"cylinder", {r, h}, by_slices(h, [&](double) { return std::pair(r, r); })},
                {"sphere",
                 {r},
                 by_slices(r,
                           [&](double z) {
                             const double s = std::sqrt(std::max(0.0, r * r - z * z));
                             return std::pair(s, s);
                           })},
                {"ellipsoid", {0.2, 0.4, 0.7}, by_slices(0.7, ellipsoid)}};
  for (const auto& [type, size, expected] : solids) {
    const std::optional<Solid> solid = solid_of(type, size);
    ASSERT_TRUE(solid) << type;
    EXPECT_NEAR(solid->volume, expected.volume, 1e-6 * expected.volume) << type;
    EXPECT_LT((solid->inertia - expected.inertia).norm(), 1e-6 * expected.inertia.norm()) << type;
  }
  // A box of 2 x 4 x 6: I_xx = m (16 + 36)/12.
  EXPECT_LT((solid_of("box", {1, 2, 3})->inertia - Eigen::Vector3d(52, 40, 20) / 12).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(solid_of("box", {1, 2, 3})->volume, 48);
}

// The scene of the URDF is compared with minimal coordinates in import_test.cpp.
TEST(Mjcf, MovesAsTheUrdfOfTheSameMechanism) {
  const std::string settings = "integrator = \"dop853\"\nlocal_error = 1e-10\nduration = 2\n";
  const Scene one = imported(read_text(scenes_dir() / "spatial/double_pendulum.xml"), settings);
  const Scene other = imported(read_text(scenes_dir() / "spatial/double_pendulum.urdf"), settings);
  ASSERT_EQ(one.bodies.size(), 2u);
  ASSERT_EQ(one.joints.size(), 2u);
  // Sideways, so that it moves at once.
  const auto pulled = [](Scene scene) {
    scene.settings.gravity_x = 4;
    return run_of(scene, 2, 0.5);
  };
  const std::vector<Frame> a = pulled(one), b = pulled(other);
  ASSERT_EQ(a.size(), b.size());
  double worst = 0, moved = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    for (std::size_t body = 0; body < 2; ++body) {
      worst = std::max({worst, std::abs(a[k].bodies[body].x - b[k].bodies[body].x),
                        std::abs(a[k].bodies[body].z - b[k].bodies[body].z)});
      moved = std::max(moved, std::abs(a[k].bodies[body].x));
    }
  EXPECT_GT(moved, 0.5);
  EXPECT_LT(worst, 1e-8);
}

// A slide with a spring: x = rest (1 - cos(w t)), w^2 = k/m; the reference of the joint shifts its coordinate.
TEST(Mjcf, ASlideSwingsAboutItsRest) {
  const Scene scene = imported(
      model("<body name=\"cart\" pos=\"1 0 0\"><joint type=\"slide\" axis=\"2 0 0\" stiffness=\"8\" springref=\"0.7\" "
            "ref=\"0.4\"/><geom type=\"box\" size=\"0.1 0.1 0.1\" mass=\"2\"/></body>"),
      "integrator = \"dop853\"\nlocal_error = 1e-10\nduration = 1\n");
  const std::vector<Frame> frames = run_of(scene, 1, 0.25);
  for (const Frame& frame : frames) EXPECT_NEAR(frame.bodies[0].x, 1 + 0.3 * (1 - std::cos(2 * frame.time)), 1e-8);
}

// An actuator of position holds at 0 by its stiffness: with the joint's spring, two springs as one; with a largest
// force it is a servo. One of velocity brakes.
TEST(Mjcf, ActuatorsHoldAndBrake) {
  const auto with = [](const std::string& actuator) {
    return text_of(
        model("<body><joint name=\"j\" axis=\"0 1 0\" stiffness=\"30\" springref=\"90\" damping=\"1\"/>"
              "<geom size=\"0.1\" pos=\"0 0 -1\" mass=\"1\"/></body>",
              "<actuator>" + actuator + "</actuator>"));
  };
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  };
  has(with(""), "angle.spring = { stiffness = 30, damping = 1, rest = 1.57079632679 }");
  // (30 * 90 + 10 * 0)/40 degrees
  has(with("<position joint=\"j\" kp=\"10\"/>"), "angle.spring = { stiffness = 40, damping = 1, rest = 1.1780972451 }");
  has(with("<position joint=\"j\" kp=\"10\" gear=\"2\" forcerange=\"-3 3\"/>"),
      "angle.servo = { target = 0, k = 40, most = 6 }");
  has(with("<velocity joint=\"j\" kv=\"2\" gear=\"2\"/>"), "damping = 9");
  has(with("<motor joint=\"j\"/>"), "# Left out: <motor> actuators, which are off until a program controls them.");
}

// Two hinges on one body turn it by the first, then by the second; limits that exclude 0 give both a start.
TEST(Mjcf, TwoHingesAreAUniversalJoint) {
  const Scene scene =
      imported(model("<body name=\"b\" pos=\"0 0 1\"><joint name=\"one\" axis=\"0 1 0\" range=\"30 60\"/>"
                     "<joint name=\"two\" axis=\"0 0 1\" range=\"20 50\"/>"
                     "<geom type=\"box\" size=\"0.3 0.2 0.1\" pos=\"0.5 0 0\"/></body>",
                     "<option gravity=\"0 0 0\"/>"),
               "duration = 0.1\nstep = 0.01\nintegrator = \"rattle\"\n");
  ASSERT_EQ(scene.joints.size(), 1u);
  EXPECT_EQ(scene.joints[0].definition.type, "universal");
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(30 * degree, Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(20 * degree, Eigen::Vector3d::UnitZ()));
  const Eigen::Vector3d centre = Eigen::Vector3d(0, 0, 1) + turned * Eigen::Vector3d(0.5, 0, 0);
  const SpatialBodyDefinition& body = scene.bodies[0].spatial;
  EXPECT_NEAR(body.x, centre.x(), 1e-11);
  EXPECT_NEAR(body.y, centre.y(), 1e-11);
  EXPECT_NEAR(body.z, centre.z(), 1e-11);
  // Its ends are those of the file: a body at rest on both of them stays.
  const Frame last = run_of(scene, 0.1, 0.1).back();
  EXPECT_NEAR(last.bodies[0].x, centre.x(), 1e-9);
  const auto world = build_world_in<Spatial<double>>(scene);
  EXPECT_NEAR(world.coordinate(0, "bend_a"), 30 * degree, 1e-11);
  EXPECT_NEAR(world.coordinate(0, "bend_b"), 20 * degree, 1e-11);
}

// Four rods in a square, closed by `connect`: it stays closed as it falls over.
TEST(Mjcf, LoopsAreClosed) {
  const auto rod = [](const char* name, const char* inside, const char* to) {
    return fmt::format(
        "<body name=\"{}\" pos=\"{}\"><joint axis=\"0 1 0\"/>"
        "<geom type=\"capsule\" fromto=\"0 0 0 {}\" size=\"0.02\"/>{}</body>",
        name,
        name[0] == 'a'   ? "0 0 0"
        : name[0] == 'b' ? "0 0 1"
                         : "1 0 0",
        to, inside);
  };
  const std::string bodies = rod("a", rod("b", rod("c", "", "0 0 -1").c_str(), "1 0 0").c_str(), "0 0 1");
  const std::string loop =
      "<equality><connect name=\"close\" body1=\"c\" anchor=\"0 0 -1\"/>"
      "<weld body1=\"a\" body2=\"b\" active=\"false\"/></equality>";
  const Scene scene = imported(model(bodies, loop + "<option gravity=\"1 0 -9.81\"/>"),
                               "step = 0.002\nintegrator = \"rattle\"\nduration = 1\n");
  ASSERT_EQ(scene.joints.size(), 4u);
  EXPECT_EQ(scene.joints[3].name, "close");
  const std::vector<Frame> frames = run_of(scene, 1, 0.25);
  for (const Frame& frame : frames) {  // the middle of b lies above the middle between the two ends in the ground
    const BodyState &a = frame.bodies[0], &b = frame.bodies[1], &c = frame.bodies[2];
    EXPECT_NEAR(b.x - a.x, 0.5 + a.x, 1e-8);
    EXPECT_NEAR(c.x - a.x, 1, 1e-8);
    EXPECT_NEAR(a.z, c.z, 1e-8);
  }
  EXPECT_GT(frames.back().bodies[0].x, 0.05);
  EXPECT_NE(text_of(model(bodies, loop)).find("# Left out: <weld> of <equality>, which is not active."),
            std::string::npos);
}

// Two slides and a hinge across them leave a plane; three of each, or a free joint, leave everything.
TEST(Mjcf, JointsOfOneBodyAreOne) {
  const auto body = [](const std::string& joints) {
    return model("<body name=\"b\">" + joints + "<geom size=\"0.1\"/></body>");
  };
  const std::string x = "<joint type=\"slide\" axis=\"1 0 0\"/>", y = "<joint type=\"slide\" axis=\"0 1 0\"/>",
                    z = "<joint type=\"slide\" axis=\"0 0 1\"/>", about_x = "<joint axis=\"1 0 0\"/>",
                    about_y = "<joint axis=\"0 1 0\"/>", about_z = "<joint axis=\"0 0 1\"/>";
  const auto type_of = [&](const std::string& joints) {
    const Scene scene = imported(body(joints));
    return scene.joints.empty() ? "free" : scene.joints[0].definition.type;
  };
  EXPECT_EQ(type_of(x), "slider");
  EXPECT_EQ(type_of(x + z + about_y), "planar_joint");
  EXPECT_EQ(type_of("<joint type=\"ball\"/>"), "spherical");
  EXPECT_EQ(type_of(about_x + about_y + about_z), "spherical");
  EXPECT_EQ(type_of("<freejoint/>"), "free");
  EXPECT_EQ(type_of("<joint type=\"free\"/>"), "free");
  EXPECT_EQ(type_of(x + y + z + about_x + about_y + about_z), "free");
  const Scene falling = imported(body("<freejoint/>"), "duration = 1\n");
  EXPECT_NEAR(run_of(falling, 1, 1).back().bodies[0].z, -9.81 / 2, 1e-4);
  const Scene still =
      imported(model("<body><freejoint/><geom size=\"1\"/></body>", "<option gravity=\"0 0 -2\"/>"), "duration = 1\n");
  EXPECT_NEAR(run_of(still, 1, 1).back().bodies[0].z, -1, 1e-4);
}

// Orientations in each way that MJCF has, of a body that hangs from a hinge: its centre is at R (1, 0, 0).
TEST(Mjcf, OrientationsInEveryWay) {
  const auto centre = [](const std::string& orientation, const std::string& compiler = "") {
    const Scene scene =
        imported(model("<body " + orientation + "><joint/><geom size=\"0.1\" pos=\"1 0 0\"/></body>", compiler));
    const SpatialBodyDefinition& body = scene.bodies[0].spatial;
    return Eigen::Vector3d(body.x, body.y, body.z);
  };
  const auto turn = [](double angle, const Eigen::Vector3d& axis) { return Eigen::AngleAxisd(angle * degree, axis); };
  const Eigen::Vector3d X = Eigen::Vector3d::UnitX(), Y = Eigen::Vector3d::UnitY(), Z = Eigen::Vector3d::UnitZ();
  const auto expect = [](const Eigen::Vector3d& is, const Eigen::Vector3d& should) {
    EXPECT_LT((is - should).norm(), 1e-11);
  };
  expect(centre("euler=\"10 20 30\""), turn(10, X) * turn(20, Y) * turn(30, Z) * X);
  expect(centre("euler=\"10 20 30\"", "<compiler eulerseq=\"XYZ\"/>"), turn(30, Z) * turn(20, Y) * turn(10, X) * X);
  expect(centre("euler=\"10 20 30\"", "<compiler eulerseq=\"zyx\"/>"), turn(10, Z) * turn(20, Y) * turn(30, X) * X);
  expect(centre("axisangle=\"0 0 2 90\""), Y);
  expect(centre("axisangle=\"0 0 2 1.5707963267948966\"", "<compiler angle=\"radian\"/>"), Y);
  expect(centre("quat=\"2 0 0 2\""), Y);
  expect(centre("xyaxes=\"0 2 0 -1 5 0\""), Y);
  expect(centre("zaxis=\"1 0 0\""), -Z);
}

// A class gives its attributes to those of its name, to the children of a body, and takes those around it.
TEST(Mjcf, ClassesAreInherited) {
  const std::string defaults =
      "<default><joint damping=\"1\" frictionloss=\"5\"/><geom density=\"2000\"/>"
      "<default class=\"soft\"><joint damping=\"2\" stiffness=\"7\"/></default></default>";
  const auto text = [&](const std::string& body, const std::string& joint) {
    return text_of(
        model("<body " + body + "><joint " + joint + "/><geom type=\"box\" size=\"0.5 0.5 0.5\"/></body>", defaults));
  };
  EXPECT_NE(text("", "").find("damping = 1 }"), std::string::npos);
  EXPECT_NE(text("", "").find("mass        = 2000"), std::string::npos);
  for (const std::string& soft : {text("", "class=\"soft\""), text("childclass=\"soft\"", "")}) {
    EXPECT_NE(soft.find("stiffness = 7, damping = 2"), std::string::npos) << soft;
    EXPECT_NE(soft.find("friction = 5"), std::string::npos) << soft;
  }
  EXPECT_NE(text("childclass=\"soft\"", "damping=\"3\"").find("stiffness = 7, damping = 3"), std::string::npos);
}

std::string message_of(const std::string& mjcf) {
  try {
    text_of(mjcf);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Mjcf, MistakesAreToldByFileAndLine) {
  const auto body = [](const std::string& joint, const std::string& geom = "<geom size=\"1\"/>") {
    return model("<body name=\"b\">\n" + joint + geom + "</body>");
  };
  const std::pair<std::string, std::string> cases[] = {
      {"<mujoco/>", "model.xml:1: the model has no <body>"},
      {"<mujoco><include file=\"no_such.xml\"/></mujoco>", "model.xml:1: there is no no_such.xml to include"},
      {body("<joint/>", ""),
       "model.xml:3: body \"b\" moves and has no mass. Likely fix: an <inertial>, or a simple geom"},
      {body("<joint/>", "<geom type=\"mesh\"/>"), "model.xml:3: body \"b\" moves and has no mass"},
      {body(""), "no body moves: the scene would be empty"},
      {body("<joint type=\"wheel\"/>"), "model.xml:4: a joint has no type \"wheel\"; one of hinge, slide, ball, free"},
      {body("<joint axis=\"0 0 0\"/>"), "model.xml:4: `axis` of <joint> is a direction of length 0"},
      {body("<joint axis=\"0 1\"/>"), "model.xml:4: `axis` of <joint> is \"0 1\": it takes 3 finite numbers"},
      {body("<joint range=\"2 1\"/>"), "model.xml:4: `range` of <joint> runs from 2 to 1"},
      {body("<joint class=\"no\"/>"), "model.xml:4: there is no class \"no\""},
      {body("<joint damping=\"-1\"/>"), "model.xml:4: `damping` of <joint> is -1: it must not be negative"},
      {body("<freejoint/><joint/>"), "model.xml:3: body \"b\" is free and has other joints too"},
      {body("<joint/>", "<geom type=\"box\" size=\"1 1\"/>"), "model.xml:4: a box needs a positive `size`"},
      {body("<joint/>", "<geom size=\"a\"/>"), "model.xml:4: `size` of <geom> is \"a\": it takes finite numbers"},
      {body("<joint/>", "<inertial mass=\"1\" pos=\"0 0 0\" diaginertia=\"1 1 3\"/>"),
       "no rigid body has this inertia tensor"},
      {model("<body name=\"b\"><joint/><geom size=\"1\"/></body>", "<equality><connect body1=\"a\"/></equality>"),
       "there is no body \"a\"; did you mean \"b\"?"},
      {model("<body name=\"b\"><joint/><geom size=\"1\"/><body name=\"b\"/></body>"),
       "a second body has the name \"b\""},
      {"<sdf/>", "model.xml:1: this is SDF"},
      {"<robots/>", "a URDF begins with <robot>, an MJCF file with <mujoco>"},
  };
  for (const auto& [mjcf, message] : cases)
    EXPECT_NE(message_of(mjcf).find(message), std::string::npos) << message << "\n" << message_of(mjcf);
}

// A scene's names have no slashes: they change, each to a name of its own.
TEST(Mjcf, NamesBecomeValid) {
  const std::string body = "<body name=\"arm/0\"><joint name=\"arm 0\"/><geom size=\"1\"/></body>";
  const std::string text = text_of(model(body + "<body name=\"arm.0\"><joint/><geom size=\"1\"/></body>"));
  for (const char* part : {"# Changed: the name \"arm/0\" is arm_0.", "# Changed: the name \"arm.0\" is arm_0_2.",
                           "bodies = [\"world\", \"arm_0_2\"]"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
}

// Included files stand where they are named, also within bodies and in each other; their paths are those from the
// model.
TEST(Mjcf, FilesAreIncluded) {
  const TemporaryFolder folder;
  const auto write = [&](const char* name, const std::string& text) { std::ofstream(folder / name) << text; };
  write("classes.xml", "<mujocoinclude><default><geom density=\"500\"/></default></mujocoinclude>");
  write("arm.xml",
        "<mujocoinclude><body name=\"arm\" pos=\"0 0 1\"><joint/><include file=\"shape.xml\"/></body></mujocoinclude>");
  write("shape.xml", "<mujocoinclude><geom type=\"box\" size=\"0.5 0.5 0.5\"/></mujocoinclude>");
  const auto read = [&](const std::string& text) {
    Model model = read_model(text, (folder / "model.xml").string());
    return scene_text(model, {});
  };
  const std::string text = read(model("<include file=\"arm.xml\"/>", "<include file=\"classes.xml\"/>"));
  EXPECT_NE(text.find("name        = \"arm\"\nmass        = 500"), std::string::npos) << text;
  const auto mistake = [&](const std::string& world) -> std::string {
    try {
      return read(model(world));
    } catch (const Error& error) {
      return error.what();
    }
  };
  EXPECT_NE(mistake("<include file=\"arm.xml\"/><include file=\"arm.xml\"/>").find("arm.xml is included twice"),
            std::string::npos);
  write("broken.xml", "<mujocoinclude>\n<body>");
  EXPECT_NE(mistake("<include file=\"broken.xml\"/>").find("broken.xml:2: this is no XML"), std::string::npos);
  write("shape.xml", "<mujocoinclude><geom type=\"box\" size=\"1\"/></mujocoinclude>");
  EXPECT_NE(mistake("<include file=\"arm.xml\"/>").find("model.xml, in a file that it includes: a box needs"),
            std::string::npos);
  write("shape.xml", "<mujocoinclude/>");
  EXPECT_NE(
      mistake("<include file=\"arm.xml\"/>").find("model.xml, in a file that it includes: body \"arm\" moves and"),
      std::string::npos);
  write("endless.xml", "<mujocoinclude><include file=\"endless.xml\"/></mujocoinclude>");
  EXPECT_NE(mistake("<include file=\"endless.xml\"/>").find("endless.xml is included twice"), std::string::npos);
}

// Coupled joints need a spec: it goes beside the scene, under the scene's name.
TEST(Mjcf, CoupledJointsBringTheirSpec) {
  const TemporaryFolder folder;
  const auto hinge = [](const char* name, const char* range) {
    return fmt::format(
        "<body name=\"{0}\"><joint name=\"{0}\" axis=\"0 1 0\"{1}/><geom size=\"0.1\" pos=\"0 0 -1\"/></body>", name,
        range);
  };
  std::ofstream(folder / "two.xml") << model(
      hinge("p", "") + hinge("q", " range=\"30 60\""),
      "<equality><joint name=\"both\" joint1=\"q\" joint2=\"p\" polycoef=\"0 2 0 0 0\"/></equality>");
  const std::string from = (folder / "two.xml").string(), scene = (folder / "two arms.toml").string();
  const CommandResult well = cdot_run(fmt::format("import '{}' -o '{}'", from, scene));
  EXPECT_EQ(well.status, 0) << well.err;
  EXPECT_NE(well.out.find("wrote     two_arms_both.joint"), std::string::npos) << well.out;
  EXPECT_NE(read_text(folder / "two_arms_both.joint").find("  follows: x1 = 2*x2\n"), std::string::npos);
  // q starts at its limit of 30 degrees, so p is taken to 15.
  auto projected = build_world_in<Spatial<double>>(read_scene(scene));
  projected.project(1e-12);
  EXPECT_NEAR(projected.coordinate(2, "q1") + 30 * degree, 2 * projected.coordinate(2, "q2"), 1e-9);
  const CommandResult alone = cdot_run(fmt::format("import '{}'", from));
  EXPECT_EQ(alone.status, 2);
  EXPECT_NE(alone.err.find("goes beside the scene. Likely fix: -o FILE"), std::string::npos) << alone.err;
}

TEST(Mjcf, TheCommandReadsIt) {
  const TemporaryFolder folder;
  const std::string scene = (folder / "arm.toml").string();
  const CommandResult well =
      cdot_run(fmt::format("import '{}' -o '{}'", (scenes_dir() / "spatial/double_pendulum.xml").string(), scene));
  EXPECT_EQ(well.status, 0) << well.err;
  EXPECT_NE(well.out.find("2 bodies and 2 joints, of 4 links and 3 joints"), std::string::npos) << well.out;
  EXPECT_NE(well.out.find("left out  <motor> actuators"), std::string::npos) << well.out;
  EXPECT_EQ(cdot_run(fmt::format("simulate '{}'", scene)).status, 0);
}

}  // namespace
}  // namespace cdot::test::mjcf_test
