// The playground's engine, asked as the page asks it. The numbers expected are worked out by hand.
#include "derive/play/engine.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <unistd.h>

#include "derive/play/trial.hpp"

namespace {

using nlohmann::json;
namespace fs = std::filesystem;

// A folder like the page's: the specs of the catalogue that these scenes need.
class Play : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("cdot_play_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    before_ = fs::current_path();
    fs::current_path(folder_);
    json files;
    for (const char* name : {"specs/planar/line.joint", "specs/planar/revolute.joint"}) {
      std::ifstream in(fs::path(CDOT_SOURCE_DIR) / name);
      files[name] = std::string(std::istreambuf_iterator<char>(in), {});
    }
    ask({{"do", "write"}, {"files", files}});
  }
  void TearDown() override {
    fs::current_path(before_);
    fs::remove_all(folder_);
  }

  json ask(const json& request) { return json::parse(engine_.ask(request.dump())); }
  json load(const std::string& scene, json wishes = json::object()) {
    ask({{"do", "write"}, {"files", {{"specs/planar/scene.toml", scene}}}});
    wishes["do"] = "load", wishes["path"] = "specs/planar/scene.toml";
    return ask(wishes);
  }
  json run(double seconds) {
    json state;
    for (int k = 0; k < std::lround(seconds * 60); ++k) state = ask({{"do", "step"}, {"time", 1.0 / 60}});
    return state;
  }

 private:
  fs::path folder_, before_;
  cdot::play::Engine engine_;
};

const std::string free_body = R"(
gravity = [0, -10]
[[body]]
name  = "stone"
mass  = 2
shape = { disc = 0.5 }
)";

// x = -g t^2 / 2, by a method of second order: exact.
TEST_F(Play, AFreeBodyFalls) {
  const json scene = load(free_body, {{"method", "rattle"}, {"rate", 240}});
  ASSERT_FALSE(scene.contains("problems")) << scene;
  EXPECT_EQ(scene["bodies"][0]["shape"]["kind"], "disc");
  const json state = run(2);
  EXPECT_NEAR(state["time"].get<double>(), 2, 1e-9);
  EXPECT_NEAR(state["bodies"][1].get<double>(), -20, 1e-9);
}

// Without gravity the change leaves the velocity: 1 s at 10 m/s after the first second's fall of 5 m.
TEST_F(Play, GravityChangesOnTheWay) {
  load(free_body, {{"method", "rattle"}});
  run(1);
  ask({{"do", "change"}, {"method", "rattle"}, {"gravity", {0, 0, 0}}});
  const json state = run(1);
  EXPECT_NEAR(state["time"].get<double>(), 2, 1e-9);
  EXPECT_NEAR(state["bodies"][1].get<double>(), -15, 1e-9);
}

// The pointer's spring brings the grabbed centre to the pointer; gravity stretches it by m g / k, k = m (6 rad/s)^2.
TEST_F(Play, ThePointerPulls) {
  load(free_body);
  ask({{"do", "drag"}, {"body", 0}, {"local", {0, 0, 0}}, {"target", {0, 0, 0}}});
  ask({{"do", "drag"}, {"body", 0}, {"local", {0, 0, 0}}, {"target", {3, 4, 0}}});
  const json held = run(20);
  EXPECT_NEAR(held["bodies"][0].get<double>(), 3, 1e-3);
  EXPECT_NEAR(held["bodies"][1].get<double>(), 4 - 10.0 / 36, 1e-3);
  ask({{"do", "drop"}});
  EXPECT_LT(run(1)["bodies"][1].get<double>(), held["bodies"][1].get<double>() - 4);
}

const std::string own_joint = R"(joint ring planar
  point pa on a
  point pb on b
  scalar r [m] = norm(pa - pb)
  norm(pa - pb) = r
)";
const std::string bead = R"(
gravity = [0, -10]
[[body]]
name     = "bead"
mass     = 1
shape    = { disc = 0.1 }
position = [2, 0]
[[joint]]
type   = "ring"
bodies = ["bead", "world"]
pa     = [0, 0]
pb     = [0, 0]
)";

// A joint that was typed a moment ago: the bead stays on its circle, and falls through it with v^2 = 2 g r.
TEST_F(Play, ATypedJointMoves) {
  ask({{"do", "write"}, {"files", {{"specs/planar/ring.joint", own_joint}}}});
  const json scene = load(bead, {{"rate", 1000}, {"method", "rattle"}});
  ASSERT_FALSE(scene.contains("problems")) << scene;
  EXPECT_EQ(scene["joints"][0]["type"], "ring");
  const double start = scene["state"]["energy"];
  const json state = run(1.5);
  EXPECT_NEAR(std::hypot(state["bodies"][0].get<double>(), state["bodies"][1].get<double>()), 2, 1e-9);
  EXPECT_LT(state["bodies"][1].get<double>(), 0.01);
  EXPECT_NEAR(state["energy"].get<double>(), start, 1e-3);
  EXPECT_LT(state["error"].get<double>(), 1e-9);
  const json marks = ask({{"do", "marks"}, {"joint", 0}});
  ASSERT_FALSE(marks.contains("problems")) << marks;
  EXPECT_EQ(marks["points"][0]["name"], "pa");
  EXPECT_NEAR(marks["points"][0]["at"][0].get<double>(), state["bodies"][0].get<double>(), 1e-12);
}

