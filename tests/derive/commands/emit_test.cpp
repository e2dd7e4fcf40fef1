// `cdot emit` from the command line: files, refusals, help. What the headers do is tested in tests/derive/engines.
#include "tests/derive/commands/command.hpp"

namespace {

class Emit : public Derive {
 protected:
  bool has(const ShellResult& result, const std::string& text) const {
    return result.text.find(text) != std::string::npos;
  }
};

TEST_F(Emit, WritesOneFileOrTwo) {
  const ShellResult printed = cdot("emit line --for plain");
  EXPECT_EQ(printed.status, 0);
  EXPECT_TRUE(has(printed, "struct line {") &&
              has(printed, "class line_joint : public plain::Joint<T, planar::line, "));
  EXPECT_TRUE(has(printed, "// SPDX-License-Identifier: MIT\n"));
  ASSERT_EQ(cdot("emit line --for plain -o own/line.hpp").status, 0);
  const std::string joint = read("own/line.hpp");
  EXPECT_EQ(files("own").size(), 2u);
  EXPECT_NE(joint.find("#include \"cdot_plain.hpp\""), std::string::npos);
  EXPECT_EQ(joint.find("class Rows"), std::string::npos) << "the adapter is in the other file";
  EXPECT_NE(read("own/cdot_plain.hpp").find("class Rows"), std::string::npos);
  ASSERT_EQ(cdot("emit line --for plain --single-header -o one/line.hpp").status, 0);
  EXPECT_EQ(files("one").size(), 1u);
  EXPECT_EQ(read("one/line.hpp"), printed.text);
}

// Two bodies are as many as Box2D's joints take, and each coordinate has a drive of its own.
TEST_F(Emit, EachCoordinateHasItsDrive) {
  take("planar/wheel.joint");
  const ShellResult wheel = cdot("emit wheel --for box2d");
  EXPECT_EQ(wheel.status, 0) << wheel.text;
  EXPECT_TRUE(has(wheel, "auto& slide() { return this->drives[0]; }")) << wheel.text;
  EXPECT_TRUE(has(wheel, "auto& angle() { return this->drives[1]; }")) << wheel.text;
}

TEST_F(Emit, SaysWhyItCannot) {
  take("planar/drag.effect");
  take("planar/gear_revolute_revolute.joint");
  take("planar/revolute.joint");
  constexpr struct {
    const char *arguments, *said;
  } cases[] = {
      {"line --for bullet",
       "cdot emit: line cannot be emitted for bullet: it is planar, and the bodies of the engine are "
       "not. Likely fix: --for plain\n"},
      {"drag --for plain", "drag cannot be emitted for plain: it is an effect, and adapters are for joints."},
      {"gear_revolute_revolute --for box2d", "it joins 4 bodies, and a constraint of the engine at most 2."},
      {"line --for bulet", "--for: bulet not in {plain,bullet,box2d,jolt,simbody"},
      {"lime --for plain", "lime"},
  };
  for (const auto& [arguments, said] : cases) {
    const ShellResult result = cdot(std::string("emit ") + arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_TRUE(has(result, said)) << arguments << ": " << result.text;
  }
}

TEST_F(Emit, TakesOnlyWhatIsProved) {
  write("wrong.joint", "joint wrong planar\n  \"x\"\n  angle(a) + angle(b) = 0\n");
  const ShellResult result = cdot("emit wrong.joint --for plain -o wrong.hpp");
  EXPECT_EQ(result.status, 2);
  EXPECT_TRUE(has(result, "wrong.joint:3:3: error: momentum")) << result.text;
  EXPECT_FALSE(fs::exists(place_ / "wrong.hpp"));
}

}  // namespace
