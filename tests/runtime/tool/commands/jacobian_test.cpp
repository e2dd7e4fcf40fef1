// cdot-run diagnose --matrix: compares the system's D with results by other routes.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "runtime/tool/commands/matrix.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::jacobian_test {
namespace {

TEST(Jacobian, SizeRankAndFreedomOfTheMechanisms) {
  struct Case {
    const char* scene;
    int rows, columns, rank, freedom;
  };
  for (const Case& c : {Case{"double_pendulum", 4, 6, 4, 2}, Case{"four_bar", 8, 9, 8, 1},
                        Case{"slider_crank", 8, 9, 8, 1}, Case{"catenary_100", 202, 300, 202, 98},
                        Case{"../../tests/hard_cases/same_joint_ten_times/planar", 20, 3, 2, 1}}) {
    const SystemMatrix system = system_matrix(scene_named(c.scene));
    EXPECT_EQ(system.rows, c.rows) << c.scene;
    EXPECT_EQ(system.columns, c.columns) << c.scene;
    EXPECT_EQ(system.rank, c.rank) << c.scene;
    EXPECT_EQ(system.degrees_of_freedom, c.freedom) << c.scene;
  }
}

// In the flat pose the four-bar loses a rank: two motions are possible from there.
TEST(Jacobian, TheFlatFourBarLosesARank) {
  const SystemMatrix system = system_matrix(read_scene(R"(
[[body]]
name = "crank"
mass = 1
shape = { rod = 1 }
position = [0.5, 0]
[[body]]
name = "coupler"
mass = 1
shape = { rod = 1 }
position = [1.5, 0]
[[body]]
name = "rocker"
mass = 1
shape = { rod = 1 }
position = [1.5, 0]
[[joint]]
type = "revolute"
bodies = ["world", "crank"]
at = [0, 0]
[[joint]]
type = "revolute"
bodies = ["crank", "coupler"]
at = [1, 0]
[[joint]]
type = "revolute"
bodies = ["coupler", "rocker"]
at = [2, 0]
[[joint]]
type = "revolute"
bodies = ["rocker", "world"]
at = [1, 0]
)",
                                                       "flat.toml"));
  EXPECT_EQ(system.rank, 7);
  EXPECT_EQ(system.degrees_of_freedom, 2);
}

// D v equals the World's velocity errors row by row; K is D M^-1 D^T.
TEST(Jacobian, IsThatOfTheWorld) {
  const Scene scene = scene_named("slider_crank");
  World<double> world = build_world<double>(scene);
  for (int k = 0; k < 3; ++k) world.set_velocity(k, {0.3 * k - 1, 0.7, 2.0 - k});
  const SystemMatrix system = system_matrix(world);
  for (const auto& joint : system.joints) {
    const std::vector<double> expected = world.velocity_error(joint.joint);
    for (int r = 0; r < joint.rows; ++r) {
      double sum = 0;
      for (int k = 0; k < 3; ++k) {
        const auto v = world.velocity(system.bodies[k]);
        sum += system.entry(joint.first + r, 3 * k) * v.x + system.entry(joint.first + r, 3 * k + 1) * v.y +
               system.entry(joint.first + r, 3 * k + 2) * v.w;
      }
      EXPECT_NEAR(sum, expected[r], 1e-14);
    }
  }
  for (int r = 0; r < system.rows; ++r)
    for (int s = 0; s < system.rows; ++s) {
      double sum = 0;
      for (int k = 0; k < 3; ++k) {
        const auto m = world.inverse_mass(system.bodies[k]);
        for (int c = 0; c < 3; ++c)
          sum += system.entry(r, 3 * k + c) * (c == 2 ? m.I : m.m) * system.entry(s, 3 * k + c);
      }
      EXPECT_NEAR(system.K[r * system.rows + s], sum, 1e-9 * std::abs(sum) + 1e-12);
    }
}

