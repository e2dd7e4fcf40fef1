// Every engine gets the same problem as Cdot and reaches the accuracy of the committed table.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include <cdot/spatial.hpp>

#include "runtime/tool/scene/scene.hpp"
#include "tests/bench/peers/geometry.hpp"
#include "tests/bench/peers/measure.hpp"
#include "tests/bench/peers/problem.hpp"

namespace cdot::peers {

void PrintTo(const ProblemRow& row, std::ostream* out) { *out << row.name; }

namespace {

const std::string source = CDOT_SOURCE_DIR;

std::string name_of(const testing::TestParamInfo<ProblemRow>& info) { return info.param.name; }

class Problems : public testing::TestWithParam<ProblemRow> {};

void expect_near(const Vec3& a, const Vec3& b, double bound, const std::string& what) {
  EXPECT_LE(norm(a - b), bound) << what;
}

// Totals of a scene's World from its masses and velocities.
template <class S>
Totals totals_of_world(const BasicWorld<S>& world, const Problem& problem) {
  std::vector<State> states;
  Totals sum;
  for (int k = 0; k < int(problem.bodies.size()); ++k) {
    const auto q = world.pose(k);
    const auto v = world.velocity(k);
    const auto m = world.inverse_mass(k);
    Vec3 x{q.x, q.y, 0}, speed{v.x, v.y, 0}, spin, w;
    if constexpr (S::dimension == Dimension::planar) {
      w = {0, 0, v.w};
      spin = {0, 0, v.w / m.I};
    } else {
      x[2] = q.z, speed[2] = v.z;
      w = {v.wx, v.wy, v.wz};
      const auto L = spatial::inverse(S::inverse_inertia(m)) * spatial::Vector<double>{v.wx, v.wy, v.wz};
      spin = {L.x, L.y, L.z};
    }
    const Vec3 p = (1 / m.m) * speed;
    sum.momentum = sum.momentum + p;
    sum.angular_momentum = sum.angular_momentum + spin + cross(x, p);
    sum.kinetic += 0.5 * (dot(p, speed) + dot(spin, w));
    const Settings& s = world.settings();
    sum.potential -= dot({s.gravity_x, s.gravity_y, s.gravity_z}, x) / m.m;
  }
  return sum;
}

void expect_same(const Totals& a, const Totals& b, double relative, const std::string& what) {
  const double scale = 1 + norm(b.momentum) + norm(b.angular_momentum) + b.kinetic + std::fabs(b.potential);
  expect_near(a.momentum, b.momentum, relative * scale, what + ": momentum");
  expect_near(a.angular_momentum, b.angular_momentum, relative * scale, what + ": angular momentum");
  EXPECT_NEAR(a.kinetic, b.kinetic, relative * scale) << what << ": kinetic energy";
  EXPECT_NEAR(a.potential, b.potential, relative * scale) << what << ": potential energy";
}

TEST_P(Problems, StartWithTheTotalsOfTheScene) {
  const Problem problem = pose(GetParam());
  const Scene scene = read_scene(source + "/specs/scenes/" + problem.scene + ".toml");
  const Totals of_scene = problem.planar ? totals_of_world(build_world_in<Planar<double>>(scene), problem)
                                         : totals_of_world(build_world_in<Spatial<double>>(scene), problem);
  expect_same(totals(problem, starts(problem)), of_scene, 1e-14, problem.name);
  int asked = 0;
  for (const Engine& engine : engines()) {
    for (const Series& series : engine.series(problem)) {
      const auto run = series.start(series.knobs.front());
      std::vector<State> states;
      for (int k = 0; k < int(problem.bodies.size()); ++k) states.push_back(run->state(k));
      const std::string what = problem.name + ", " + engine.name + ", " + series.name;
      expect_same(totals(problem, states), of_scene, engine.number == "float" ? 1e-6 : 1e-12, what);
      EXPECT_LE(start_error(problem, *run), engine.number == "float" ? 1e-5 : 1e-12) << what;
      ++asked;
    }
  }
  std::printf("%s: %d series start with kinetic energy %.6g J, potential energy %.6g J\n", problem.name.c_str(), asked,
              of_scene.kinetic, of_scene.potential);
}

// The reference conserves the invariants.
TEST_P(Problems, ReferencesKeepEnergy) {
  const Problem problem = load(GetParam());
  const Totals start = totals(problem, starts(problem));
  for (const std::vector<State>& states : problem.reference) {
    const Totals now = totals(problem, states);
    const double scale = 1 + start.kinetic + std::fabs(start.potential);
    EXPECT_NEAR(now.kinetic + now.potential, start.kinetic + start.potential, 1e-12 * scale);
    if (problem.joints.empty()) expect_near(now.angular_momentum, start.angular_momentum, 1e-12 * scale, problem.name);
  }
}

struct Row {
  std::string engine, series;
  double knob, error, seconds;
};

// points.csv of a problem: problem,engine,"series",knob,value,error,us_per_simulated_second,…
std::vector<Row> committed(const Problem& problem) {
  std::ifstream in(source + "/tests/bench/peers/results/points.csv");
  std::vector<Row> rows;
  for (std::string line; std::getline(in, line);) {
    const std::size_t open = line.find('"'), close = line.rfind('"');
    if (open == std::string::npos) continue;
    std::istringstream head(line.substr(0, open)), tail(line.substr(close + 2));
    std::string name, engine, unit, value, error, price;
    std::getline(head, name, ',');
    std::getline(head, engine, ',');
    for (std::string* cell : {&unit, &value, &error, &price}) std::getline(tail, *cell, ',');
    if (name == problem.name)
      rows.push_back({engine, line.substr(open + 1, close - open - 1), std::stod(value), std::stod(error),
                      1e-6 * std::stod(price) * problem.duration});
  }
  return rows;
}

std::unique_ptr<peers::Run> start(const Problem& problem, const Row& row) {
  for (const Engine& engine : engines()) {
    if (engine.name != row.engine) continue;
    for (const Series& series : engine.series(problem))
      if (series.name == row.series) return series.start(row.knob);
  }
  return nullptr;
}

TEST_P(Problems, AreSolvedByEveryEngineAsWellAsTheTableSays) {
  const Problem problem = load(GetParam());
  std::map<std::string, Row> best;  // within the time of a test
  for (const Row& row : committed(problem)) {
    if (row.seconds > 0.1) continue;
    const auto [at, fresh] = best.try_emplace(row.engine, row);
    if (!fresh && row.error < at->second.error) at->second = row;
  }
  for (const Engine& engine : engines())
    EXPECT_EQ(best.count(engine.name) != 0, !engine.series(problem).empty())
        << engine.name << " and the table disagree on whether it can pose " << problem.name;
  for (const auto& [name, row] : best) {
    const auto run = start(problem, row);
    ASSERT_NE(run, nullptr) << name << " has no series " << row.series << ": remake the table";
    const double error = error_of(problem, *run);
    std::printf("%-14s %-40s %.3e s: error %.2e, in the table %.2e\n", name.c_str(), row.series.c_str(), row.knob,
                error, row.error);
    EXPECT_LE(error, 1.5 * row.error + 1e-12) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Problems, testing::ValuesIn(problem_rows()), name_of);

// Independent solutions: Gauss-Legendre in minimal coordinates, elliptic functions.
TEST(References, AgreeWithThePublishedSolutions) {
  const std::map<std::string, double> ends{
      {"double_pendulum", 1e-11}, {"slider_crank", 1e-11}, {"torque_free_body", 1e-11}};
  for (const ProblemRow& row : problem_rows()) {
    if (!ends.contains(row.name)) continue;
    const Problem problem = load(row);
    std::ifstream in(source + "/tests/runtime/tool/run/reference/" + row.name + ".json");
    const nlohmann::json published = nlohmann::json::parse(in);
    int compared = 0;
    for (const nlohmann::json& sample : published.at("samples")) {
      const auto at = std::find(problem.times.begin(), problem.times.end(), sample.at("t").get<double>());
      if (at == problem.times.end()) continue;
      const std::vector<State>& states = problem.reference[std::size_t(at - problem.times.begin())];
      for (std::size_t k = 0; k < states.size(); ++k) {
        const nlohmann::json& is = sample.at("bodies").at(problem.bodies[k].name);
        const Vec3 x{is[0], is[1], problem.planar ? 0 : is[2].get<double>()};
        const Quaternion q = problem.planar ? about_z(is[2]) : Quaternion{is[3], is[4], is[5], is[6]};
        EXPECT_LE(norm(x - states[k].x), ends.at(row.name)) << row.name << " at " << *at;
        EXPECT_LE(angle_between(q, states[k].q), ends.at(row.name)) << row.name << " at " << *at;
        ++compared;
      }
    }
    std::printf("%s: %d states compared\n", row.name, compared);
    EXPECT_GT(compared, 0) << row.name;
  }
}

}  // namespace
}  // namespace cdot::peers
