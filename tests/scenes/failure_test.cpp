// cdot-run simulate when a step fails: where, what, the likely fix, exit status 1; what was written ends before it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "runtime/run_state.hpp"
#include "tests/scenes/support.hpp"

namespace cdot::test {
namespace {

// A rope of stiffness without bound goes taut in the fall.
constexpr const char* fall = R"(
duration = 1
step = 0.01
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

TEST(FailedStep, IsToldWithPlaceReasonAndFix) {
  Failing scene;
  const auto csv = scene.folder / "rows.csv", state = scene.folder / "before.state";
  const CommandResult result =
      cdot_run(scene.run("", fmt::format("-o '{}' --save-state '{}'", csv.string(), state.string())));
  EXPECT_EQ(result.status, 1) << result.err;
  EXPECT_NE(result.out.find("FAILED          the step of 0.01 s at t = "), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("failed in island 0: a pose or velocity came out not finite; body \"stone\" moved fastest. "
                            "Likely fix: a shorter step"),
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

// A ball of 4 t on a light chain, by steps far too long for its tension: the run ends at 1.8 s, or goes on in parts.
TEST(FailedStep, IsTakenAgainInPartsWhereTheSceneAllows) {
  const TemporaryFolder folder;
  std::ifstream original(source_dir() / "tests/hard_cases/ball_and_chain/planar.toml");
  const std::string text(std::istreambuf_iterator<char>(original), {});
  const auto run = [&](const std::string& keys) {
    const auto file = folder / "chain.toml";
    std::ofstream(file) << keys << text;
    return cdot_run(fmt::format("simulate '{}' --integrator euler --until 1.9 --tolerance 1 --json", file.string()));
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

}  // namespace
}  // namespace cdot::test