TEST(Jacobian, JointsOfOneColourShareNoBody) {
  const SystemMatrix system = system_matrix(scene_named("catenary_100"));
  const ConflictGraph graph = conflicts(system);
  EXPECT_EQ(graph.colours, 2);
  EXPECT_EQ(graph.edges.size(), 100u);
  for (const auto& [a, b] : graph.edges) EXPECT_NE(graph.colour[a], graph.colour[b]);
}

TEST(Jacobian, BodiesThatMayNotTurnHaveNoSuchFreedom) {
  const SystemMatrix system = system_matrix(read_scene(R"(
[[body]]
name = "bob"
mass = 1
fixed_rotation = true
position = [1, 0]
[[joint]]
type = "distance"
bodies = ["world", "bob"]
pa = [0, 0]
pb = [0, 0]
)",
                                                       "bob.toml"));
  EXPECT_EQ(system.rank, 1);
  EXPECT_EQ(system.degrees_of_freedom, 1);
}

TEST(Jacobian, TheCommandPrintsAndDraws) {
  TemporaryFolder folder;
  const std::string four_bar = (scenes_dir() / "four_bar.toml").string();
  const std::string svg = (folder / "k.svg").string();
  const CommandResult text = cdot_run("diagnose --matrix '" + four_bar + "' --svg '" + svg + "'");
  EXPECT_EQ(text.status, 0);
  for (const char* part : {"D v = 0: 8 x 9", "rank 8: 1 degree of freedom", "B0.pin_x"})
    EXPECT_NE(text.out.find(part), std::string::npos) << text.out;
  EXPECT_EQ(folder.contents(), std::vector<std::string>{"k.svg"});
  const auto json = nlohmann::json::parse(cdot_run("diagnose --matrix '" + four_bar + "' --json").out);
  EXPECT_EQ(json["D"].size(), 8u);
  EXPECT_EQ(json["D"][0].size(), 9u);
  EXPECT_EQ(json["conflicts"].size(), 3u);
  EXPECT_EQ(json["degrees_of_freedom"], 1);
}

// In space, in a tilted plane: round-off must neither fill the table nor join its columns.
TEST(Jacobian, TheTableHasTheNumbersOfTheJson) {
  const std::string four_bar = (scenes_dir() / "spatial/four_bar.toml").string();
  const CommandResult table = cdot_run("diagnose --matrix '" + four_bar + "'");
  const auto D = nlohmann::json::parse(cdot_run("diagnose --matrix '" + four_bar + "' --json").out)["D"];
  std::istringstream lines(table.out.substr(table.out.find("\nD, columns of ")));
  std::map<std::string, std::vector<double>> rows;  // without empty blocks
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    std::string name;
    if (!(cells >> name) || name.find('.') == std::string::npos) continue;
    std::vector<double>& row = rows[name];
    const std::size_t before = row.size();
    for (std::string cell; cells >> cell;) {
      std::size_t read = 0;
      row.push_back(std::stod(cell, &read));
      EXPECT_EQ(read, cell.size()) << line;
    }
    EXPECT_EQ(row.size() - before, 6u) << line;
  }
  ASSERT_EQ(rows.size(), D.size());
  std::vector<double> printed, exact;
  for (auto& [name, row] : rows) printed.insert(printed.end(), row.begin(), row.end());
  for (const auto& row : D)
    for (const double number : row) exact.push_back(number);
  for (std::vector<double>* numbers : {&printed, &exact}) {
    std::erase_if(*numbers, [](double x) { return std::fabs(x) < 1e-15; });
    std::sort(numbers->begin(), numbers->end());
  }
  ASSERT_EQ(printed.size(), exact.size());
  for (std::size_t at = 0; at < exact.size(); ++at) EXPECT_NEAR(printed[at], exact[at], 1e-5 * std::fabs(exact[at]));
}

}  // namespace
}  // namespace cdot::test::jacobian_test
