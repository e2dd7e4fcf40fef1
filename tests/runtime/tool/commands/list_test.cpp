// cdot-run list: joints, effects and the keys of a scene.
#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/runtime/tool/support.hpp"

namespace cdot::test {
namespace {

TEST(ListCommand, ShowsEffectsInSectionsOfTheirOwn) {
  const std::string text = cdot_run("list").out;
  size_t from = 0;
  for (const char* part :
       {"Joints in the plane", "\nrevolute  (2 bodies, 2 rows)", "Effects in the plane", "\nservo  (2 bodies)\n    \"",
        "Joints in space", "\nrevolute_n1  (", "Effects in space", "\ndrag  ("}) {
    const size_t at = text.find(part, from);
    ASSERT_NE(at, std::string::npos) << part << " after " << text.substr(0, from);
    from = at;
  }
  for (const auto& type : nlohmann::json::parse(cdot_run("list --json").out))
    EXPECT_EQ(bool(type["effect"]),
              std::filesystem::exists(scenes_dir().parent_path() / (type["dimension"] == 2 ? "planar" : "spatial") /
                                      (std::string(type["type"]) + ".effect")))
        << type;
}

TEST(ListCommand, ShowsJointsWithParametersAndCoordinates) {
  const CommandResult text = cdot_run("list");
  EXPECT_EQ(text.status, 0);
  EXPECT_NE(text.out.find("revolute  (2 bodies, 2 rows)"), std::string::npos) << text.out;
  const auto list = nlohmann::json::parse(cdot_run("list --json").out);
  const auto revolute =
      std::find_if(list.begin(), list.end(), [](const auto& joint) { return joint["type"] == "revolute"; });
  ASSERT_NE(revolute, list.end());
  EXPECT_EQ((*revolute)["bodies"], 2);
  EXPECT_EQ((*revolute)["parameters"][0]["name"], "pa");
  EXPECT_EQ((*revolute)["parameters"][0]["kind"], "point");
  EXPECT_EQ((*revolute)["coordinates"][0]["name"], "angle");
  EXPECT_FALSE((*revolute)["effect"]);
}

TEST(ListCommand, TellsTheMeaningOfOneName) {
  const CommandResult prismatic = cdot_run("list prismatic");
  EXPECT_EQ(prismatic.status, 0) << prismatic.err;
  EXPECT_EQ(prismatic.out.find("In the plane:\nprismatic  (2 bodies, 2 rows)\n"), 0u) << prismatic.out;
  EXPECT_NE(prismatic.out.find("on the line through pb of b with the normal t"), std::string::npos) << prismatic.out;
  EXPECT_NE(prismatic.out.find("In space:\nprismatic  ("), std::string::npos) << prismatic.out;
  EXPECT_EQ(prismatic.out.find("revolute"), std::string::npos) << prismatic.out;
  EXPECT_EQ(cdot_run("list breaking").status, 0);
  const CommandResult unknown = cdot_run("list prismatik");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("`prismatik`; did you mean `prismatic`?"), std::string::npos) << unknown.err;
}

TEST(ListCommand, ShowsTheKeysOfAScene) {
  const CommandResult text = cdot_run("list --keys");
  EXPECT_EQ(text.status, 0);
  for (const char* part :
       {"[[body]]", "orientation      in space:", "local_error", "friction         largest force",
        "rod              its length", "repeat           how many", "load             constant force", "[[spring]]"})
    EXPECT_NE(text.out.find(part), std::string::npos) << part << text.out;
}

}  // namespace
}  // namespace cdot::test
