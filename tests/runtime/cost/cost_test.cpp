// A scene pays only for the features that it uses: callgrind counts the instructions of step(), and the counts must be
// equal.
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <string>
#include <vector>

#include "tests/shell.hpp"

namespace cdot::test {
namespace {

struct Counted {
  long instructions = 0;
  std::string output;
};

std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Instructions within measured_steps() of each scene, of one run of a cost_scene program: callgrind tells those of each
// process as it ends, behind what that printed.
std::vector<Counted> count(const std::string& program, const std::vector<std::string>& scenes) {
  std::string command = std::string(CDOT_VALGRIND) +
                        " --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect=measured_steps " + program;
  for (const std::string& scene : scenes) command += " '" + scene + "'";
  const ShellResult outcome = shell(command + " 2>&1");
  EXPECT_EQ(outcome.status, 0) << command << "\n" << outcome.text;
  std::vector<Counted> all(scenes.size());
  std::size_t at = 0;
  for (Counted& run : all) {
    at = outcome.text.find("hash ", at);
    run.output = outcome.text.substr(at, outcome.text.find('\n', at) - at);
    at = outcome.text.find("Collected : ", at);
    run.instructions = std::stol(outcome.text.substr(at + 12));
    EXPECT_GT(run.instructions, 1000) << command << "\n" << outcome.text;
  }
  return all;
}

const std::string without = CDOT_COST_WITHOUT, with = CDOT_COST_WITH;

TEST(Cost, OneProgramHasTheCodeOfTheEffectsAndTheOtherHasNot) {
  const std::string trace = "a limit needs a lower or an upper end";
  EXPECT_EQ(contents(without).find(trace), std::string::npos);
  EXPECT_NE(contents(with).find(trace), std::string::npos);
}

TEST(Cost, EffectsNotAskedForCostNoInstruction) {
  const std::vector<std::string> scenes = {"direct 10", "iterative 10"};
  const std::vector<Counted> plain = count(without, scenes), linked = count(with, scenes);
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    EXPECT_EQ(plain[k].instructions, linked[k].instructions) << scenes[k];
    EXPECT_EQ(plain[k].output, linked[k].output);
    std::printf("%s pendulums: %ld instructions with and without the effects' code\n", scenes[k].c_str(),
                plain[k].instructions);
  }
}

// The cost of an effect in one joint does not depend on the number of other joints.
TEST(Cost, AnEffectAddsToItsOwnJointAlone) {
  const std::vector<std::string> effects = {"none", "limit", "motor", "friction", "spring", "breaking"};
  for (const std::string solver : {"direct", "iterative"}) {
    std::vector<std::string> scenes;
    for (const char* pendulums : {" 2 ", " 12 "})
      for (const std::string& effect : effects) scenes.push_back(solver + pendulums + effect);
    const std::vector<Counted> all = count(with, scenes);
    const std::size_t n = effects.size();
    for (std::size_t k = 1; k < n; ++k) {
      const long added_to_few = all[k].instructions - all[0].instructions;
      const long added_to_many = all[n + k].instructions - all[n].instructions;
      EXPECT_GT(added_to_few, 0) << scenes[k];
      EXPECT_EQ(added_to_few, added_to_many) << scenes[k];
      std::printf("%s %s adds %ld instructions, among 2 or 12 pendulums\n", solver.c_str(), effects[k].c_str(),
                  added_to_few);
    }
  }
}

// A direct solve of a chain has no fill-in at any length. The number of Newton rounds varies a little with the motion.
TEST(Cost, AChainCostsInProportionToItsLength) {
  const std::vector<Counted> all = count(without, {"direct 1 none 40", "direct 1 none 80", "direct 1 none 160"});
  for (int k = 0; k < 3; ++k) std::printf("%d links: %ld instructions in 20 steps\n", 40 << k, all[k].instructions);
  const double first = double(all[1].instructions - all[0].instructions);
  const double second = double(all[2].instructions - all[1].instructions);
  EXPECT_NEAR(second / first, 2, 0.2);
}

TEST(Cost, SleepingIslandsCostNoInstruction) {
  const std::vector<Counted> all =
      count(without, {"direct 1", "direct 200 sleep", "iterative 1", "iterative 200 sleep"});
  for (const std::size_t k : {0, 2}) {
    const Counted &alone = all[k], &crowd = all[k + 1];
    EXPECT_NE(crowd.output.find("asleep 199"), std::string::npos) << crowd.output;
    EXPECT_EQ(alone.instructions, crowd.instructions) << k;
    std::printf("1 pendulum, alone or beside 199 sleeping ones: %ld instructions\n", alone.instructions);
  }
}

}  // namespace
}  // namespace cdot::test
