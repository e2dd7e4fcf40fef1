// A task, and a command, that take longer than a second tell their stage on a terminal: here a pseudo-terminal, read
// until the stage appears.
#include "runtime/text/stage.hpp"

#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "derive/pipeline/process_pool.hpp"
#include "runtime/command_line/waiting.hpp"

namespace cdot::derive {
namespace {

namespace fs = std::filesystem;

// Runs this in a child whose standard error is a terminal, until it shows the words; then lets it end.
std::string shown_by(const std::string& words, const std::function<void(const std::function<void()>&)>& run) {
  const fs::path released = fs::path(testing::TempDir()) / ("cdot_stage_" + std::to_string(getpid()));
  fs::remove(released);
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child == 0) {
    run([&] {
      constexpr int patience = 800;  // of a test that fails
      for (int i = 0; i < patience && !fs::exists(released); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    });
    _exit(0);
  }
  std::string shown;
  char buffer[256];
  bool seen = false;
  for (ssize_t n = 0; (n = read(terminal, buffer, sizeof buffer)) > 0;) {
    shown.append(buffer, static_cast<std::size_t>(n));
    if (seen || shown.find(words) == shown.npos) continue;
    seen = true;
    std::ofstream(released) << "go";
  }
  waitpid(child, nullptr, 0);
  close(terminal);
  fs::remove(released);
  return shown;
}

TEST(Stage, OfATaskIsShown) {
  const std::string shown = shown_by("hinge: proving (1 s)", [](const auto& until_released) {
    Tasks tasks{{"line", "hinge"}, {}, {}, {}};
    tasks.run = [&](std::size_t i) -> std::string {
      if (i == 0) return "";
      const text::Stage outer("deriving"), inner("proving");
      until_released();
      return "";
    };
    tasks.take = [](std::size_t, const Answer&) {};
    in_processes(tasks, 2);
  });
  EXPECT_NE(shown.find("[1 of 2] hinge: proving (1 s)"), std::string::npos) << shown;
}

TEST(Stage, OfACommandIsShown) {
  const std::string shown = shown_by("cdot emit hinge: simplifying", [](const auto& until_released) {
    const command_line::Waiting waiting("cdot emit hinge");
    const text::Stage stage("simplifying");
    until_released();
  });
  EXPECT_NE(shown.find("\r\033[Kcdot emit hinge: simplifying (1 s)"), std::string::npos) << shown;
  EXPECT_TRUE(shown.ends_with("\r\033[K")) << shown;  // and cleared
}

TEST(Stage, EndsWithItsScope) {
  const auto now = [] { return text::place_of_stage()->load(); };
  EXPECT_EQ(now(), nullptr);
  {
    const text::Stage outer("deriving");
    {
      const text::Stage inner("proving");
      EXPECT_STREQ(now(), "proving");
    }
    EXPECT_STREQ(now(), "deriving");
  }
  EXPECT_EQ(now(), nullptr);
}

}  // namespace
}  // namespace cdot::derive
