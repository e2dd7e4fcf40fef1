// `cdot compile --bill`: an effect costs what its bill says, and one that a scene does not call for costs nothing.
#include <array>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <sstream>

#include "bounds_euler.hpp"
#include "bounds_rattle.hpp"
#include "chain_10_euler.hpp"
#include "chain_10_rk4.hpp"
#include "effects_euler.hpp"
#include "effects_rk4.hpp"
#include "events_rattle.hpp"
#include "tests/derive/compile/command.hpp"
#include "thrown_rattle.hpp"
#include "thrown_rk4.hpp"

namespace {

// operations and bytes alone; operations, bytes, bytes of code and instructions that dropping saves.
using Line = std::array<long, 6>;

// Of the part in a bill; -1 for "-".
Line line_of(const std::string& bill, const std::string& part) {
  Line numbers{};
  std::istringstream lines(bill);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(part + " ")) continue;
    std::istringstream words(line.substr(part.size()));
    std::string word;
    for (long& number : numbers) words >> word, number = word == "-" ? -1 : std::stol(word);
    return numbers;
  }
  ADD_FAILURE() << "no line " << part << " in\n" << bill;
  return numbers;
}

std::string text_of(const std::string& file) {
  std::ifstream in(std::string(CDOT_SOURCE_DIR) + "/" + file);
  return {std::istreambuf_iterator<char>(in), {}};
}

// The scene without its text from these words up to `end`, as a file of its own.
std::string without(const std::string& scene, const std::string& words, const std::string& end = "[[") {
  std::string text = text_of(scene);
  const std::size_t begin = text.find(words);
  EXPECT_NE(begin, std::string::npos);
  text.erase(begin, text.find(end, begin + words.size()) - begin);
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / fmt::format("cdot_bill_{}.toml", getpid());
  std::ofstream(file) << text;
  return file.string();
}

// Stones without joints take the same way through the code at every state, so all numbers are exact.
TEST(Bill, AnEffectNotCalledForCostsNoInstructionAndNoByte) {
  const std::string scene = "tests/derive/compile/scenes/thrown.toml";
  const std::string copy = without(scene, "[[joint]]\nname   = \"air\"");
  for (const std::string method : {"euler", "rattle", "rk4"}) {
    const cdot::ShellResult with = cdot::compile("--bill " + scene + " --integrator " + method);
    const cdot::ShellResult never = cdot::compile("--bill " + copy + " --integrator " + method);
    ASSERT_EQ(with.status, 0) << with.text;
    ASSERT_EQ(never.status, 0) << never.text;
    const Line whole = line_of(with.text, "whole step"), saved = line_of(with.text, "effect air");
    const Line rest = line_of(never.text, "whole step");
    for (std::size_t k = 2; k < whole.size(); ++k)
      EXPECT_EQ(whole[k] - saved[k], rest[k]) << method << ", column " << k;
    EXPECT_GT(saved[2], 10) << "operations";
    EXPECT_GT(saved[4], 10) << "bytes of code";
    EXPECT_GT(saved[5], 10) << "instructions";
    EXPECT_EQ(never.text.find("air"), std::string::npos);
  }
  std::filesystem::remove(copy);
}

// Operations and bytes alone: the rest of the scene costs as if the part had never been there.
void saves_what_the_rest_lacks(const std::string& scene, const std::string& copy, const std::string& part) {
  const auto bill = [](const std::string& of) {
    const cdot::ShellResult result = cdot::compile("--bill " + of + " --integrator rattle", "CXX=no_compiler");
    EXPECT_EQ(result.status, 0) << result.text;
    return result.text;
  };
  const std::string with = bill(scene);
  const Line whole = line_of(with, "whole step"), saved = line_of(with, part);
  const Line rest = line_of(bill(copy), "whole step");
  for (const std::size_t k : {2, 3}) EXPECT_EQ(whole[k] - saved[k], rest[k]) << "column " << k;
  std::filesystem::remove(copy);
}

TEST(Bill, OfDampingIsThatOfTheWayAndOfTheTurn) {
  const std::string scene = "tests/derive/compile/scenes/pushed.toml";
  saves_what_the_rest_lacks(scene, without(scene, "linear_damping  = 0.4", "\n[["), "damping of brick");
}

// A rope that breaks keeps its bond where a joint that breaks, or another effect with ends, goes before it.
TEST(Bill, OfWhatGoesLeavesARopeItsBond) {
  const std::string scene = "tests/derive/compile/bonds/bonds.toml";
  saves_what_the_rest_lacks(scene, without(scene, "[[joint]]\nname     = \"root\""), "joint root (revolute)");
  saves_what_the_rest_lacks(scene, without(scene, "angle.limit", "angle.spring"), "effect hinge.angle.limit");
}

