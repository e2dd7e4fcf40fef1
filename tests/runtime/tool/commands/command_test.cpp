// cdot-run from the command line: help, exit status, files, JSON.
#include <algorithm>
#include <cmath>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>
#include <sys/stat.h>
#include <unistd.h>

#include "runtime/tool/run/output.hpp"
#include "tests/cases/cases.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::command_test {
namespace {

std::string scene(const std::string& name) { return fmt::format("'{}'", (scenes_dir() / (name + ".toml")).string()); }

std::vector<std::vector<std::string>> csv(const std::filesystem::path& path) {
  std::vector<std::vector<std::string>> rows;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::vector<std::string>& row = rows.emplace_back();
    std::stringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
  }
  return rows;
}

TEST(Command, HelpTeaches) {
  for (const char* arguments : {"--help", "simulate --help"}) {
    const CommandResult result = cdot_run(arguments);
    EXPECT_EQ(result.status, 0);
    for (const char* word : {"simulate", "Examples", "Exit status", "--html", "specs/scenes/README.md"}) {
      EXPECT_NE(result.out.find(word), std::string::npos) << arguments << ": " << word;
    }
  }
}

TEST(Command, NumbersMustBeFiniteAndInRange) {
  struct Case {
    const char *option, *text, *fault;
  };
  for (const Case& c :
       {Case{"--step", "nan", "is not a positive number"}, Case{"--step", "inf", "is not a positive number"},
        Case{"--step", "-1", "is not a positive number"}, Case{"--until", "nan", "is not a positive number"},
        Case{"--accuracy", "nan", "is not a positive number"}, Case{"--tolerance", "nan", "is not a positive number"},
        Case{"--every", "nan", "is not a positive number"}, Case{"--every", "1s", "is not a positive number"},
        Case{"--substeps", "nan", "is not a positive number"}, Case{"--times", "1,nan", "is not a number from 0 on"}}) {
    const CommandResult result = cdot_run(fmt::format("simulate {} {} {}", scene("simple_pendulum"), c.option, c.text));
    const std::string last = c.option == std::string("--times") ? "nan" : c.text;
    EXPECT_EQ(result.status, 2) << c.option;
    EXPECT_NE(result.err.find(fmt::format("{}: `{}` {}\n", c.option, last, c.fault)), std::string::npos) << result.err;
  }
}

// Only a regular file is replaced; a link keeps its name and its target gets the file.
TEST(Command, OutputsNeverReplaceDevicesPipesOrLinks) {
  namespace fs = std::filesystem;
  TemporaryFolder folder;
  const fs::path full = folder / "full", link = folder / "link", pipe = folder / "pipe";
  const auto simulate = [](const fs::path& to) {
    return fmt::format("simulate {} --until 0.01 --step 0.001 -o '{}'", scene("simple_pendulum"), to.string());
  };
  fs::create_symlink("/dev/full", full);
  const CommandResult refused = cdot_run(simulate(full));
  EXPECT_NE(refused.status, 0);
  EXPECT_NE(refused.err.find("full: cannot be written: No space left on device"), std::string::npos) << refused.err;
  EXPECT_TRUE(fs::is_symlink(full));

  std::ofstream(folder / "target") << "old";
  fs::create_symlink(folder / "target", link);
  EXPECT_EQ(cdot_run(simulate(link)).status, 0);
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(csv(folder / "target").size(), 12u);  // a head and 11 rows

  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDWR | O_NONBLOCK);  // keeps what is written until it is read
  EXPECT_EQ(cdot_run(simulate(pipe)).status, 0);
  EXPECT_TRUE(fs::is_fifo(pipe));
  std::string text(1 << 16, ' ');
  const ssize_t read = ::read(reader, text.data(), text.size());
  EXPECT_EQ(std::count(text.begin(), text.begin() + std::max<ssize_t>(read, 0), '\n'), 12);
  ::close(reader);
}

