// What `cdot derive` remembers of earlier runs: the same bytes as from a fresh proof, and nothing once anything that
// it depends on has changed.
#include "derive/pipeline/cache.hpp"
#include "tests/derive/commands/command.hpp"

namespace {

using cdot::derive::Memory;

class Remembered : public Derive {
 protected:
  void SetUp() override {
    Derive::SetUp();
    fs::remove(place_ / "specs/planar/line.joint");  // others take less time
    for (const char* spec : {"angle.hand", "gear.joint", "target.joint"}) take(std::string("planar/") + spec);
    write("specs/planar/pair.joint", "joint pair planar\n  \"Two angles.\"\n  include angle\n  angle(b) = angle(c)\n");
    first_ = cdot("derive");
    ASSERT_EQ(first_.status, 0) << first_.said;
    right_ = files("generated");
  }

  // Of the four specs, how many a run says it remembers; its files are right in any case.
  int remembered(const std::string& command = CDOT " derive") {
    fs::remove_all(place_ / "generated");
    const Result result = run(command);
    EXPECT_EQ(result.status, 0) << result.said;
    said_ = result.said;
    if (said_.find(" of 4 specs are as they were") == std::string::npos) return 0;
    return said_[said_.find(" of 4 specs") - 1] - '0';
  }

  Result first_;
  std::string said_;
  std::map<std::string, std::string> right_;
};

TEST_F(Remembered, GivesTheSameBytes) {
  EXPECT_EQ(first_.said.find("specs are as they were"), std::string::npos);
  EXPECT_EQ(remembered(), 4);
  EXPECT_EQ(files("generated"), right_);
  EXPECT_EQ(remembered(CDOT " derive --fresh"), 0);
  EXPECT_EQ(files("generated"), right_);
}

TEST_F(Remembered, WhatIsSaidBesideTheProofIsSaidAgain) {
  take("spatial/p1.joint");
  const std::string derive = "(" CDOT " derive p1 -o one 2>/dev/null)", fresh = run(derive).said;
  EXPECT_NE(fresh.find("p1: shown at 8 random points"), std::string::npos) << fresh;
  fs::remove_all(place_ / "one");
  EXPECT_EQ(run(derive).said, fresh);
  EXPECT_NE(cdot("derive p1 -o one").said.find("1 of 1 specs"), std::string::npos);
}

TEST_F(Remembered, NotWhereASpecChanged) {
  write("specs/planar/gear.joint", read("specs/planar/gear.joint") + "# more\n");
  EXPECT_EQ(remembered(), 3);
  EXPECT_EQ(remembered(), 4);
}

TEST_F(Remembered, NotWhereAnIncludeChanged) {
  write("specs/planar/angle.joint", read("specs/planar/angle.joint") + "# more\n");
  EXPECT_EQ(remembered(), 2) << said_;
}

TEST_F(Remembered, NotWhereAPublishedDerivationChanged) {
  write("specs/planar/angle.hand", read("specs/planar/angle.hand") + "# more\n");
  EXPECT_EQ(remembered(), 3);
  fs::remove(place_ / "specs/planar/angle.hand");
  EXPECT_EQ(remembered(), 3);
  EXPECT_NE(files("generated"), right_) << "the ledger had its costs";
}

TEST_F(Remembered, NotByAnotherProgram) {
  fs::copy(CDOT, place_ / "cdot");
  EXPECT_EQ(remembered("./cdot derive"), 4);
  std::ofstream(place_ / "cdot", std::ios::app) << "x";  // behind what is loaded: it does the same
  EXPECT_EQ(remembered("./cdot derive"), 0);
  EXPECT_EQ(remembered("./cdot derive"), 4);
}

TEST_F(Remembered, NotWhatIsDamaged) {
  const auto kept = files("remembered");
  ASSERT_EQ(kept.size(), 4u);
  for (const auto& [name, content] : kept) write("remembered/" + name, content.substr(0, content.size() / 2));
  EXPECT_EQ(remembered(), 0);
  EXPECT_EQ(files("remembered"), kept);
  for (const auto& [name, content] : kept) {
    std::string other = content;
    other[content.find("struct ") + 7] ^= 1;  // in the kernel: all lengths are right
    write("remembered/" + name, other);
  }
  EXPECT_EQ(remembered(), 0);
  EXPECT_EQ(files("generated"), right_);
}

TEST_F(Remembered, NotWhatWasNotProved) {
  write("specs/planar/wrong.joint", "joint wrong planar\n  \"x\"\n  angle(a) + angle(b) = 0\n");
  const Result once = cdot("derive wrong"), again = cdot("derive wrong");
  EXPECT_EQ(again.status, 2);
  EXPECT_EQ(again.said, once.said);
  EXPECT_EQ(files("remembered").size(), 4u);
}

TEST_F(Remembered, AFolderThatCannotBeUsedIsNoHindrance) {
  EXPECT_EQ(remembered("CDOT_CACHE=/dev/null/x " CDOT " derive"), 0) << said_;
  EXPECT_EQ(said_.find("/dev/null"), std::string::npos) << said_;
  EXPECT_EQ(remembered("env -u CDOT_CACHE -u HOME -u XDG_CACHE_HOME " CDOT " derive"), 0) << said_;
  EXPECT_EQ(remembered("env -u CDOT_CACHE XDG_CACHE_HOME=there " CDOT " derive"), 0) << said_;
  EXPECT_EQ(files("there/cdot").size(), 4u);
  EXPECT_EQ(files("generated"), right_);
}

TEST_F(Remembered, TheOldestIsForgottenFirst) {
  const fs::path folder = place_ / "small";
  const Memory memory(folder, 10000);
  const auto key = [](int i) { return "key " + std::to_string(i); };
  for (int i = 0; i < 8; ++i) {
    memory.keep(key(i), std::string(2000, 'x'));
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {  // an hour later
      fs::last_write_time(entry.path(), entry.last_write_time() - std::chrono::hours(1));
    }
    EXPECT_TRUE(memory.recall(key(0)));  // asked for again and again
  }
  memory.trim();
  std::string left;
  for (int i = 0; i < 8; ++i) left += memory.recall(key(i)) ? "1" : "0";
  ASSERT_EQ(left, "10000111");
  EXPECT_EQ(*memory.recall(key(7)), std::string(2000, 'x'));
}

}  // namespace