// The first scene of a spec is read, and its joints hold as it runs: all of the plane and of coordinates, and every
// fourth in space, where derivations take longer.
TEST_F(Play, EverySpecHasAFirstScene) {
  int scenes = 0, in_space = 0;
  std::string still;
  for (const char* space : {"planar", "spatial", "coordinate"})
    for (const auto& entry : fs::directory_iterator(fs::path(CDOT_SOURCE_DIR) / "specs" / space)) {
      const fs::path& spec = entry.path();
      if (spec.extension() != ".joint" && spec.extension() != ".effect") continue;
      if (space == std::string_view("spatial") && ++in_space % 4 != 0) continue;
      const std::string text = cdot::play::trial_scene(spec.string());
      ++scenes;
      const json scene = load(text);
      ASSERT_FALSE(scene.contains("problems")) << spec << "\n" << text << scene["problems"];
      EXPECT_EQ(scene["warnings"], "") << spec << "\n" << text;
      const json state = run(0.5);
      EXPECT_EQ(state["failed"], "") << spec << "\n" << text;
      EXPECT_LT(state["error"].get<double>(), 1e-3) << spec << "\n" << text;
      if (state["bodies"] == scene["state"]["bodies"]) still += " " + spec.stem().string();
    }
  EXPECT_GT(scenes, 70);
  // no freedom, or friction that holds
  for (const char* name : {" motor", " weld", " pin_friction", " rail_friction"})
    if (const std::size_t at = still.find(name); at != still.npos) still.erase(at, std::string_view(name).size());
  EXPECT_EQ(still, "") << "these do not move";
}

TEST_F(Play, AFirstSceneForASpecWithMistakesNamesThem) {
  std::ofstream("bad.joint") << "joint bad planar\n  \"x\"\n  point pa on a\n  dot(pa, q) = 0\n";
  try {
    cdot::play::trial_scene("bad.joint");
    ADD_FAILURE();
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find("bad.joint:4:11: error"), std::string::npos) << error.what();
  }
}

TEST_F(Play, MistakesHavePlaces) {
  ask({{"do", "write"},
       {"files", {{"specs/planar/bad.joint", "joint bad planar\n  point pa on a\n  dot(pa, q) = 0\n"}}}});
  const json checked = ask({{"do", "check"}, {"path", "specs/planar/bad.joint"}});
  ASSERT_EQ(checked["messages"].size(), 1u) << checked;
  EXPECT_EQ(checked["messages"][0]["line"], 3);
  EXPECT_EQ(checked["messages"][0]["column"], 11);
  EXPECT_EQ(checked["messages"][0]["end"], 12);
  const std::string problems = load("[[body]]\nname = \"a\"\nmass = -1\n")["problems"];
  EXPECT_NE(problems.find(":3:8: error"), problems.npos) << problems;
}

TEST_F(Play, NamesOfTheDerivationAreMarked) {
  const json lecture = ask({{"do", "explain"}, {"path", "specs/planar/line.joint"}});
  ASSERT_FALSE(lecture.contains("problems")) << lecture;
  const std::string html = lecture["html"];
  for (const char* name : {"data-name=\"ra\"", "data-name=\"u\"", "data-name=\"t\""})
    EXPECT_NE(html.find(name), html.npos) << name;
  EXPECT_EQ(html.find("<html"), html.npos);
}

// The kernel has the names of the derivation: ra_x of ra, a.x of x_a, va.w of w_a.
TEST_F(Play, NamesOfTheKernelAreMarked) {
  const json kernel = ask({{"do", "kernel"}, {"path", "specs/planar/line.joint"}});
  ASSERT_FALSE(kernel.contains("problems")) << kernel;
  const std::string html = kernel["html"];
  for (const char* name :
       {"<span data-name=\"ra\">ra_x</span>", "<span data-name=\"u\">u_y</span>", "<span data-name=\"x_a\">a.x</span>",
        "<span data-name=\"w_a\">va.w</span>", "<span data-name=\"inv_m_b\">mb.m</span>", "template &lt;class T&gt;"})
    EXPECT_NE(html.find(name), html.npos) << name << "\n" << html.substr(0, 3000);
}

