// cdot-run diagnose and the warnings of cdot-run simulate: unsuitable methods get a warning, suitable ones do not.
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/runtime/tool/support.hpp"

namespace cdot::test::diagnose_test {
namespace {

std::string hard(const std::string& name) {
  return fmt::format("'{}/tests/hard_cases/{}.toml'", CDOT_SOURCE_DIR, name);
}

bool says(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

// Every scene of the catalogue with its own method.
TEST(DiagnoseCommand, HasNothingAgainstTheCatalogue) {
  int scenes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(scenes_dir())) {
    if (entry.path().extension() != ".toml") continue;
    const CommandResult result = cdot_run(fmt::format("diagnose '{}' --until 0.5", entry.path().string()));
    EXPECT_EQ(result.status, 0) << entry.path() << result.out << result.err;
    ++scenes;
  }
  EXPECT_GE(scenes, 19);
}

struct Wrong {
  const char *scene, *method, *words, *fix;
};

// Methods with their expected warning; the proposed fix must get no warning.
constexpr Wrong wrong[] = {
    {"ball_and_chain/planar", "--integrator euler", "the tension of the joints makes \"link",
     "integrator = \"implicit\""},
    {"ball_and_chain/planar", "--solver iterative", "10 iterations leave a large error", "solver = \"direct\""},
    {"fast_spin/planar", "--integrator rattle", "rad per substep: rattle is accurate below about 0.5 rad",
     "integrator = \"dop853\" with local_error = 1e-6"},
    {"incompatible_triangle/planar", "", "\"ab\", \"bc\", \"ca\" contradict each other",
     "correct the anchors or the lengths"},
    {"stiff_and_soft/planar", "--integrator rattle", "a spring makes \"box", "substeps = "},
};

TEST(DiagnoseCommand, NamesAWrongMethodAndABetterOne) {
  for (const Wrong& one : wrong) {
    const CommandResult simulated = cdot_run(fmt::format("simulate {} {} --until 1", hard(one.scene), one.method));
    EXPECT_TRUE(says(simulated.out, "  warning         ")) << one.scene << " " << one.method << "\n" << simulated.out;
    EXPECT_TRUE(says(simulated.out, one.words)) << one.scene << " " << one.method << "\n" << simulated.out;
    EXPECT_TRUE(says(simulated.out, one.fix)) << one.scene << " " << one.method << "\n" << simulated.out;
  }
}

// A wheel on its centre turns by 0.7 rad per step of rattle, exactly: its measured error answers the rule for its
// turns.
TEST(DiagnoseCommand, AMeasuredErrorAnswersARuleForItsMethod) {
  const TemporaryFolder folder;
  const auto file = folder / "wheel.toml";
  std::ofstream(file) << "duration = 2\n[[body]]\nname = \"wheel\"\nmass = 1\ninertia = 0.04\ntorque = 0.5\n"
                         "[[joint]]\ntype = \"revolute\"\nbodies = [\"world\", \"wheel\"]\nat = [0, 0]\n";
  for (const char* command : {"simulate", "diagnose"}) {
    const std::string run = fmt::format("{} '{}'", command, file.string());
    const CommandResult measured = cdot_run(run);
    EXPECT_FALSE(says(measured.out, "rotates by")) << measured.out;
    EXPECT_EQ(measured.status, 0) << measured.out;
    EXPECT_TRUE(says(cdot_run(run + " --integrator rattle --step 0.03125").out, "rad per substep: rattle"));
  }
}

// omega^2 = 1e6 / 1: 1000 rad/s. The run fails after a warning with the cause.
TEST(DiagnoseCommand, SaysThatASpringIsTooStiffForTheStep) {
  const TemporaryFolder folder;
  const auto file = folder / "spring.toml";
  std::ofstream(file) << "duration = 20\nstep = 0.01\n[[body]]\nname = \"ball\"\nmass = 1\nshape = { disc = 1 }\n"
                         "position = [1, 0]\n[[spring]]\nbodies = [\"world\", \"ball\"]\nstiffness = 1e6\nrest = 0.5\n";
  const CommandResult result = cdot_run(fmt::format("simulate '{}' --integrator rattle", file.string()));
  EXPECT_EQ(result.status, 1);
  EXPECT_TRUE(says(result.out,
                   "a spring makes \"ball\" oscillate at 1e+03 rad/s, 10 rad per substep: rattle is unstable above "
                   "2. Likely fix: substeps = 20 or more, or integrator"))
      << result.out;
}

// d / m = 1000 1/s. The advice is followed: RATTLE takes the damper implicitly.
TEST(DiagnoseCommand, SaysThatADamperIsTooStrongForTheStep) {
  const TemporaryFolder folder;
  const auto file = folder / "damper.toml";
  std::ofstream(file) << "duration = 2\nstep = 0.01\n[[body]]\nname = \"ball\"\nmass = 1\nshape = { disc = 1 }\n"
                         "position = [1, 0]\nvelocity = [1, 0]\n"
                         "[[spring]]\nbodies = [\"world\", \"ball\"]\nstiffness = 10\nrest = 0.5\ndamping = 1000\n";
  const std::string command = fmt::format("'{}' --integrator ", file.string());
  const CommandResult result = cdot_run("diagnose " + command + "dop853");
  EXPECT_EQ(result.status, 1);
  for (const char* words : {"fastest decay   1000 1/s of \"ball\" at t = ",
                            "a damper slows \"ball\" at 1e+03 1/s, 10 per substep: dop853 is unstable above 6.2",
                            "integrator = \"rattle\", which takes dampers implicitly"})
    EXPECT_TRUE(says(result.out, words)) << words << "\n" << result.out;
  EXPECT_EQ(cdot_run("simulate " + command + "rattle").status, 0);
}

TEST(DiagnoseCommand, PrintsIslands) {
  const CommandResult result = cdot_run("diagnose " + hard("ball_and_chain/planar") + " --at 0");
  EXPECT_EQ(result.status, 0) << result.err;
  for (const char* words :
       {"method: direct implicit, double, substeps of 0.01667 s", "at t = 0 s\n", "island 0: 41 bodies, from \"link1\"",
        "rank            82 of 82 rows", "condition of K  1.09e+05", "masses          5.982 to 4021 kg",
        "no warnings: the method suits this scene"})
    EXPECT_TRUE(says(result.out, words)) << words << "\n" << result.out;
}

TEST(DiagnoseCommand, NamesTheMethodOfTheWholeRunAtEachTime) {
  const auto method = [](const std::string& options) {
    const CommandResult result = cdot_run("diagnose " + (scenes_dir() / "simple_pendulum.toml").string() + options);
    EXPECT_EQ(result.status, 0) << result.err;
    const std::size_t begin = result.out.find("method: ");
    return result.out.substr(begin, result.out.find('\n', begin) - begin);
  };
  EXPECT_EQ(method(" --at 0"), method(""));
}

TEST(DiagnoseCommand, HasAllNumbersInJson) {
  const CommandResult result = cdot_run("diagnose " + hard("incompatible_triangle/planar") + " --at 0.5 --json");
  EXPECT_EQ(result.status, 1) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  const auto& island = json["islands"].at(0);
  EXPECT_EQ(island["rows"], 6);
  EXPECT_EQ(island["rank"], 5);
  EXPECT_EQ(island["redundant"].at(0)["joints"], (std::vector<std::string>{"ab", "bc", "ca"}));
  EXPECT_TRUE(island["redundant"][0]["conflicting"]);
  EXPECT_NEAR(std::abs(island["redundant"][0]["missed"].get<double>()), 0.02, 1e-6);
  EXPECT_EQ(json["concerns"].at(0)["level"], "warning");
}

TEST(DiagnoseCommand, RefusesATimeAfterTheEnd) {
  const CommandResult result =
      cdot_run(fmt::format("diagnose '{}' --at 1e9", (scenes_dir() / "four_bar.toml").string()));
  EXPECT_EQ(result.status, 2);
  EXPECT_TRUE(says(result.err, "--at 1000000000: the run ends at 10 s")) << result.err;
}

// The crank of this hard case turns from 90 degrees by -30.34 rad and lies flat at every multiple of pi on the way.
TEST(DiagnoseCommand, TellsWhenTheRankIsNearlyLost) {
  const CommandResult text = cdot_run("diagnose " + hard("change_point/planar") + " --integrator dop853");
  EXPECT_TRUE(says(text.out, "rank over the whole run: nearly lost 10 times, first at t = 0.7083 s")) << text.out;
  const CommandResult result = cdot_run("diagnose " + hard("change_point/planar") + " --integrator dop853 --json");
  const auto losses = nlohmann::json::parse(result.out)["rank_losses"];
  ASSERT_EQ(losses.size(), 10u);
  for (const auto& loss : losses) EXPECT_LT(loss["pivot"].get<double>(), 1e-3);
  const CommandResult run = cdot_run("simulate " + hard("change_point/planar") + " --integrator dop853");
  EXPECT_TRUE(says(run.out, "nearly lost 10 times")) << run.out;
  EXPECT_TRUE(says(run.out, "took projected stages")) << run.out;
}

}  // namespace
}  // namespace cdot::test::diagnose_test
