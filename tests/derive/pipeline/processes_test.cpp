// `cdot derive` in several processes: the same bytes for every number of them, and a report of a process that died.
#include <csignal>
#include <thread>

#include "derive/pipeline/process_pool.hpp"
#include "tests/derive/commands/command.hpp"

namespace {

using namespace std::chrono_literals;
using cdot::derive::Answer;
using cdot::derive::in_processes;
using cdot::derive::Tasks;

TEST(Processes, HandOverInOrderWhateverIsDoneFirst) {
  for (const int processes : {1, 2, 5, 40}) {
    Tasks tasks;
    for (int i = 0; i < 12; ++i) tasks.names.push_back("task " + std::to_string(i));
    for (std::size_t i = 12; i-- > 0;) tasks.order.push_back(i);
    tasks.run = [](std::size_t i) {
      std::this_thread::sleep_for(i % 3 * 10ms);
      return std::string(i * 30000, static_cast<char>('a' + i));  // more than a pipe's buffer
    };
    std::size_t next = 0;
    tasks.take = [&](std::size_t i, const Answer& answer) {
      EXPECT_EQ(i, next++);
      EXPECT_EQ(answer.result, std::string(i * 30000, static_cast<char>('a' + i)));
      EXPECT_EQ(answer.failure, "");
    };
    in_processes(tasks, processes);
    EXPECT_EQ(next, 12u);
  }
}

TEST(Processes, TellWhyThereIsNoResult) {
  Tasks tasks;
  tasks.names = {"throws", "is killed", "leaves", "is well"};
  tasks.run = [](std::size_t i) -> std::string {
    if (i == 0) throw std::runtime_error("no luck");
    if (i == 1) raise(SIGKILL);
    if (i == 2) _exit(3);
    return "well";
  };
  std::string told;
  tasks.take = [&](std::size_t i, const Answer& a) { told += tasks.names[i] + ": " + a.failure + a.result + "\n"; };
  in_processes(tasks, 2);
  EXPECT_EQ(told,
            "throws: failed: no luck\nis killed: killed by signal 9 (Killed)\nleaves: ended without a word\n"
            "is well: well\n");
}

// A shell may start something in the background and then become this program.
TEST(Processes, LeaveChildrenOfOthersAlone) {
  ASSERT_GE(fork() == 0 ? (_exit(7), 0) : 0, 0);
  std::this_thread::sleep_for(20ms);
  Tasks tasks;
  tasks.names = {"slow", "quick"};
  tasks.run = [](std::size_t i) { return std::this_thread::sleep_for(i == 0 ? 50ms : 0ms), std::string("well"); };
  int well = 0;
  tasks.take = [&](std::size_t, const Answer& answer) { well += answer.result == "well" ? 1 : 0; };
  in_processes(tasks, 2);
  EXPECT_EQ(well, 2);
}

class DeriveAtOnce : public Derive {
 protected:
  // Waits for children of a process and returns them.
  static std::string children_of(const std::string& process) {
    for (int i = 0; i < 500; ++i, std::this_thread::sleep_for(10ms)) {
      const std::string children = content_of("/proc/" + process + "/task/" + process + "/children");
      if (!children.empty()) return children;
    }
    return "";
  }
  // Starts in the background, where a shell ignores Ctrl-C, on a spec that takes seconds; the output goes to `said`.
  std::string begin() const {
    fs::copy(fs::path(CDOT_SOURCE_DIR "/specs") / "spatial", place_ / "specs/spatial");
    const std::string started = run("env --default-signal=INT " CDOT " derive screw line >said 2>&1 & echo $!").text;
    return started.substr(0, started.find('\n'));
  }
  static bool ends(const std::string& process) {
    const auto state = [&] {
      const std::string stat = content_of("/proc/" + process + "/stat");
      return stat.empty() ? 'X' : stat[stat.rfind(')') + 2];
    };
    for (int i = 0; i < 500; ++i, std::this_thread::sleep_for(10ms)) {
      if (state() == 'X' || state() == 'Z') return true;
    }
    return false;
  }
};

TEST_F(DeriveAtOnce, TheSameBytesHoweverManyAtOnce) {
  for (const char* spec : {"angle.hand", "gear.joint", "gear.hand", "motor.joint", "target.joint"}) {
    take("planar/" + std::string(spec));
  }
  const ShellResult one = cdot("derive --fresh -j 1");
  const auto right = files("generated");
  EXPECT_EQ(one.status, 0) << one.text;
  for (const std::string jobs : {"3", "20"}) {
    fs::remove_all(place_ / "generated");
    EXPECT_EQ(cdot("derive --fresh -j " + jobs).text, one.text);
    EXPECT_EQ(files("generated"), right);
  }
  // Errors appear in the same order too.
  write("specs/planar/bad.joint", "joint bad planar\n  \"x\"\n  point pa on a\n  norm(pb) = 0\n");
  write("specs/planar/wrong.joint", "joint wrong planar\n  \"x\"\n  angle(a) + angle(b) = 0\n");
  EXPECT_EQ(cdot("derive --fresh -j 3").text, cdot("derive --fresh -j 1").text);
  EXPECT_EQ(files("generated"), right);
  EXPECT_EQ(cdot("derive -j 0").status, 2);
}

TEST_F(DeriveAtOnce, SaysWhichSpecsProcessWasKilled) {
  const std::string process = begin();
  const std::string children = children_of(process);
  ASSERT_NE(children, "");
  ASSERT_EQ(kill(std::stoi(children), SIGKILL), 0);  // the first child: the first spec
  ASSERT_TRUE(ends(process));
  EXPECT_NE(read("said").find("specs/spatial/screw.joint: killed by signal 9 (Killed)\nnothing was written"),
            std::string::npos)
      << read("said");
  EXPECT_TRUE(files("generated").empty());
}

TEST_F(DeriveAtOnce, LeavesNoProcessBehind) {
  for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
    fs::remove_all(place_ / "specs/spatial");
    const std::string process = begin(), children = children_of(process);
    ASSERT_NE(children, "");
    ASSERT_EQ(kill(std::stoi(process), signal), 0);
    std::istringstream all(children);
    for (std::string child; all >> child;) EXPECT_TRUE(ends(child)) << signal;
  }
}

TEST_F(DeriveAtOnce, ShowsOnATerminalHowFarItIs) {
  EXPECT_EQ(cdot("derive").text.find("of 2]"), std::string::npos);
  const std::string shown = run("script -qec '" CDOT " derive --fresh' /dev/null").text;
  const bool line_is_last = shown.find("[1 of 2] specs/planar/line.joint") != std::string::npos;
  const bool angle_is_last = shown.find("[1 of 2] specs/planar/angle.joint") != std::string::npos;
  EXPECT_NE(line_is_last, angle_is_last) << shown;
}

}  // namespace
