// The output, files and refusals of `cdot-run accuracy`.
#include "runtime/tool/accuracy/command.hpp"

#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>

#include "runtime/tool/accuracy/work_precision.hpp"
#include "runtime/tool/run/output.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test {
namespace {

// Two points of euler, one of euler in float, one failure.
AccuracyReport report_by_hand() {
  SweepOptions options;
  options.ways = {{Integrator::euler, Solver::direct, Drift::projection},
                  {Integrator::euler, Solver::direct, Drift::projection, 0, true},
                  {Integrator::euler, Solver::iterative, Drift::baumgarte, 4}};
  SweepState state;
  state.reference.times = equal_times(2, sample_count);
  state.reference.made_by = "this test";
  const auto point = [&](std::size_t way, int level, double error, double microseconds) {
    return Point{options.ways[way], level, {}, {error, error / 2, 1e-9, 1e-8, 1e-3}, 0, 0, {microseconds / 1e6}};
  };
  state.points = {point(0, 3, 0.04, 10), point(0, 6, 5e-3, 80), point(1, 3, 0.05, 8)};
  state.points.push_back({options.ways[2], 0, "not finite", {}, 0, 0, {}});
  return report_of(scene_named("simple_pendulum"), options, state);
}

TEST(AccuracyReport, SaysWhatToUse) {
  const std::string text = accuracy_text(report_by_hand());
  EXPECT_NE(text.find("for 1e-1 use euler + projection, direct, float, step 0.01562 s: 8 us per simulated second; ten "
                      "times more accuracy costs 10x\n"
                      "  for 1e-2 use euler + projection, direct, step 0.001953 s: 80 us per simulated second\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("reference       this test, as given\n"), std::string::npos) << text;
  EXPECT_NE(text.find("3 runs succeeded, 1 failed"), std::string::npos) << text;
}

TEST(AccuracyReport, SaysHowFarItsReferenceCarries) {
  AccuracyReport report = report_by_hand();
  report.reference.disagree.assign(sample_count, 1e-13);
  EXPECT_NE(accuracy_text(report).find("this test agree to 1.0e-13 m, rad\n  error"), std::string::npos);
  report.reference.disagree.back() = 1e-3;
  report.reference.settled = "this is why";
  EXPECT_NE(
      accuracy_text(report).find("this test agree to 1.0e-03 m, rad\n"
                                 "                  more than 1e-12 apart: this is why\n"
                                 "                  errors below 1.0e-02, ten times the disagreement, count as equal\n"
                                 "                  until 1.875 s they agree to 1e-09: use --until 1.875\n"),
      std::string::npos)
      << accuracy_text(report);
  report.reference.sensitivity = {50, 2e-12};
  report.reference.verdict = "so it is";
  EXPECT_NE(accuracy_text(report).find("apart: this is why\n"
                                       "                  starts that differ by a relative 1e-9 end 5.0e-08 "
                                       "apart; by 1e-15: 2.0e-12\n"
                                       "                  so it is\n"
                                       "                  errors below 1.0e-02"),
            std::string::npos)
      << accuracy_text(report);
}

TEST(AccuracyReport, CsvHasTheSameColumnsInEveryRow) {
  const std::string csv = accuracy_csv(report_by_hand());
  std::stringstream lines(csv);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    bool quoted = false;
    int commas = 0;
    for (const char c : line) {
      quoted ^= c == '"';
      commas += !quoted && c == ',';
    }
    EXPECT_EQ(commas, 18) << line;
  }
  EXPECT_EQ(count, 5);
  EXPECT_NE(
      csv.find("\"euler + projection, direct\",euler,direct,projection,0,double,0,0.001953125,0,0.005,0.005,0.0025,"
               "1e-09,1e-08,0.001,8e-05,0,1,\n"),
      std::string::npos)
      << csv;
}

TEST(AccuracyReport, JsonHasPointsFrontierAndAdvice) {
  const auto json = nlohmann::json::parse(accuracy_json(report_by_hand()));
  EXPECT_EQ(json["points"].size(), 3u);
  EXPECT_EQ(json["failures"][0]["failure"], "not finite");
  EXPECT_EQ(json["frontier"], (nlohmann::json{2, 0, 1}));
  EXPECT_EQ(json["advice"][0]["point"], 2);
  EXPECT_DOUBLE_EQ(json["points"][1]["cpu_per_second"], 80e-6);
}

TEST(AccuracyReport, PictureIsWellFormed) {
  const TemporaryFolder folder;
  const std::string path = folder / "picture.svg";
  write_file(path, accuracy_svg(report_by_hand()));
  const CommandResult result =
      run_command(fmt::format("python3 -c \"import sys, xml.dom.minidom as d; "
                              "print(len([c for c in d.parse(sys.argv[1]).getElementsByTagName('circle') if "
                              "c.getAttribute('class') == 'ring']))\" '{}'",
                              path));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, "4\n");  // three points of the frontier and the one of the legend
}

// --- the picture ---

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(WorkPrecision, PlacesPointsByDecades) {
  Diagram diagram;
  diagram.title = "a < b";
  diagram.error_label = "error [m]";
  diagram.series = {{"one & only", "#123456", 0, false, {{1e-1, 1e-5}, {1e-3, 1e-3}}, {"the < first", "the last"}},
                    {"beaten", "#654321", 1, true, {{1e-2, 1e-3}, {1e-1, 5e-4}}, {}}};
  const std::string svg = work_precision_svg(diagram);
  EXPECT_TRUE(has(svg, ">a &lt; b<")) << svg;
  EXPECT_TRUE(has(svg, ">one &amp; only<") && has(svg, "<title>the &lt; first</title>"));
  // From 10 to 1000 us and from 1e-1 to 1e-3, corner to corner; the line is the frontier.
  EXPECT_TRUE(has(svg, "<path class=\"frontier\" d=\"M84.0 542.0L644.0 72.0\"/>"));
  EXPECT_TRUE(has(svg, "<path class=\"curve\" d=\"M84.0 542.0L644.0 72.0\" stroke=\"#123456\"/>"));
  // In the middle by error: not on the frontier, but the end of its series' line.
  EXPECT_TRUE(has(svg, "translate(364.0 72.0)\" stroke=\"#654321\" fill=\"var(--paper)\""));
  EXPECT_FALSE(has(svg, "resolution of the reference"));
  diagram.resolution = 1e-2;
  EXPECT_TRUE(has(work_precision_svg(diagram), "<path class=\"limit\" d=\"M364.0 72v470\"/>"));
  EXPECT_TRUE(has(work_precision_svg(diagram), "<path class=\"frontier\" d=\"M84.0 542.0"));
}

// Names are at the ends of their lines and do not overlap.
TEST(WorkPrecision, NamesDoNotOverlap) {
  Diagram diagram;
  for (int k = 0; k < 22; ++k)
    diagram.series.push_back({fmt::format("series {}", k), "red", k, false, {{1e-2 / (k + 1), 1e-3 + 1e-9 * k}}, {}});
  const std::string svg = work_precision_svg(diagram);
  double before = 0;
  int seen = 0;
  for (std::size_t at = svg.find(">series "); at != std::string::npos; at = svg.find(">series ", at + 1), ++seen) {
    const double y = std::stod(svg.substr(svg.rfind("y=\"", at) + 3));
    if (seen > 0) {
      EXPECT_GE(y - before, 20) << seen;
    }
    before = y;
  }
  EXPECT_EQ(seen, 22);
}

// --- the command ---

std::string scene_path(const std::string& name) {
  return fmt::format("'{}'", (scenes_dir() / (name + ".toml")).string());
}

TEST(AccuracyCommand, WritesThreeFilesAndNoMore) {
  const TemporaryFolder folder;
  const std::string prefix = folder / "pendulum";
  const CommandResult result =
      cdot_run(fmt::format("accuracy {} --until 0.5 --levels 6 --rounds 1 --budget 5 --only 'direct, float' -o '{}'",
                           scene_path("simple_pendulum"), prefix));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(folder.contents(), (std::vector<std::string>{"pendulum.csv", "pendulum.json", "pendulum.svg"}));
  EXPECT_NE(result.out.find("the frontier"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("us per simulated second"), std::string::npos) << result.out;
}

TEST(AccuracyCommand, MeasuresAgainstATrajectory) {
  const TemporaryFolder folder;
  const std::string csv = folder / "fine.csv", prefix = folder / "p";
  ASSERT_EQ(cdot_run(fmt::format("simulate {} --until 0.5 --step 1e-5 --every 0.03125 -o '{}'",
                                 scene_path("compound_pendulum"), csv))
                .status,
            0);
  const CommandResult result =
      cdot_run(fmt::format("accuracy {} --until 0.5 --levels 5 --rounds 1 --only 'euler + projection, direct' "
                           "--reference '{}' -o '{}' --json",
                           scene_path("compound_pendulum"), csv, prefix));
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["samples"], 16);
  EXPECT_EQ(json["reference"]["made_by"], csv);
  double before = 1e9;
  for (const auto& point : json["points"]) {
    if (point["precision"] != "double" || point["lanes"] != 0) continue;
    EXPECT_LT(point["error"], 0.7 * before);
    before = point["error"];
  }
  EXPECT_LT(before, 1e9);
}

// Times, places and angles of the last row.
std::vector<double> last_row(const std::string& path) {
  std::ifstream file(path);
  std::string line, last;
  while (std::getline(file, line)) last = line;
  std::vector<double> numbers;
  std::stringstream cells(last);
  for (std::string cell; std::getline(cells, cell, ',');) numbers.push_back(std::stod(cell));
  return numbers;
}

// A scene can use every method that the advice names, also in float, and reaches the stated error.
TEST(AccuracyCommand, ItsAdviceCanBeTaken) {
  const TemporaryFolder folder;
  const std::string prefix = folder / "p", exact = folder / "exact.csv", path = folder / "advised.csv";
  const std::string pendulum = scene_path("double_pendulum");
  const CommandResult result = cdot_run(fmt::format(
      "accuracy {} --until 1 --only 'rk4, direct, float' --levels 5 --rounds 1 -o '{}' --json", pendulum, prefix));
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  ASSERT_EQ(cdot_run(fmt::format("simulate {} --until 1 --integrator dop853 --local-error 1e-13 --times 1 -o '{}'",
                                 pendulum, exact))
                .status,
            0);
  ASSERT_FALSE(json["advice"].empty());
  for (const auto& advice : json["advice"]) {
    const auto& point = json["points"][advice["point"].get<std::size_t>()];
    const auto text = [&](const char* key) { return point[key].get<std::string>(); };
    ASSERT_EQ(cdot_run(fmt::format("simulate {} --until 1 --times 1 {} -o '{}'", pendulum,
                                   advice["options"].get<std::string>(), path))
                  .status,
              0);
    const std::vector<double> taken = last_row(path), wanted = last_row(exact);
    ASSERT_EQ(taken.size(), 13u);
    double off = 0;
    for (const std::size_t body : {1, 7}) {
      off = std::max(off, std::hypot(taken[body] - wanted[body], taken[body + 1] - wanted[body + 1]));
      off = std::max(off, std::abs(taken[body + 2] - wanted[body + 2]));
    }
    fmt::print("  {}, step {}: {:.2e} at the end, {:.2e} at worst\n", text("method"), point["step"].get<double>(), off,
               point["error"].get<double>());
    EXPECT_EQ(text("precision"), "float");
    EXPECT_GT(off, 0.01 * point["error"].get<double>());
    EXPECT_LE(off, 1.001 * point["error"].get<double>());
    EXPECT_LE(point["error"], advice["error"]);
  }
}

// One search has two front ends: they choose alike, and both know the error.
TEST(AccuracyCommand, FindsWhatSimulateFinds) {
  const TemporaryFolder folder;
  const std::string scene = scene_path("double_pendulum");
  const CommandResult result = cdot_run(
      fmt::format("accuracy {} --only dop853 --budget 3 --rounds 1 -o '{}' --json", scene, (folder / "p").string()));
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  ASSERT_GE(json["searched"].size(), 5u);
  for (const auto& found : json["searched"]) {
    const double asked = found["asked"];
    const auto chosen =
        nlohmann::json::parse(cdot_run(fmt::format("simulate {} --accuracy {} --json", scene, asked)).out)["accuracy"];
    for (const char* key : {"integrator", "local_error", "step", "achieved", "evaluations"})
      EXPECT_EQ(chosen[key], found[key]) << asked << " " << key;
    EXPECT_LE(found["error"], asked);
    EXPECT_LE(found["error"], 3 * found["achieved"].get<double>() + 1e-13);
  }
}

TEST(AccuracyCommand, MistakesExitWithTwoAndAMessage) {
  const TemporaryFolder folder;
  const std::string prefix = folder / "p", pendulum = scene_path("simple_pendulum");
  const auto refused = [&](const std::string& arguments) {
    const CommandResult result = cdot_run("accuracy " + pendulum + " -o '" + prefix + "' " + arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_EQ(result.out, "") << arguments;
    return result.err;
  };
  EXPECT_EQ(refused("--resume"), "cdot-run: " + prefix + ".state.json: cannot be read\n");
  EXPECT_TRUE(refused("--only magic")
                  .starts_with("cdot-run: no way has \"magic\" in its name; known ways:\n  euler, direct\n"));
  EXPECT_EQ(refused("--reference no.csv"), "cdot-run: no.csv: cannot be read\n");
  const std::string csv = folder / "r.csv";
  write_file(csv, "time,bob.x\n");
  EXPECT_EQ(refused("--reference '" + csv + "'"), "cdot-run: " + csv +
                                                      ":1: the columns differ from those of this scene: "
                                                      "time,bob.x,bob.y,bob.angle,bob.vx,bob.vy,bob.omega\n");
  const std::string head = "time,bob.x,bob.y,bob.angle,bob.vx,bob.vy,bob.omega\n";
  write_file(csv, head);
  EXPECT_EQ(refused("--reference '" + csv + "'"), "cdot-run: " + csv + ": no row between 0 and 10 s\n");
  write_file(csv, head + "1,0,0,0,0,0,nan\n");
  EXPECT_EQ(refused("--reference '" + csv + "'"), "cdot-run: " + csv + ":2: \"nan\" is not a finite number\n");
  write_file(csv, head + "1,0,0,0,0,0\n");
  EXPECT_EQ(refused("--reference '" + csv + "'"), "cdot-run: " + csv + ":2: 6 numbers, but 7 columns\n");
  write_file(csv, head + "1,0,0,0,0,0,0\n1,0,0,0,0,0,0\n");
  EXPECT_EQ(refused("--reference '" + csv + "'"), "cdot-run: " + csv + ":3: the times do not ascend\n");
  EXPECT_EQ(cdot_run("accuracy no_such.toml").status, 2);
  EXPECT_NE(refused("--budget 0").find("--budget"), std::string::npos);
}

// Ctrl-C in the middle saves the measurements, and the next command completes the sweep.
TEST(AccuracyCommand, IsInterruptedAndResumed) {
  const TemporaryFolder folder;
  const std::string prefix = folder / "p";
  const std::string arguments =
      fmt::format("accuracy {} --until 2 -o '{}' --only iterations --budget", scene_path("double_pendulum"), prefix);
  const std::string saved = "runs are saved in " + prefix + ".state.json; --resume continues\n";
  CommandResult cut;
  for (const int seconds : {3, 10, 30, 100}) {  // beside other work the reference alone may take the first seconds
    cut = run_command(fmt::format("timeout -s INT --preserve-status {} '{}' {} 600", seconds, CDOT_RUN, arguments));
    if (cut.err.find(saved) != std::string::npos) break;
  }
  EXPECT_EQ(cut.status, 130) << cut.out << cut.err;
  EXPECT_EQ(cut.out, "");
  EXPECT_NE(cut.err.find(saved), std::string::npos) << cut.err;
  EXPECT_EQ(folder.contents(), std::vector<std::string>{"p.state.json"});
  const CommandResult rest = cdot_run(arguments + " 2 --rounds 1 --resume");
  EXPECT_EQ(rest.status, 0) << rest.err;
  EXPECT_EQ(folder.contents(), (std::vector<std::string>{"p.csv", "p.json", "p.svg"}));
}

TEST(AccuracyCommand, HelpTeaches) {
  const CommandResult result = cdot_run("accuracy --help");
  EXPECT_EQ(result.status, 0);
  for (const char* word : {"--reference", "--resume", "--budget", "--json", "Exit status"})
    EXPECT_NE(result.out.find(word), std::string::npos) << word;
}

}  // namespace
}  // namespace cdot::test
