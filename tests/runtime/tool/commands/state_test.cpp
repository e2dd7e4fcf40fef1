// cdot-run simulate --save-state and --from-state: a run in two parts writes the rows of a run in one part.

#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>

#include "tests/runtime/tool/support.hpp"

namespace cdot::test::state_test {
namespace {

std::string quoted(const std::filesystem::path& path) { return fmt::format("'{}'", path.string()); }
std::string scene(const std::string& name) { return quoted(scenes_dir() / (name + ".toml")); }

// The rows of a file from this time on.
std::string rows_from(const std::filesystem::path& csv, double time) {
  std::ifstream file(csv);
  std::string rows, line;
  std::getline(file, line);
  while (std::getline(file, line))
    if (std::stod(line) >= time - 1e-9) rows += line + "\n";
  return rows;
}

TEST(State, ARunInTwoPartsWritesTheSameRows) {
  const TemporaryFolder folder;
  int runs = 0;
  for (const char* name : {"four_bar", "machine", "spatial/gyroscope", "pulley_ratio2"}) {
    for (const char* method :
         {"", " --solver iterative", " --integrator rk4", " --integrator dop853 --local-error 1e-7",
          " --integrator dop853 --local-error 1e-7 --every 0.05", " --integrator radau5",
          " --integrator radau5 --local-error 1e-6 --every 0.05"}) {
      const auto whole = folder / "whole.csv", rest = folder / "rest.csv", state = folder / "at.state";
      const std::string run = "simulate " + scene(name) + method + " --until 0.6 --tolerance 1";
      const CommandResult first = cdot_run(run + " -o " + quoted(whole) + " --at 0.25 --save-state " + quoted(state));
      if (first.status == 2) continue;  // the scene's other settings exclude this method
      ASSERT_EQ(first.status, 0) << run << first.err;
      const CommandResult second = cdot_run(run + " -o " + quoted(rest) + " --from-state " + quoted(state));
      ASSERT_EQ(second.status, 0) << run << second.err;
      const double time = read_state(state.string()).time();
      EXPECT_GE(time, 0.25 - 1e-9);
      EXPECT_NE(second.out.find(fmt::format("from the state at {:.6g} s", time)), std::string::npos) << second.out;
      const std::string rows = rows_from(rest, 0);
      EXPECT_EQ(rows, rows_from(whole, time)) << run;
      EXPECT_GT(std::count(rows.begin(), rows.end(), '\n'), 3) << run;
      ++runs;
    }
  }
  EXPECT_GE(runs, 12);
  std::printf("%d runs in two parts: the rows of one in a single part\n", runs);
}

TEST(State, TheEndIsSavedUnlessATimeIsGiven) {
  const TemporaryFolder folder;
  const auto state = folder / "end.state";
  ASSERT_EQ(cdot_run("simulate " + scene("four_bar") + " --until 0.5 --save-state " + quoted(state)).status, 0);
  EXPECT_NEAR(read_state(state.string()).time(), 0.5, 1e-9);
  const CommandResult over = cdot_run("simulate " + scene("four_bar") + " --until 0.5 --from-state " + quoted(state));
  EXPECT_EQ(over.status, 2);
  EXPECT_NE(over.err.find("the state is from 0.5 s, but the run ends at 0.5 s"), std::string::npos) << over.err;
  const CommandResult late =
      cdot_run("simulate " + scene("four_bar") + " --until 0.5 --at 2 --save-state " + quoted(folder / "no.state"));
  EXPECT_EQ(late.status, 2);
  EXPECT_NE(late.err.find("--at 2: the run ends at 0.5 s"), std::string::npos) << late.err;
  EXPECT_EQ(folder.contents().size(), 1u);
}

TEST(State, OneThatDoesNotFitIsRefusedAndNothingIsWritten) {
  const TemporaryFolder folder;
  const auto state = folder / "a.state", csv = folder / "a.csv";
  ASSERT_EQ(cdot_run("simulate " + scene("four_bar") + " --until 0.1 --step 0.001 --integrator euler --save-state " +
                     quoted(state))
                .status,
            0);
  const auto refused = [&](const std::string& arguments, const std::string& why) {
    const CommandResult result =
        cdot_run("simulate " + arguments + " -o " + quoted(csv) + " --from-state " + quoted(state));
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_NE(result.err.find(why), std::string::npos) << result.err;
    EXPECT_EQ(folder.contents().size(), 1u) << arguments;
  };
  refused(scene("machine") + " --step 0.001 --integrator euler",
          "machine.toml: this is a state of another mechanism: 4 bodies and 4 joints");
  refused(scene("four_bar") + " --integrator rattle", "this is a state of planar double, direct, euler");
  const std::string text = read_text(state);
  std::ofstream(state) << text.substr(0, text.size() - 40);
  refused(scene("four_bar"), "a.state: line ");
  std::filesystem::remove(state);
  const CommandResult none = cdot_run("simulate " + scene("four_bar") + " --from-state " + quoted(state));
  EXPECT_EQ(none.status, 2);
  EXPECT_NE(none.err.find("a.state: cannot be read"), std::string::npos) << none.err;
}

}  // namespace
}  // namespace cdot::test::state_test
