// A scene pays only for the features that it uses: callgrind counts the instructions of step(), and the counts must be
// equal.
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <string>

#include "tests/shell.hpp"

namespace cdot::test {
namespace {

struct Counted {
  long instructions = 0;
  std::string output;
};

// Instructions within measured_steps() of one run of a cost_scene program.
Counted count(const std::string& program, const std::string& arguments) {
  const std::string command = std::string(CDOT_VALGRIND) +
                              " --tool=callgrind --callgrind-out-file=/dev/null"
                              " --toggle-collect=measured_steps " +
                              program + " " + arguments + " 2>&1";
  Counted run;
  const ShellResult outcome = shell(command);
  run.output = outcome.text;
  EXPECT_EQ(outcome.status, 0) << command << "\n" << run.output;
  const auto at = run.output.find("Collected : ");
  if (at != std::string::npos) run.instructions = std::stol(run.output.substr(at + 12));
  EXPECT_GT(run.instructions, 1000) << command << "\n" << run.output;
  const auto hash = run.output.find("hash ");
  run.output = hash == std::string::npos ? "" : run.output.substr(hash, run.output.find('\n', hash) - hash);
  return run;
}

std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

const std::string without = CDOT_COST_WITHOUT, with = CDOT_COST_WITH;
const std::string both[] = {"direct ", "iterative "};

TEST(Cost, OneProgramHasTheCodeOfTheEffectsAndTheOtherHasNot) {
  const std::string trace = "a limit needs a lower or an upper end";
  EXPECT_EQ(contents(without).find(trace), std::string::npos);
  EXPECT_NE(contents(with).find(trace), std::string::npos);
}

TEST(Cost, EffectsNotAskedForCostNoInstruction) {
  for (const std::string& solver : both) {
    const Counted plain = count(without, solver + "10"), linked = count(with, solver + "10");
    EXPECT_EQ(plain.instructions, linked.instructions) << solver;
    EXPECT_EQ(plain.output, linked.output);
    std::printf("%sten pendulums: %ld instructions with and without the effects' code\n", solver.c_str(),
                plain.instructions);
  }
}

// The cost of an effect in one joint does not depend on the number of other joints.
TEST(Cost, AnEffectAddsToItsOwnJointAlone) {
  for (const std::string& solver : both) {
    const long few = count(with, solver + "2").instructions;
    const long many = count(with, solver + "12").instructions;
    for (const char* effect : {" limit", " motor", " friction", " spring", " breaking"}) {
      const long added_to_few = count(with, solver + "2" + effect).instructions - few;
      const long added_to_many = count(with, solver + "12" + effect).instructions - many;
      EXPECT_GT(added_to_few, 0) << solver << effect;
      EXPECT_EQ(added_to_few, added_to_many) << solver << effect;
      std::printf("%s%s adds %ld instructions, among 2 or 12 pendulums\n", solver.c_str(), effect, added_to_few);
    }
  }
}

// A direct solve of a chain has no fill-in at any length. The number of Newton rounds varies a little with the motion.
TEST(Cost, AChainCostsInProportionToItsLength) {
  long instructions[3];
  for (int k = 0; k < 3; ++k) {
    const int links = 40 << k;
    instructions[k] = count(without, "direct 1 none " + std::to_string(links)).instructions;
    std::printf("%d links: %ld instructions in 20 steps\n", links, instructions[k]);
  }
  const double first = double(instructions[1] - instructions[0]), second = double(instructions[2] - instructions[1]);
  EXPECT_NEAR(second / first, 2, 0.2);
}

TEST(Cost, SleepingIslandsCostNoInstruction) {
  for (const std::string& solver : both) {
    const Counted alone = count(without, solver + "1"), crowd = count(without, solver + "200 sleep");
    EXPECT_NE(crowd.output.find("asleep 199"), std::string::npos) << crowd.output;
    EXPECT_EQ(alone.instructions, crowd.instructions) << solver;
    std::printf("%s1 pendulum, alone or beside 199 sleeping ones: %ld instructions\n", solver.c_str(),
                alone.instructions);
  }
}

}  // namespace
}  // namespace cdot::test
