// cdot-run refuses what it cannot do in words, before it runs; numbers and names as people write them it takes.
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>

#include "tests/runtime/tool/support.hpp"

namespace cdot::test::refusals_test {
namespace {

CommandResult simulated(const std::string& arguments) { return cdot_run("simulate " + arguments); }

std::string pendulum() { return fmt::format("'{}'", (scenes_dir() / "simple_pendulum.toml").string()); }

void expect_refused(const std::string& arguments, const std::string& words) {
  const CommandResult result = simulated(arguments);
  EXPECT_EQ(result.status, 2) << arguments;
  EXPECT_NE(result.err.find(words), std::string::npos) << arguments << ": " << result.err;
}

TEST(Refusals, TwoOutputsShareNoFile) {
  const TemporaryFolder folder;
  const std::string name = (folder / "run").string(), same = (folder / "." / "run").string();
  expect_refused(fmt::format("{} --until 0.1 -o '{}' --html '{}'", pendulum(), name, same),
                 "two outputs cannot share one file. Likely fix: another name for one of them");
  EXPECT_FALSE(std::filesystem::exists(name));
  EXPECT_EQ(simulated(pendulum() + " --until 0.1 -o /dev/null --html /dev/null").status, 0);
}

TEST(Refusals, MoreTimesThanMemoryHolds) {
  const std::string words = "1e+12 times 1e-12 s apart up to 1 s are more than 1e+08. Likely fix: 1e-08 s";
  expect_refused(pendulum() + " --until 1 --every 1e-12", words);
  expect_refused(pendulum() + " --until 1 --integrator rk4 --local-error 1e-6 --step 1e-12", words);
}

TEST(Refusals, AStepLongerThanTheRun) {
  expect_refused(pendulum() + " --until 0.1 --step 1",
                 "--step 1: the run ends at 0.1 s. Likely fix: a step of at most 0.1 s");
}

TEST(Refusals, AFolderIsNoScene) {
  expect_refused(fmt::format("'{}'", scenes_dir().string()), "error: this is a folder, not a scene");
}

TEST(Refusals, WholeNumbers) {
  for (const char* text : {"3.5", "1000000000000"})
    expect_refused(fmt::format("{} --substeps {}", pendulum(), text),
                   fmt::format("--substeps: `{}` is not a whole number up to 2147483647", text));
}

TEST(Refusals, FractionsAreNumbers) {
  const CommandResult fraction = simulated(pendulum() + " --until 1/2 --step 1/64 --times 1/8,1/4 -o -");
  EXPECT_EQ(fraction.status, 0) << fraction.err;
  EXPECT_EQ(fraction.out, simulated(pendulum() + " --until 0.5 --step 0.015625 --times 0.125,0.25 -o -").out);
  for (const char* text : {"1/0", "1/", "/2", "1/2/3", "-1/2"})
    expect_refused(fmt::format("{} --step {}", pendulum(), text), fmt::format("`{}` is not a positive number", text));
}

// A scene in each folder goes by its name alone, and a report names each once.
TEST(Refusals, NamesOfScenes) {
  for (const char* name : {"chain_10", "gyroscope", "strandbeest"})
    EXPECT_EQ(cdot_run(fmt::format("diagnose {} --matrix", name)).status, 0) << name;
  expect_refused("no_such_name", "chain_10, coin, ");
}

TEST(Refusals, AFirstStepThatFailsMovesBodies) {
  const TemporaryFolder folder;
  const std::string scene = (folder / "endless.toml").string();
  std::ofstream(scene) << "duration = 1e300\n[[body]]\nname = \"rod\"\nmass = 1\nshape = { rod = 1 }\n"
                          "position = [0.5, 0]\n[[joint]]\ntype = \"revolute\"\nbodies = [\"world\", \"rod\"]\n"
                          "at = [0, 0]\n";
  const CommandResult result = simulated(scene);
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.out.find("own steps       none: the first one failed\n"), std::string::npos) << result.out;
}

}  // namespace
}  // namespace cdot::test::refusals_test
