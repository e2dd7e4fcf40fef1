// The balance of runs at the command line, and advice: each is pasted behind the command that gave it, and must cure.
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "runtime/tool/run/output.hpp"
#include "tests/runtime/tool/followed_advice.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::advice_test {
namespace {

// Follows the advice of one run, if it gives one. Returns whether it did.
bool follow(const std::string& file, const std::string& options) {
  const FollowedAdvice followed = follow_advice(file, options);
  EXPECT_EQ(followed.fault, "") << file << " " << options;
  return !followed.options.empty();
}

struct Asked {
  const char *name, *options;
  int least;  // pieces of advice that are followed, at least
};

void PrintTo(const Asked& asked, std::ostream* out) { *out << asked.options; }

class Advice : public testing::TestWithParam<Asked> {};

// Scenes that name the implicit method run alike with the option that names it: once is enough.
bool is_tried_as_it_stands(const std::string& file, const std::string& options) {
  const Scene scene = read_scene(file);
  return options == "--integrator implicit" && scene.names_integrator &&
         scene.settings.integrator == Integrator::implicit;
}

// The step stays coarse where a scene names none, so that there is something to cure.
TEST_P(Advice, CuresWhatItWasGivenForInEveryScene) {
  int runs = 0, followed = 0;
  for (const auto& file : all_scene_files()) {
    if (is_tried_as_it_stands(file.string(), GetParam().options)) continue;
    ++runs;
    followed += follow(file.string(), GetParam().options);
  }
  fmt::print("{} runs, {} pieces of advice followed\n", runs, followed);
  EXPECT_GE(followed, GetParam().least);
}

INSTANTIATE_TEST_SUITE_P(Runs, Advice,
                         testing::Values(Asked{"AsTheyStand", "", 6}, Asked{"Implicit", "--integrator implicit", 6},
                                         Asked{"Iterative", "--solver iterative", 40}),
                         [](const auto& info) { return std::string(info.param.name); });

constexpr const char* two_bodies = R"(
duration = 20
step = "1/60"
gravity = [0, 0]
[[body]]
name = "a"
mass = 1
shape = { disc = 0.1 }
position = [-1, 0]
velocity = [0, -2]
[[body]]
name = "b"
mass = 1
shape = { disc = 0.1 }
position = [1, 0]
velocity = [0, 2]
[[spring]]
bodies = ["a", "b"]
stiffness = 4
rest = 1.5
)";

std::string damped(double stiffness, double damping) {
  return fmt::format(R"(
duration = 2
step = "1/60"
[[body]]
name = "a"
mass = 1
shape = {{ disc = 0.1 }}
position = [0, -1]
[[spring]]
bodies = ["world", "a"]
stiffness = {}
damping = {}
rest = 1
)",
                     stiffness, damping);
}

std::string written(const TemporaryFolder& folder, const std::string& text) {
  const auto file = folder / "scene.toml";
  std::ofstream(file) << text;
  return file.string();
}

// 100 N/m with 200 N s/m on 1 kg at 1/60 s: c h / m = 3.3 is beyond the range of explicit methods (2.8 for RK4).
TEST(Balance, AnEnergyWithoutASourceFailsTheRunAndKeepsItsOutput) {
  const TemporaryFolder folder;
  const std::string file = written(folder, damped(100, 200));
  const auto csv = folder / "rows.csv", state = folder / "end.state";
  const Ran broken = simulated(
      file, fmt::format("--integrator rk4 --until 0.5 -o '{}' --save-state '{}'", csv.string(), state.string()));
  EXPECT_EQ(broken.status, 1);
  EXPECT_NE(std::string(broken.summary["failure"]).find("the method made up"), std::string::npos) << broken.summary;
  EXPECT_TRUE(std::filesystem::exists(csv));
  EXPECT_NEAR(read_state(state.string()).time(), 0.5, 0.02);
  EXPECT_TRUE(follow(file, "--integrator rk4 --until 0.5"));
}

// Level links of 1 m and 1 kg, held at one end.
std::string level_chain(int links) {
  std::string text = "duration = 10\nstep = \"1/60\"\n";
  for (int k = 0; k < links; ++k)
    text += fmt::format(R"(
[[body]]
name = "link{0}"
mass = 1
shape = {{ box = [1, 0.1] }}
position = [{1}, 0]
[[joint]]
type = "revolute"
bodies = ["{2}", "link{0}"]
pa = [{3}, 0]
pb = [-0.5, 0]
)",
                        k, k + 0.5, k == 0 ? "world" : fmt::format("link{}", k - 1), k == 0 ? 0 : 0.5);
  return text;
}

