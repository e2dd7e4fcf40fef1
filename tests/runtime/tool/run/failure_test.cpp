// cdot-run simulate after a failed step: place, cause, likely fix, exit status 1; the written rows end before the step.
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "runtime/tool/run/output.hpp"
#include "runtime/tool/search/advice.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::failure_test {
namespace {

// A rope of almost infinite stiffness becomes taut in the fall.
constexpr const char* fall = R"(
duration = 1
step = 0.01
integrator = "rattle"  # its springs are explicit
{}
[[body]]
name = "stone"
mass = 1
inertia = 1
position = [0, -1]
[[body]]
name = "rod"
mass = 1
shape = {{ rod = 1 }}
position = [5.5, 0]
[[joint]]
name = "pivot"
type = "revolute"
bodies = ["world", "rod"]
at = [5, 0]
[[spring]]
bodies = ["world", "stone"]
stiffness = 1e308
rest = 1
)";

struct Failing {
  TemporaryFolder folder;
  std::string run(const std::string& keys, const std::string& more = "") {
    const auto file = folder / "fall.toml";
    std::ofstream(file) << fmt::format(fmt::runtime(fall), keys);
    return fmt::format("simulate '{}' {}", file.string(), more);
  }
};

TEST(FailedStep, IsReportedWithPlaceReasonAndFix) {
  Failing scene;
  const auto csv = scene.folder / "rows.csv", state = scene.folder / "before.state";
  const CommandResult result =
      cdot_run(scene.run("", fmt::format("-o '{}' --save-state '{}'", csv.string(), state.string())));
  EXPECT_EQ(result.status, 1) << result.err;
  EXPECT_NE(result.out.find("FAILED          the step of 0.01 s at t = "), std::string::npos) << result.out;
  EXPECT_NE(
      result.out.find("failed in island 0: a pose or velocity became infinite or NaN; look at a spring, row 1; body "
                      "\"stone\" moved fastest. "
                      "Tried: `--integrator implicit`"),
      std::string::npos)
      << result.out;
  std::ifstream rows(csv);
  std::string line, last;
  while (std::getline(rows, line)) last = line;
  EXPECT_NEAR(read_state(state.string()).time(), std::stod(last), 1e-9);
  EXPECT_EQ(last.find("nan"), std::string::npos);
  EXPECT_EQ(last.find("inf"), std::string::npos);
  const auto json = nlohmann::json::parse(cdot_run(scene.run("", "--json")).out);
  EXPECT_FALSE(json["ok"]);
  EXPECT_EQ(json["failed_step"]["body"], "stone");
  EXPECT_EQ(json["failed_step"]["problem"], "not_finite");
}

// A hard case with additional keys at the top.
CommandResult run_hard_case(const char* scene, const std::string& keys, const char* options) {
  const TemporaryFolder folder;
  std::ifstream original(source_dir() / "tests/hard_cases" / scene);
  const auto file = folder / "scene.toml";
  std::ofstream(file) << keys << original.rdbuf();
  return cdot_run(fmt::format("simulate '{}' {}", file.string(), options));
}

// A ball of 4 t on a light chain with steps far too long for its tension: the run ends at 1.8 s, or continues in parts.
TEST(FailedStep, IsRepeatedInPartsIfTheSceneAllows) {
  const auto run = [](const std::string& keys) {
    return run_hard_case("ball_and_chain/planar.toml", keys, "--integrator euler --until 1.9 --tolerance 1 --json");
  };
  const CommandResult stopped = run(""), retried = run("on_failure = \"retry\"\n");
  EXPECT_EQ(stopped.status, 1) << stopped.out << stopped.err;
  const auto failed = nlohmann::json::parse(stopped.out)["failed_step"];
  EXPECT_EQ(failed["problem"], "joints_apart");
  EXPECT_EQ(retried.status, 0) << retried.out << retried.err;
  const auto json = nlohmann::json::parse(retried.out);
  EXPECT_GE(json["retried"]["steps"], 1);
  EXPECT_GE(json["time"], 1.9 - 1e-9);
  EXPECT_LT(json["worst_error"], 0.02);
  EXPECT_FALSE(json.contains("failed_step"));
}

// Links that start a metre apart: ten sweeps fail for every number of parts, but the direct solver closes the gaps. The
// run then continues with sweeps.
TEST(FailedStep, IsTakenByTheDirectSolverWhereSweepsFail) {
  const auto run = [](const std::string& keys, const char* options) {
    return run_hard_case("stretched_chain/planar.toml", "solver = \"iterative\"\ndrift = \"projection\"\n" + keys,
                         options);
  };
  const char* until = "--integrator euler --until 1 --tolerance 4 --energy-tolerance 10 --trajectory-tolerance 1000";
  const CommandResult stopped = run("", until), retried = run("on_failure = \"retry\"\n", until);
  EXPECT_EQ(stopped.status, 1) << stopped.out << stopped.err;
  EXPECT_NE(stopped.out.find("Tried: `--on-failure retry`"), std::string::npos) << stopped.out;
  EXPECT_EQ(retried.status, 0) << retried.out << retried.err;
  EXPECT_NE(retried.out.find("1 failed step succeeded in shorter parts, 1 of them with the direct solver"),
            std::string::npos)
      << retried.out;
}