TEST(Command, AFullDiskBehindStandardOutputIsNoSuccess) {
  for (const char* arguments : {"list", "simulate {}", "--help", "simulate --help", "--version"}) {
    const std::string command = fmt::format(fmt::runtime(arguments), scene("simple_pendulum"));
    const CommandResult result = run_command(fmt::format("({} {} >/dev/full)", CDOT_RUN, command));
    EXPECT_EQ(result.status, 2) << command;
    EXPECT_NE(result.err.find("No space left on device"), std::string::npos) << result.err;
  }
}

TEST(Command, JacobianSaysWhereItWent) {
  const CommandResult result = cdot_run("jacobian " + scene("four_bar") + " --json");
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("use diagnose --matrix"), std::string::npos) << result.err;
}

TEST(Command, BadUsageAndBadScenesExitWithTwo) {
  EXPECT_EQ(cdot_run("").status, 2);
  EXPECT_EQ(cdot_run("simulate").status, 2);
  EXPECT_EQ(cdot_run("simulate no_such_file.toml").status, 2);
  EXPECT_EQ(cdot_run("simulate " + scene("compound_pendulum") + " --step -1").status, 2);
  EXPECT_EQ(cdot_run("simulate " + scene("compound_pendulum") + " --solver magic").status, 2);
  const TemporaryFolder folder;
  const std::string broken = (folder / "many_at_once.toml").string();
  std::ofstream(broken)
      << case_named(themes_in(source_dir() / "tests/runtime/tool/scene/broken"), "many_at_once.toml").input;
  const CommandResult result = cdot_run("simulate '" + broken + "'");
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.err.find("10 mistakes"), std::string::npos);
  EXPECT_NE(result.err.find("did you mean `revolute`?"), std::string::npos);
}

TEST(Command, AnUnstableRunExitsWithOneAndTheReason) {
  const CommandResult result =
      cdot_run("simulate " + scene("compound_pendulum") + " --drift none --step 0.05 --tolerance 1e-6");
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.out.find("FAILED          |C| of joint \"pivot\" is"), std::string::npos) << result.out;
}

TEST(Command, SummaryAsJson) {
  const CommandResult result = cdot_run("simulate " + scene("compound_pendulum") + " --until 1 --step 0.001 --json");
  EXPECT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["ok"], true);
  EXPECT_EQ(json["steps"], 1000);
  EXPECT_DOUBLE_EQ(json["time"], 1);
  EXPECT_LT(json["worst_error"], 1e-9);
  EXPECT_GT(json["cpu"], 0);
  EXPECT_LT(json["energy_drift"], 0.1);
}

TEST(Command, AStepWithoutAnIntegratorGetsOneThatHolds) {
  const auto run = [](const std::string& options) {
    const CommandResult result = cdot_run("simulate " + scene("chain_10") + " --until 0.2 --json" + options);
    EXPECT_EQ(result.status, 0) << options << result.out << result.err;
    const auto json = nlohmann::json::parse(result.out);
    return std::pair<std::string, std::string>(json["integrator"], json["why_integrator"]);
  };
  const std::string coarse = " --step 0.0166667", fine = " --step 0.001";
  const auto [integrator, why] = run(coarse);
  EXPECT_EQ(integrator, "implicit");
  EXPECT_EQ(why, "the tension of the joints can make \"link3\" oscillate by 1.4 rad per substep");
  EXPECT_EQ(run(coarse + " --integrator auto"), std::pair(integrator, why));
  EXPECT_EQ(run(fine).first, "rattle");
  EXPECT_EQ(run(coarse + " --substeps 20").first, "rattle");
  for (const char* named : {" --integrator euler", " --solver iterative", " --drift baumgarte"})
    EXPECT_EQ(run(fine + named), std::pair(std::string("euler"), std::string())) << named;
  EXPECT_EQ(run("").second, "") << "an accuracy chooses";
}

TEST(Command, ProgressOnlyWhereItIsSeen) {
  EXPECT_EQ(cdot_run("simulate " + scene("compound_pendulum") + " --until 0.1").err, "");
}