// Ten sweeps in a step of 1/60 s leave the joints open by metres: 40 links gain 1e8 J.
TEST(Balance, LongChainsUnderRattleBySweepsFailAndTheAdviceHolds) {
  const TemporaryFolder folder;
  for (const int links : {10, 20, 40}) {
    const std::string file = written(folder, level_chain(links)), options = "--integrator rattle --solver iterative";
    const Ran broken = simulated(file, options);
    EXPECT_EQ(broken.status, 1) << links;
    EXPECT_NE(broken.summary["failure"], "") << links;
    EXPECT_TRUE(follow(file, options)) << links;
  }
}

// Sweeps let a rod slide that jams (Painlevé's paradox): the run says that it made up energy, and the direct solver
// holds.
TEST(Balance, AJammingRodThatSlidesBySweepsIsTold) {
  const std::string file = (source_dir() / "tests/hard_cases/jamming_rod/planar.toml").string();
  const std::string options = "--integrator rattle --solver iterative --until 0.1";
  const Ran broken = simulated(file, options);
  EXPECT_EQ(broken.status, 1);
  EXPECT_NE(broken.summary["failure"].dump().find("made up"), std::string::npos) << broken.summary["failure"];
  EXPECT_TRUE(follow(file, options));
}

// A rod shrinks to nothing, from a start that does not shrink yet. By steps of 2 ms until 500 s it takes more than a
// trial may. A bob beside it that turns by 0.3 rad in each step could be cured, but no trial would reach the step that
// fails.
TEST(Balance, ATrialThatEndsBeforeTheStepThatFailedIsNoAdvice) {
  const TemporaryFolder folder;
  const auto run = [&](const char* method, double shrinks, const char* more) {
    return cdot_run("simulate '" +
                    written(folder, fmt::format(R"(
duration = {}
gravity = [0, -9.81]
{}
[[body]]
name = "rod"
mass = 1
shape = {{ rod = 1 }}
[[joint]]
type = "distance"
bodies = ["world", "rod"]
pa = [0, 1]
pb = [0, 0]
l = "1 [m] - {} [m/s] * time"
{})",
                                                2 / shrinks, method, shrinks, more)) +
                    "'");
  };
  const CommandResult quick = run("", 2, ""), steps = run("integrator = \"euler\"\nstep = 0.002", 0.002, R"(
[[body]]
name = "bob"
mass = 1
inertia = 0.0001
position = [5.02, 0]
velocity = [0, 3]
spin = 150
[[joint]]
type = "revolute"
bodies = ["world", "bob"]
at = [5, 0]
)");
  EXPECT_EQ(quick.status, 1);
  EXPECT_NE(quick.out.find("at t = 0.5 s failed"), std::string::npos) << quick.out;
  EXPECT_EQ(quick.out.find("Tried: "), std::string::npos) << quick.out;
  EXPECT_EQ(steps.status, 1);
  EXPECT_NE(steps.out.find("at t = 500 s failed"), std::string::npos) << steps.out;
  EXPECT_EQ(steps.out.find("Tried"), std::string::npos) << steps.out;
}

// Two pendulums: one hardly moves, the other turns by half a radian in a step of Euler's method.
TEST(Balance, NamesTheJointOfTheWorstStep) {
  const TemporaryFolder folder;
  std::string text = "duration = 1\nstep = \"1/60\"\n";
  for (const auto& [name, x, speed] : {std::tuple{"calm", 0.0, 0.1}, std::tuple{"wild", 9.0, 30.0}})
    text += fmt::format(R"(
[[body]]
name = "{0}_bob"
mass = 1
shape = {{ disc = 0.1 }}
position = [{1}, -1]
velocity = [{2}, 0]
spin = {2}
[[joint]]
name = "{0}"
type = "revolute"
bodies = ["world", "{0}_bob"]
pa = [{1}, 0]
pb = [0, 1]
)",
                        name, x, speed);
  const Ran ran = simulated(written(folder, text), "--integrator euler --energy-tolerance 0.01");
  EXPECT_EQ(ran.status, 1);
  const std::string failure = ran.summary["failure"];
  EXPECT_NE(failure.find("N of \"wild\""), std::string::npos) << failure;
}

// Coarse steps of Euler let the energy of an orbit swing: the share decides between silence, a warning and a failure.
TEST(Balance, ASharePassesWarnsOrFailsByTheToleranceOfTheScene) {
  const TemporaryFolder folder;
  const std::string file = written(folder, two_bodies);
  const Ran coarse =
      simulated(file, "--integrator euler --step 0.05 --trajectory-tolerance 100 --energy-tolerance 100");
  const double error = coarse.summary["balance"]["method"]["error"];
  const double scale = coarse.summary["balance"]["method"]["scale"];
  const double share = std::abs(error) / scale;
  ASSERT_GT(share, 1e-3);
  const auto with = [&](double tolerance) {
    return simulated(
        file,
        fmt::format("--integrator euler --step 0.05 --trajectory-tolerance 100 --energy-tolerance {}", tolerance));
  };
  EXPECT_TRUE(with(101 * share).silent());
  const Ran warned = with(9 * share);
  // Energy that rises fails the run at a tenth of the tolerance.
  if (error < 0) {
    EXPECT_EQ(warned.status, 0);
    EXPECT_NE(warned.summary["warning"], "");
  } else {
    EXPECT_EQ(warned.status, 1);
  }
  EXPECT_EQ(with(0.5 * share).status, 1);
}