// After that step the World solves by its own solver, like a World that never needed the other one.
TEST(FailedStep, IsTheOnlyStepOfTheDirectSolver) {
  Scene scene = read_scene((source_dir() / "tests/hard_cases/stretched_chain/planar.toml").string());
  scene.settings.solver = Solver::iterative;
  scene.settings.integrator = Integrator::euler;
  scene.on_failure = OnFailure::retry;
  World<double> world = build_world_in<Planar<double>>(scene), other = build_world_in<Planar<double>>(scene);
  for (int k = 0; k < 1000 && world.step_counts().direct == 0; ++k) world.step(scene.step);
  ASSERT_EQ(world.step_counts().direct, 1);
  other.restore(world.snapshot());
  for (int k = 0; k < 10; ++k) world.step(scene.step), other.step(scene.step);
  EXPECT_EQ(world.snapshot().differences(other.snapshot()), std::vector<std::string>{});
}

// A motor of unlimited force that turns back against a one-way clutch: every method tells, and at once the cause. With
// a largest torque the clutch holds, and all agree.
TEST(FailedRun, IsOneWhoseMotorsContradictEachOther) {
  const TemporaryFolder folder;
  const auto ran = [&](const std::string& most, const std::string& options) {
    const auto file = folder / "clutch.toml";
    std::ofstream(file)
        << "duration = 1\n[[body]]\nname = \"rod\"\nmass = 0.5\nshape = { rod = 1 }\nposition = [0.5, 0]\n"
           "[[joint]]\nname = \"pivot\"\ntype = \"revolute\"\nbodies = [\"world\", \"rod\"]\n"
           "at = [0, 0]\nangle.freewheel = {}\n"
           "angle.motor = { speed = \"2 [rad/s] * cos(3 [rad/s] * time)\""
        << most << " }\n";
    return cdot_run(fmt::format("simulate '{}' --json {}", file.string(), options));
  };
  for (const char* options :
       {"", "--integrator implicit --step 0.002", "--integrator rattle --step 0.002", "--integrator euler --step 0.002",
        "--integrator rk4 --step 0.002", "--integrator dop853 --local-error 1e-8",
        "--integrator radau5 --local-error 1e-8", "--integrator euler --solver iterative --step 0.002"}) {
    const CommandResult contradicted = ran("", options), limited = ran(", max = 20", options);
    const std::string told = nlohmann::json::parse(contradicted.out)["contradiction"];
    EXPECT_EQ(contradicted.status, 1) << options;
    EXPECT_NE(told.find("two motors of joint \"pivot\" contradict each other by t = 0.5"), std::string::npos) << told;
    EXPECT_FALSE(nlohmann::json::parse(contradicted.out).contains("advice")) << options;
    EXPECT_FALSE(nlohmann::json::parse(limited.out).contains("contradiction")) << options;
  }
}

// The largest change of the energy is positive where the energy falls.
TEST(Report, ALossOfEnergyIsAChange) {
  Scene scene = read_scene(std::string_view("duration = 1\nstep = 0.01\ngravity = [0, 0]\n[[body]]\nname = \"b\"\n"
                                            "mass = 2\ninertia = 1\nvelocity = [1, 0]\nlinear_damping = 1\n"),
                           "test.toml");
  std::string warnings;
  EXPECT_NEAR(simulate(scene, {}, warnings).energy_drift, 1 - std::exp(-2.0), 0.01);
}

// The fix does not name a method that was already tried.
TEST(FailedStep, AdvisesOnlyUntriedMethods) {
  Failing scene;
  const CommandResult stopped = cdot_run(scene.run("", "")),
                      retried = cdot_run(scene.run("on_failure = \"retry\"\n", ""));
  EXPECT_NE(stopped.out.find("Tried: `--integrator implicit`"), std::string::npos) << stopped.out;
  EXPECT_NE(retried.out.find("FAILED"), std::string::npos) << retried.out;
  EXPECT_EQ(retried.out.find("on-failure"), std::string::npos) << retried.out;
}

// A number of the cord is below 0 for some microseconds around 0.0305 s, which no look before the run sees. The whole
// step goes well, a part of it does not. Nothing knows the frame there, so nothing else is shown in its place.
TEST(FailedStep, MayBeThePartBeforeAFrame) {
  const std::string text =
      "duration = 0.3\nstep = 0.1\ngravity = [0, 0]\n[[body]]\nname = \"mass\"\nmass = 1\ninertia = 1\n"
      "position = [1, 0]\n[[joint]]\nname = \"cord\"\ntype = \"bungee\"\nbodies = [\"world\", \"mass\"]\n"
      "pa = [0, 0]\npb = [0, 0]\nk = \"100 [N/m] - 150 [N/m]*exp(-(1e5 [1/s]*time-3050.37)^2)\"\n";
  for (const IntegratorRow& row : integrator_rows)
    for (const bool adaptive : {false, true}) {
      if (adaptive && row.level != Level::acceleration) continue;
      Scene scene = read_scene(std::string_view(text), "test.toml");
      scene.settings.integrator = row.integrator, scene.settings.local_error = adaptive ? 1e-7 : 0;
      std::vector<double> times;
      RunOptions options;
      options.row = [&](const Frame& frame) { times.push_back(frame.time); };
      std::string warnings;
      options.row_times = {0.02, 0.05, 0.2};
      EXPECT_FALSE(simulate(scene, options, warnings).failed_step) << row.name;
      options.row_times = {0.02, 0.0305037, 0.05, 0.2}, options.save_at = scene.duration, times.clear();
      const RunResult result = simulate(scene, options, warnings);
      ASSERT_TRUE(result.failed_step) << row.name;
      EXPECT_NEAR(result.failed_step->time + result.failed_step->length, 0.0305037, 1e-12) << row.name;
      EXPECT_EQ(times, std::vector<double>{0.02}) << row.name;
      EXPECT_FALSE(result.state.empty()) << row.name;
      EXPECT_EQ(find_advice(scene, options, result).value_or(TriedFix{}).options, "") << row.name;
    }
}

}  // namespace
}  // namespace cdot::test::failure_test