TEST(Command, TrajectoryHasAColumnPerBodyAndQuantity) {
  const TemporaryFolder folder;
  const std::string path = folder / "four_bar.csv";
  EXPECT_EQ(cdot_run(fmt::format("simulate {} --until 0.01 --step 0.001 -o '{}'", scene("four_bar"), path)).status, 0);
  const auto rows = csv(path);
  ASSERT_EQ(rows.size(), 12u);  // header, start, ten steps
  ASSERT_EQ(rows[0].size(), 19u);
  EXPECT_EQ(rows[0][0], "time");
  const std::vector<std::string> first(rows[0].begin() + 1, rows[0].begin() + 7);
  EXPECT_EQ(first, (std::vector<std::string>{"v0.x", "v0.y", "v0.angle", "v0.vx", "v0.vy", "v0.omega"}));
  EXPECT_EQ(rows[0][7], "h0.x");
  EXPECT_EQ(std::stod(rows[1][0]), 0);
  EXPECT_EQ(std::stod(rows[1][6]), -1);
  EXPECT_DOUBLE_EQ(std::stod(rows[11][0]), 0.01);
  EXPECT_EQ(folder.contents(), std::vector<std::string>{"four_bar.csv"});
}

// Rows at requested times equal the run's steps at common times and lie on its path between them.
TEST(Command, RowTimesDoNotChangeTheRun) {
  const TemporaryFolder folder;
  const std::string steps = folder / "steps.csv", every = folder / "every.csv", times = folder / "times.csv";
  const std::string simulate = fmt::format("simulate {} --until 0.5 --step 0.001 ", scene("double_pendulum"));
  ASSERT_EQ(cdot_run(simulate + "-o '" + steps + "'").status, 0);
  ASSERT_EQ(cdot_run(simulate + "--every 0.1 -o '" + every + "'").status, 0);
  ASSERT_EQ(cdot_run(simulate + "--times 0.25,0.10025,0.5 -o '" + times + "'").status, 0);
  const auto all = csv(steps), tenths = csv(every), asked = csv(times);
  ASSERT_EQ(all.size(), 502u);
  ASSERT_EQ(tenths.size(), 7u);
  for (std::size_t k = 1; k < tenths.size(); ++k) {
    const std::size_t same = 1 + 100 * (k - 1);
    EXPECT_TRUE(std::equal(tenths[k].begin() + 1, tenths[k].end(), all[same].begin() + 1)) << k;
  }
  ASSERT_EQ(asked.size(), 4u);
  EXPECT_EQ(asked[1][0], "0.10025");
  EXPECT_EQ(asked[2][0], "0.25");
  const double before = std::stod(all[101][1]), after = std::stod(all[102][1]), between = std::stod(asked[1][1]);
  EXPECT_NEAR(between, 0.75 * before + 0.25 * after, 1e-6);
  EXPECT_EQ(cdot_run(simulate + "--every 0.1 --times 1").status, 2);
}

TEST(Command, SameInputSameBytes) {
  const TemporaryFolder folder;
  const std::string one = folder / "one.csv", two = folder / "two.csv";
  cdot_run(fmt::format("simulate {} --until 0.5 -o '{}'", scene("slider_crank"), one));
  cdot_run(fmt::format("simulate {} --until 0.5 -o '{}'", scene("slider_crank"), two));
  EXPECT_GT(read_text(one).size(), 1000u);
  EXPECT_EQ(read_text(one), read_text(two));
}

