// Ctrl-C.
#include "runtime/tool/run/process.hpp"

#include <chrono>
#include <csignal>
#include <gtest/gtest.h>
#include <thread>

namespace cdot::test {
namespace {

// `timeout -s INT` sends two signals for one.
TEST(Interrupt, IsOneIfItIsSentTwiceAtOnce) {
  const Interrupt interrupt;
  EXPECT_FALSE(Interrupt::asked());
  std::raise(SIGINT), std::raise(SIGINT);
  EXPECT_TRUE(Interrupt::asked());
}

TEST(Interrupt, EndsTheProgramTheSecondTime) {
  const auto twice = [] {
    const Interrupt interrupt;
    std::raise(SIGINT);
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    std::raise(SIGINT);
  };
  EXPECT_EXIT(twice(), testing::KilledBySignal(SIGINT), "");
}

}  // namespace
}  // namespace cdot::test