// A bob of 1 kg that hangs at rest: the rod carries 10 N, at the point pa of the bob.
TEST_F(Play, TheForceOfARowHasItsPlace) {
  ask({{"do", "write"}, {"files", {{"specs/planar/ring.joint", own_joint}}}});
  std::string hanging = bead;
  hanging.replace(hanging.find("[2, 0]"), 6, "[0, -2.25]");
  hanging.replace(hanging.find("pa     = [0, 0]"), 15, "pa     = [0, 0.25]");
  load(hanging, {{"rate", 1000}, {"method", "rattle"}});
  run(0.1);
  const json marks = ask({{"do", "marks"}, {"joint", 0}});
  ASSERT_EQ(marks["forces"].size(), 1u) << marks;
  EXPECT_NEAR(marks["forces"][0]["force"][1].get<double>(), 10, 1e-6);
  EXPECT_NEAR(marks["forces"][0]["force"][0].get<double>(), 0, 1e-6);
  EXPECT_NEAR(marks["forces"][0]["from"][1].get<double>(), -2, 1e-6);
}

// Without the term of the turning normal the entry differs, at its place; with it, it agrees.
TEST_F(Play, AHandDerivationIsJudged) {
  const std::string entry = "entry MINE-1 \"mine\"\n  source \"me\"\n  J = ";
  const auto judged = [&](const std::string& J) {
    ask({{"do", "write"}, {"files", {{"specs/planar/line.hand", entry + J}}}});
    return ask({{"do", "judge"}, {"path", "specs/planar/line.hand"}});
  };
  const json wrong = judged("[t', cross(ra, t), -t', -cross(rb, t)]\n");
  EXPECT_EQ(wrong["differ"], 1) << wrong;
  ASSERT_EQ(wrong["messages"].size(), 1u);
  const json& message = wrong["messages"][0];
  EXPECT_EQ(message["severity"], "error");
  EXPECT_EQ(message["line"], 3);
  EXPECT_NE(message["message"].get<std::string>().find("lacks -cross(u, t): t turns with b"), std::string::npos)
      << message;
  const json right = judged("[t', cross(ra, t), -t', -cross(rb + u, t)]\n");
  EXPECT_EQ(right["agree"], 1) << right;
  EXPECT_EQ(right["messages"][0]["severity"], "agrees");
  const json unreadable = judged("[t', cross(ra, q)]\n");
  EXPECT_EQ(unreadable["messages"][0]["severity"], "error") << unreadable;
  EXPECT_EQ(unreadable["messages"][0]["column"], 22) << unreadable;
}

// An entry to begin with can be read: J of zeros.
TEST_F(Play, AFirstEntryCanBeJudged) {
  const json first = ask({{"do", "hand"}, {"path", "specs/planar/revolute.joint"}});
  ASSERT_TRUE(first.contains("text")) << first;
  ask({{"do", "write"}, {"files", {{"specs/planar/revolute.hand", first["text"]}}}});
  const json judged = ask({{"do", "judge"}, {"path", "specs/planar/revolute.hand"}});
  EXPECT_EQ(judged["messages"][0]["message"], "missing term: J: only zeros stand here");
}

// The rod of the bead's ring carries m g + m v^2/r at the bottom, where v^2 = 2 g r: 3 m g. A longer ring moves it.
TEST_F(Play, ForcesAndParameters) {
  ask({{"do", "write"}, {"files", {{"specs/planar/ring.joint", own_joint}}}});
  load(bead, {{"rate", 1000}, {"method", "rattle"}});
  double most = 0;
  for (int k = 0; k < 120; ++k)
    most = std::max(most, ask({{"do", "step"}, {"time", 1.0 / 60}})["forces"][0].get<double>());
  EXPECT_NEAR(most, 30, 0.1);
  ask({{"do", "set"}, {"joint", 0}, {"name", "r"}, {"numbers", {2.5}}});
  const json state = run(0.5);
  EXPECT_NEAR(std::hypot(state["bodies"][0].get<double>(), state["bodies"][1].get<double>()), 2.5, 1e-3);
}

// Euler's fall lags by g h t / 2, and by an eighth of it with steps eight times shorter.
TEST_F(Play, TheErrorIsMeasuredByShorterSteps) {
  load(free_body, {{"method", "euler"}, {"rate", 100}, {"measure", true}});
  const json state = run(2);
  EXPECT_NEAR(std::abs(state["off"].get<double>()), 10 * 0.01 * 2 / 2 * 7 / 8, 1e-9);
  load(free_body, {{"method", "euler"}});
  EXPECT_TRUE(run(0.1)["off"].is_null());
}

TEST_F(Play, NothingIsWrittenElsewhere) {
  for (const char* path : {"../elsewhere", "/tmp/cdot_elsewhere", "specs/../../elsewhere"})
    EXPECT_TRUE(ask({{"do", "write"}, {"files", {{path, "x"}}}}).contains("problems")) << path;
  EXPECT_FALSE(fs::exists("/tmp/cdot_elsewhere"));
  EXPECT_TRUE(ask({{"do", "step"}, {"time", 1}}).contains("problems"));
  EXPECT_TRUE(ask({{"do", "nothing"}}).contains("problems"));
}

}  // namespace