TEST(Command, NoHalfWrittenFiles) {
  const TemporaryFolder folder;
  const std::string missing = folder / "no_such_folder/run.csv";
  EXPECT_EQ(cdot_run(fmt::format("simulate {} --until 0.1 -o '{}'", scene("four_bar"), missing)).status, 2);
  // While a method is chosen nothing is computed yet: the old file stays, and no part of a new one.
  const std::string path = folder / "run.csv";
  std::ofstream(path) << "old\n";
  const CommandResult result =
      run_command(fmt::format("timeout --preserve-status -s INT 0.5 '{}' simulate {} --until 100000 -o '{}'", CDOT_RUN,
                              scene("four_bar"), path));
  EXPECT_EQ(result.status, 130);
  EXPECT_NE(result.err.find("while a method was chosen: nothing was written"), std::string::npos) << result.err;
  EXPECT_EQ(read_text(path), "old\n");
  EXPECT_EQ(folder.contents(), std::vector<std::string>{"run.csv"});
}

// Ctrl-C: the rows, the page and the state up to there are complete, and the state continues the run.
TEST(Command, AnInterruptedRunKeepsWhatItComputed) {
  const TemporaryFolder folder;
  const std::string csv_path = folder / "run.csv", state = folder / "run.state", page = folder / "run.html";
  const std::string run = fmt::format("simulate {} --integrator rk4 --step 0.001 --every 0.5", scene("four_bar"));
  const auto stopped_after = [&](double seconds) {
    return run_command(
        fmt::format("timeout --preserve-status -s INT {} '{}' {} --until 100000 -o '{}' --save-state '{}' --html '{}'",
                    seconds, CDOT_RUN, run, csv_path, state, page));
  };
  CommandResult stopped = stopped_after(0.5);
  // On a loaded machine that may be before its first second.
  for (double seconds = 1; seconds < 30 && csv(csv_path).size() < 3; seconds *= 2) stopped = stopped_after(seconds);
  EXPECT_EQ(stopped.status, 130) << stopped.err;
  EXPECT_NE(stopped.err.find("interrupted: the run and its outputs end at t = "), std::string::npos) << stopped.err;
  EXPECT_NE(stopped.err.find("--from-state " + state + " continues"), std::string::npos) << stopped.err;
  EXPECT_NE(stopped.out.find("energy"), std::string::npos);
  const auto rows = csv(csv_path);
  ASSERT_GE(rows.size(), 3u);
  EXPECT_EQ(rows.back().size(), rows.front().size());
  EXPECT_TRUE(read_text(page).find("</html>") != std::string::npos);
  const double end = Snapshot::read(read_text(state)).time();
  EXPECT_GE(end, std::stod(rows.back()[0]) - 1e-9);

  const std::string further = folder / "further.csv", whole = folder / "whole.csv";
  const std::string until = fmt::format(" --until {}", end + 1);
  EXPECT_EQ(cdot_run(run + until + fmt::format(" --from-state '{}' -o '{}'", state, further)).status, 0);
  EXPECT_EQ(cdot_run(run + until + fmt::format(" -o '{}'", whole)).status, 0);
  EXPECT_EQ(csv(further).back(), csv(whole).back()) << "an interruption changes bits";
}

// Numbers of all rows except the header.
std::vector<double> numbers_of(const std::filesystem::path& path) {
  std::vector<double> numbers;
  const auto rows = csv(path);
  for (std::size_t k = 1; k < rows.size(); ++k)
    for (const std::string& cell : rows[k]) numbers.push_back(std::stod(cell));
  return numbers;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double worst = 0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) worst = std::max(worst, std::abs(a[k] - b[k]));
  return worst;
}