// Scenes that once gained or lost their energy with exit 0 and no word. No source of energy is in them, so the energy
// itself tells, without the balance: it may not rise, and where nothing takes it, it may not fall.
TEST(Balance, KnownScenesAreNotWrongInSilence) {
  struct Known {
    const char *name, *options;
    bool conserves;
  };
  for (const Known& known : {Known{"two_bodies_and_a_rod", "--integrator implicit", true},
                             Known{"two_bodies_and_a_rod", "--integrator rattle", true},
                             Known{"ragdoll_at_20_rad_per_s", "--solver iterative", false},
                             Known{"pivot_off_by_1_mm", "--integrator dop853", true},
                             Known{"damper_beyond_explicit_steps", "--integrator rattle", false}}) {
    const auto file = source_dir() / "tests/runtime/tool/run/silent" / (std::string(known.name) + ".toml");
    const Ran now = simulated(file.string(), known.options);
    const auto& summary = now.summary;
    ASSERT_FALSE(summary.is_null()) << known.name;
    const double start = summary["energy_start"], end = summary["energy_end"], drift = summary["energy_drift"];
    const double scale = summary["balance"]["method"]["scale"];
    const bool wrong = end - start > 0.02 * scale || (known.conserves && drift > 0.02 * scale);
    EXPECT_FALSE(now.silent() && wrong) << known.name << " " << known.options << "\n" << summary.dump(2);
    if (known.name == std::string("two_bodies_and_a_rod") && known.options == std::string("--integrator rattle")) {
      EXPECT_TRUE(now.silent()) << summary.dump(2);
    }
  }
}

TEST(Balance, MomentaOfFreeBodiesAreWatched) {
  const TemporaryFolder folder;
  const Ran held = simulated(written(folder, two_bodies), "--integrator dop853 --local-error 1e-9");
  EXPECT_TRUE(held.silent()) << held.summary;
  EXPECT_LT(double(held.summary["balance"]["momentum"]["error"]), 1e-12);
  EXPECT_LT(double(held.summary["balance"]["angular_momentum"]["error"]), 1e-7);
  EXPECT_GT(double(held.summary["balance"]["angular_momentum"]["scale"]), 3);
}

// A run that fails in its first step has done no work, so no trial has a price in units of it.
TEST(Balance, AdviceForARunWithoutAStepHasNoPrice) {
  const std::string file = (source_dir() / "tests/torture/found/told/rod_on_a_light_body.toml").string();
  const Ran broken = simulated(file, "");
  EXPECT_EQ(broken.summary["steps"], 0);
  EXPECT_EQ(broken.summary["advice"]["cost"], 0) << broken.summary["advice"];
  const std::string failure = broken.summary["failure"];
  EXPECT_NE(failure.find("keeps energy and momentum to"), std::string::npos) << failure;
  EXPECT_EQ(failure.find("the cost"), std::string::npos) << failure;
}

// Painlevé's rod meets a rough line at 1e-8 of its speed: there it jams, or leaves the line untouched. The advice is to
// take steps whose errors are smaller than that.
constexpr const char* doubtful_rod = R"(
duration = 0.05
step = 0.01
gravity = [0, 0]
[[body]]
name = "rod"
mass = 1
inertia = 0.3333333333333333
position = [-0.4472135954999579, 0.8944271909999159]
velocity = [4, -4e-8]
[[joint]]
name = "line"
type = "rough_line"
bodies = ["rod", "world"]
pa = [0.4472135954999579, -0.8944271909999159]
pb = [0, 0]
n = [0, 1]
mu = 2
)";

TEST(Decisions, ThatErrorsTakeAreTold) {
  const TemporaryFolder folder;
  const std::string file = written(folder, doubtful_rod);
  const Ran loose = simulated(file, "--integrator dop853 --local-error 1e-6");
  EXPECT_EQ(loose.status, 0);
  const std::string told = loose.summary["decision_warning"];
  EXPECT_NE(told.find("1 blow is undecided, first by t = 0.01 s at joint \"line\": "), std::string::npos) << told;
  EXPECT_EQ(loose.summary["own_steps"]["undecided"], 1);
  EXPECT_EQ(loose.summary["advice"]["options"], "--local-error 1e-10") << loose.summary.dump(2);
  EXPECT_EQ(simulated(file, "--integrator dop853 --local-error 1e-10").summary["decision_warning"], "");
  const Ran searched = simulated(file, "--accuracy 1e-4");
  EXPECT_NE(searched.summary["decision_warning"], "") << searched.summary.dump(2);
}

}  // namespace
}  // namespace cdot::test::advice_test