TEST(Bill, BytesOfStateAreThoseOfTheStruct) {
  const auto bytes = [](const std::string& scene, const char* method) {
    return line_of(cdot::compile("--bill " + scene + " --integrator " + method, "CXX=no_compiler").text,
                   "whole step")[3];
  };
  using namespace cdot::scenes;
  const std::string effects = "tests/derive/compile/scenes/effects.toml", chain = "specs/scenes/chain_10.toml";
  EXPECT_EQ(bytes(chain, "euler"), long{sizeof(chain_10_euler<double>::State)});
  EXPECT_EQ(bytes(chain, "rk4"), long{sizeof(chain_10_rk4<double>::State)});
  EXPECT_EQ(bytes(effects, "euler"), long{sizeof(effects_euler<double>::State)});
  EXPECT_EQ(bytes(effects, "rk4"), long{sizeof(effects_rk4<double>::State)});
  EXPECT_EQ(bytes("tests/derive/compile/scenes/bounds.toml", "euler"), long{sizeof(bounds_euler<double>::State)});
  EXPECT_EQ(bytes("tests/derive/compile/scenes/bounds.toml", "rattle"), long{sizeof(bounds_rattle<double>::State)});
  EXPECT_EQ(bytes("tests/derive/compile/scenes/events.toml", "rattle"), long{sizeof(events_rattle<double>::State)});
  EXPECT_EQ(bytes("tests/derive/compile/scenes/thrown.toml", "rattle"), long{sizeof(thrown_rattle<double>::State)});
  EXPECT_EQ(bytes("tests/derive/compile/scenes/thrown.toml", "rk4"), long{sizeof(thrown_rk4<double>::State)});
}

TEST(Bill, SaysWhatItCannotMeasure) {
  const cdot::ShellResult bill = cdot::compile("--bill specs/scenes/tailgate.toml", "CXX=no_compiler");
  EXPECT_EQ(bill.status, 0);
  EXPECT_NE(bill.text.find("there is no compiler no_compiler. Fix: install g++, or set CXX"), std::string::npos)
      << bill.text;
  const Line brake = line_of(bill.text, "effect brake");
  EXPECT_GT(brake[0], 0);
  EXPECT_EQ(brake[4], -1);
  EXPECT_EQ(brake[5], -1);
}

TEST(Bill, IsPrintedAsJson) {
  const std::string tailgate = "--bill specs/scenes/tailgate.toml";
  const Line brake = line_of(cdot::compile(tailgate, "CXX=no_compiler").text, "effect brake");
  const cdot::ShellResult json = cdot::compile(tailgate + " --json", "CXX=no_compiler");
  EXPECT_EQ(json.status, 0);
  const std::string expected = fmt::format(
      R"("name": "effect brake", "alone": {{"operations": {}, "bytes": {}}}, "saved": {{"operations": {}, "bytes": {}, )"
      R"("code_bytes": null, "instructions": null}})",
      brake[0], brake[1], brake[2], brake[3]);
  const auto without_spaces = [](std::string text) {
    std::erase_if(text, [](unsigned char c) { return std::isspace(c) != 0; });
    return text;
  };
  EXPECT_NE(without_spaces(json.text).find(without_spaces(expected)), std::string::npos) << json.text;
  const cdot::ShellResult alone = cdot::compile("specs/scenes/tailgate.toml --json");
  EXPECT_EQ(alone.status, 2);
  EXPECT_NE(alone.text.find("Fix: give --bill"), std::string::npos) << alone.text;
}

// A part's angles go with it: the bill of a scene in space compiles every variant.
TEST(Bill, OfAnglesInSpaceNumbersThoseThatAreLeft) {
  const std::string torsion = "--bill tests/derive/compile/scenes/torsion.toml --integrator euler";
  const cdot::ShellResult bill = cdot::compile(torsion, "CXX=no_compiler");
  EXPECT_EQ(bill.status, 0) << bill.text;
  EXPECT_EQ(line_of(bill.text, "effect axle.angle.spring")[3], 2 * long{sizeof(double)});
  EXPECT_EQ(line_of(bill.text, "effect axle.angle.load")[3], 2 * long{sizeof(double)});
}

// So do its bonds: of a spring it holds, its load and its force.
TEST(Bill, OfJointsThatBreakNumbersThoseThatAreLeft) {
  const auto bill = [](const std::string& scene, const char* method) {
    const cdot::ShellResult result =
        cdot::compile("--bill tests/derive/compile/" + scene + ".toml --integrator " + method, "CXX=no_compiler");
    EXPECT_EQ(result.status, 0) << result.text;
    return result.text;
  };
  EXPECT_EQ(line_of(bill("bonds/soft", "euler"), "effect coil")[3], 3 * long{sizeof(double)});
  EXPECT_EQ(line_of(bill("scenes/soft_gear", "euler"), "effect teeth")[3], 4 * long{sizeof(double)});
  bill("bonds/redundant", "implicit");
}

}  // namespace