// "-" is standard output, and the summary makes room for it. The text is that of a file.
TEST(Command, AnOutputCalledDashIsStandardOutput) {
  const TemporaryFolder folder;
  for (const char* option : {"-o", "--html", "--svg", "--save-state"}) {
    const std::string run = "simulate " + scene("four_bar") + " --until 0.1 ", file = folder / "output";
    const CommandResult to_file = cdot_run(run + option + " '" + file + "'");
    const CommandResult to_stdout = cdot_run(run + option + " -");
    ASSERT_EQ(to_file.status, 0) << to_file.err;
    ASSERT_EQ(to_stdout.status, 0) << to_stdout.err;
    EXPECT_EQ(to_stdout.out, read_text(file)) << option;
    EXPECT_NE(to_file.out.find("worst |C|"), std::string::npos);
    EXPECT_NE(to_stdout.err.find("worst |C|"), std::string::npos) << to_stdout.err;
    EXPECT_FALSE(std::filesystem::exists("-"));
  }
  const CommandResult picture = cdot_run("diagnose " + scene("four_bar") + " --matrix --svg -");
  EXPECT_EQ(picture.status, 0) << picture.err;
  EXPECT_EQ(picture.out.substr(0, 4), "<svg");
  EXPECT_NE(picture.err.find("D v = 0"), std::string::npos) << picture.err;
  const CommandResult two = cdot_run("simulate " + scene("four_bar") + " -o - --svg -");
  EXPECT_EQ(two.status, 2);
  EXPECT_NE(two.err.find("2 outputs cannot share standard output"), std::string::npos) << two.err;
  const CommandResult full =
      run_command(fmt::format("({} simulate {} --until 0.1 -o - >/dev/full)", CDOT_RUN, scene("four_bar")));
  EXPECT_EQ(full.status, 2);
  EXPECT_NE(full.err.find("standard output: cannot be written"), std::string::npos) << full.err;
}

// In float every number is a float, and the motion equals that in double up to float's round-off.
TEST(Command, PrecisionIsFloatIfAsked) {
  const TemporaryFolder folder;
  for (const char* name : {"double_pendulum", "spatial/double_pendulum"}) {
    const auto run = [&](const std::string& precision) {
      const std::string path = folder / (precision + ".csv");
      const CommandResult result =
          cdot_run(fmt::format("simulate {} --integrator rk4 --until 1 --step 0.0078125 -o '{}' --precision {}",
                               scene(name), path, precision));
      EXPECT_EQ(result.status, 0) << result.err;
      EXPECT_EQ(result.err, "");
      EXPECT_EQ(result.out.find("precision       float") != std::string::npos, precision == "float") << result.out;
      return numbers_of(path);
    };
    const std::vector<double> single = run("float"), exact = run("double");
    ASSERT_FALSE(single.empty());
    for (const double number : single) EXPECT_EQ(number, double(float(number)));
    const double apart = largest_difference(single, exact);
    fmt::print("  {}: float is {:.1e} off\n", name, apart);
    EXPECT_GT(apart, 1e-7);
    EXPECT_LT(apart, 1e-3);
  }
  // The scene's own key, and JSON.
  const std::string path = folder / "single.toml";
  write_file(path, "precision = \"float\"\nduration = 0.1\n[[body]]\nname = \"ball\"\nmass = 1\ninertia = 1\n");
  EXPECT_EQ(nlohmann::json::parse(cdot_run("simulate '" + path + "' --json").out)["precision"], "float");
  EXPECT_EQ(cdot_run("simulate '" + path + "' --precision half").status, 2);
  EXPECT_EQ(cdot_run("simulate '" + path + "' --accuracy 1e-4 --precision float").status, 2);
}

TEST(Command, KernelsAreThoseAskedFor) {
  const TemporaryFolder folder;
  const auto run = [&](const std::string& kernels) {
    const std::string path = folder / (kernels + ".csv");
    EXPECT_EQ(cdot_run(fmt::format("simulate {} --solver iterative --until 0.5 -o '{}' --kernels {}",
                                   scene("spatial/double_pendulum"), path, kernels))
                  .status,
              0);
    return numbers_of(path);
  };
  const std::vector<double> balanced = run("balanced"), robust = run("robust");
  const double apart = largest_difference(balanced, robust);
  fmt::print("  robust is {:.1e} from balanced\n", apart);
  EXPECT_GT(apart, 0);
  EXPECT_LT(apart, 1e-9);
  EXPECT_EQ(cdot_run("simulate " + scene("spatial/double_pendulum") + " --kernels best").status, 2);
}

}  // namespace
}  // namespace cdot::test::command_test
