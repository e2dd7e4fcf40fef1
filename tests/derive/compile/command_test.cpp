// `cdot compile` as a command: its bytes, its refusals, and that its header needs nothing but a compiler.
#include "tests/derive/compile/command.hpp"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

namespace {

using cdot::compile, cdot::ShellResult, cdot::run;

const std::string source = CDOT_SOURCE_DIR;

TEST(CompileCommand, WritesTheSameBytesOnEveryRun) {
  const ShellResult first = compile("specs/scenes/slider_crank.toml --integrator rk4");
  EXPECT_EQ(first.status, 0);
  EXPECT_NE(first.text.find("cdot compile slider_crank.toml --integrator rk4\n"), std::string::npos);
  EXPECT_NE(first.text.find("const T O_rb_x_1 = q[crank].c * T(O_pb_x);"), std::string::npos);
  EXPECT_EQ(first.text.find(source), std::string::npos) << "a path in the header";
  EXPECT_EQ(compile("specs/scenes/slider_crank.toml --integrator rk4").text, first.text);
}

// Axes that a scene gives to 16 digits leave 1e-16 in the directions of bodies: no header computes with it. Points at
// both ends of equal rods are one number.
TEST(CompileCommand, LeavesOutRoundOffOfPlaces) {
  const ShellResult bars = compile("specs/scenes/spatial/four_bar.toml --integrator rk4");
  EXPECT_EQ(bars.status, 0);
  for (const std::string constant : {"e-16;", "e-17;", "e-18;"})
    for (std::size_t at = 0; (at = bars.text.find("static constexpr double A0_", at)) != std::string::npos; ++at)
      EXPECT_EQ(bars.text.substr(at, bars.text.find('\n', at) - at).find(constant), std::string::npos)
          << bars.text.substr(at, 70);
  const ShellResult chain = compile("specs/scenes/chain_10.toml --integrator rk4");
  EXPECT_NE(chain.text.find("T(joint1_pb_x)"), std::string::npos);
  EXPECT_EQ(chain.text.find("joint2_pa"), std::string::npos);
  EXPECT_EQ(chain.text.find("T joint3_ra_x;"), std::string::npos) << "the negative of joint2_rb_x";
}

TEST(CompileCommand, RefusesPartsThatItDoesNotKnowWithTheirLines) {
  const ShellResult rope = compile("tests/derive/compile/scenes/refused.toml --integrator implicit");
  EXPECT_EQ(rope.status, 2);
  EXPECT_NE(
      rope.text.find(
          "refused.toml:11:1: error: line: cdot compile knows no soft ropes by implicit, and damped ones by rattle"),
      std::string::npos)
      << rope.text;
  const ShellResult misfit = compile("tests/hard_cases/incompatible_triangle/planar.toml --integrator euler");
  EXPECT_EQ(misfit.status, 2);
  EXPECT_NE(misfit.text.find(
                "planar.toml:27:1: error: ab: cdot compile knows no joints that contradict each other at the start"),
            std::string::npos)
      << misfit.text;
  const ShellResult large = compile("specs/scenes/catenary_100.toml --integrator radau5");
  EXPECT_EQ(large.status, 2);
  EXPECT_NE(large.text.find("solves for all velocities at once: for 300 components, at most 128"), std::string::npos)
      << large.text;
}

TEST(CompileCommand, LeavesSleepOutWithANote) {
  const ShellResult awakened = compile("tests/hard_cases/awakened/planar.toml --integrator euler");
  EXPECT_EQ(awakened.status, 0);
  EXPECT_TRUE(awakened.text.starts_with("note: Compiled bodies do not sleep: sleep_after is left out.\n"));
  EXPECT_NE(awakened.text.find("// Compiled bodies do not sleep: sleep_after is left out.\n#pragma once"),
            std::string::npos);
}

TEST(CompileCommand, ReportsWrongUsage) {
  EXPECT_EQ(compile("").status, 2);
  EXPECT_EQ(compile("nowhere.toml").status, 2);
  EXPECT_EQ(compile("specs/scenes/chain_10.toml --integrator heun").status, 2);
  const ShellResult help = compile("--help");
  EXPECT_EQ(help.status, 0);
  EXPECT_NE(help.text.find("--integrator"), std::string::npos);
}

// Without the C++ library, exceptions and type information: <cmath> alone is allowed, so it comes from a stub.
TEST(CompileCommand, HeaderBuildsFreestanding) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / fmt::format("cdot_{}", getpid());
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "cmath") << "namespace std { double sqrt(double); float sqrt(float); }\n";
  std::ofstream(folder / "step.cpp") << "#include \"chain_10_rk4.hpp\"\n"
                                        "using Chain = cdot::scenes::chain_10_rk4<float>;\n"
                                        "Chain::State state;\n"
                                        "void start() { Chain::reset(state); }\n"
                                        "float step() { return Chain::step(state); }\n";
  const std::string compiler = fmt::format(
      "{} -std=c++20 -O1 -Wall -Wextra -Werror -ffreestanding -fno-exceptions -fno-rtti -nostdinc -nostdinc++ "
      "-I{} -I{} -c {}/step.cpp -o {}/step.o",
      CDOT_CXX, folder.string(), CDOT_COMPILED, folder.string(), folder.string());
  const ShellResult built = run(compiler);
  EXPECT_EQ(built.status, 0) << built.text;
  const ShellResult needs = run(fmt::format("nm -u {}/step.o", folder.string()));
  EXPECT_EQ(needs.text.find("Znw"), std::string::npos) << needs.text;
  EXPECT_EQ(needs.text.find("malloc"), std::string::npos) << needs.text;
  std::filesystem::remove_all(folder);
}

// A scene compiles, or is refused at a line: no other end.
TEST(CompileCommand, EveryHardCaseCompilesOrIsRefused) {
  int compiled = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(CDOT_SOURCE_DIR "/tests/hard_cases")) {
    if (entry.path().extension() != ".toml") continue;
    for (const char* method : {"euler", "implicit", "rattle"}) {
      const ShellResult outcome =
          compile(fmt::format("'{}' --step 0.001 --integrator {}", entry.path().string(), method));
      EXPECT_TRUE(outcome.status == 0 || (outcome.status == 2 && outcome.text.find("error: ") != std::string::npos))
          << entry.path() << " " << method << ": status " << outcome.status << "\n"
          << outcome.text.substr(0, 2000);
      compiled += outcome.status == 0;
    }
  }
  EXPECT_GT(compiled, 200);
}

}  // namespace
