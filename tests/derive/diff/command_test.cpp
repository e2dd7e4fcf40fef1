// `cdot diff` from the command line: JSON, exit status, errors.
#include <gtest/gtest.h>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <unistd.h>

#include "tests/derive/diff/support.hpp"
#include "tests/shell.hpp"

namespace cdot::test {
namespace {

using nlohmann::json;

ShellResult diff(const std::string& arguments, bool errors_too = true,
                 const std::filesystem::path& specs = specs_folder()) {
  const std::string command = std::string(CDOT) + " diff --specs '" + specs.string() + "' " + arguments +
                              (errors_too ? " 2>&1" : " 2>/dev/null");
  return shell(command);
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

void expect_strings(const json& object, const std::vector<std::string>& names, const std::string& where) {
  for (const std::string& name : names) {
    ASSERT_TRUE(object.contains(name)) << where << " has no " << name;
    EXPECT_TRUE(object[name].is_string()) << where << ": " << name;
  }
}

void expect_item(const json& item, const std::string& where) {
  static const std::set<std::string> whats = {"C",      "Cdot",  "J",         "K",       "b",     "update",
                                              "energy", "force", "stiffness", "damping", "wrench"};
  static const std::set<std::string> kinds = {"sign",       "factor",     "wrong body",           "missing term",
                                              "extra term", "transposed", "undeclared assumption"};
  expect_strings(item, {"what", "row", "column", "kind", "generated", "hand", "difference", "sentence", "confirmed"},
                 where);
  EXPECT_EQ(item.size(), 9u) << where;
  EXPECT_TRUE(whats.contains(item["what"])) << where << item["what"];
  EXPECT_TRUE(kinds.contains(item["kind"])) << where << item["kind"];
  for (const char* name : {"hand", "sentence", "confirmed"}) EXPECT_NE(item[name], "") << where << name;
  // Without one of two values there is no difference.
  EXPECT_EQ(item["generated"] == "", item["difference"] == "") << where;
}

TEST(Command, JsonHasEveryFieldOfEveryEntry) {
  const ShellResult result = diff("--json", false);
  EXPECT_EQ(result.status, 1);
  const json entries = json::parse(result.text);
  ASSERT_TRUE(entries.is_array());
  std::map<std::string, int> verdicts;
  int items = 0;
  for (const json& entry : entries) {
    const std::string where = entry.value("id", "?") + ": ";
    expect_strings(entry, {"id", "joint", "title", "source", "verdict", "condition"}, where);
    EXPECT_EQ(entry.size(), 8u) << where;
    for (const char* name : {"id", "joint", "title", "source"}) EXPECT_NE(entry[name], "") << where << name;
    const std::string verdict = entry["verdict"];
    ++verdicts[verdict];
    ASSERT_TRUE(entry["items"].is_array()) << where;
    ASSERT_TRUE(entry["remarks"].is_array()) << where;
    for (const json& remark : entry["remarks"]) EXPECT_TRUE(remark.is_string()) << where;
    EXPECT_EQ(verdict == "differs", !entry["items"].empty()) << where;
    if (verdict == "agrees") {
      EXPECT_EQ(entry["condition"], "") << where;
    }
    if (verdict == "agrees-if" || verdict == "listed") {
      EXPECT_NE(entry["condition"], "") << where;
    }
    for (const json& item : entry["items"]) expect_item(item, where), ++items;
  }
  std::printf("%zu entries, %d items:", entries.size(), items);
  for (const auto& [verdict, count] : verdicts) std::printf(" %d %s", count, verdict.c_str());
  std::printf("\n");
  const std::set<std::string> known = {"agrees", "agrees-if", "differs", "listed"};
  for (const auto& [verdict, count] : verdicts) EXPECT_TRUE(known.contains(verdict)) << verdict;
  EXPECT_GE(entries.size(), 90u);
}

TEST(Command, AnEntryCanBeAskedForByItsId) {
  const ShellResult one = diff("--json LIN-4", false);
  EXPECT_EQ(one.status, 1);
  const json entries = json::parse(one.text);
  ASSERT_EQ(entries.size(), 1u);
  EXPECT_EQ(entries[0]["id"], "LIN-4");
  // Two joints have an entry GEA-5.
  EXPECT_EQ(json::parse(diff("--json GEA-5", false).text).size(), 2u);
  EXPECT_EQ(diff("ANG-1").status, 0);
}

TEST(Command, StatusIsZeroWhereNothingDiffers) {
  EXPECT_EQ(diff("weld").status, 0);
  EXPECT_EQ(diff("line").status, 1);
}

TEST(Command, ShowsWhatDiffersOfAllInTheSameOrderHoweverManyAtOnce) {
  namespace fs = std::filesystem;
  const fs::path few = fs::path(testing::TempDir()) / ("cdot_few_" + std::to_string(getpid()));
  fs::create_directories(few / "planar");
  for (const char* name : {"line", "angle", "gear"}) {
    for (const char* kind : {".joint", ".hand"}) {
      const std::string file = std::string("planar/") + name + kind;
      fs::copy(specs_folder() / file, few / file);
    }
  }
  const ShellResult all = diff("-j 1", true, few);
  EXPECT_EQ(all.status, 1);
  EXPECT_TRUE(contains(all.text, "LIN-4")) << all.text;
  EXPECT_FALSE(contains(all.text, "ANG-1 ")) << "entries that agree are shown without --all";
  EXPECT_EQ(diff("-j 3", true, few).text, all.text);
  const ShellResult as_json = diff("--json -j 1", true, few);
  EXPECT_EQ(diff("--json -j 3", true, few).text, as_json.text);
  EXPECT_EQ(json::parse(as_json.text).front()["id"], "ANG-1");
  fs::remove_all(few);
}

TEST(Command, WhatIsNotThereIsTwoAndSaysSo) {
  const std::map<std::string, std::string> messages = {
      {"LIN-44", "no entry `LIN-44` in any .hand file of the specs; did you mean `LIN-4`?"},
      {"prismatik", "did you mean `prismatic`?"},
      {"no/such.hand", "no such file: no/such.hand"},
      {"no/such.joint", "no such file: no/such.joint"},
      {"rolling", "no hand derivation beside "},
  };
  for (const auto& [word, message] : messages) {
    const ShellResult result = diff(word);
    EXPECT_EQ(result.status, 2) << word;
    EXPECT_TRUE(contains(result.text, message)) << word << ": " << result.text;
  }
  EXPECT_EQ(diff("--no-such-option").status, 2);
}

TEST(Command, AHandFileThatCannotBeReadIsTwo) {
  const std::filesystem::path hand = write_hand("line", "  J = [ t', cros(ra, t), -t', 0 ]\n");
  const ShellResult result = diff("'" + hand.string() + "'");
  std::filesystem::remove_all(hand.parent_path());
  EXPECT_EQ(result.status, 2);
  EXPECT_TRUE(contains(result.text, "there is no operator `cros`")) << result.text;
  EXPECT_TRUE(contains(result.text, ":3:")) << result.text;
}

}  // namespace
}  // namespace cdot::test
