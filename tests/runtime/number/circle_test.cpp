// Circles of walks with tails and circles of many lengths, beside the lengths that they were made of.
#include "runtime/number/circle.hpp"

#include <gtest/gtest.h>
#include <vector>

namespace cdot::test::circle_test {
namespace {

// The states 0, 1, ..., tail + length - 1, tail, tail + 1, ...
std::vector<char> state_after(int steps, int tail, int length) {
  const int place = steps < tail ? steps : tail + (steps - tail) % length;
  return {static_cast<char>(place % 7), static_cast<char>(place / 7), 1};
}

TEST(Circle, IsSeenAtItsLengthAfterAnyTail) {
  for (const int tail : {0, 1, 2, 5, 17})
    for (const int length : {1, 2, 3, 4, 7, 30}) {
      Circle circle;
      circle.reserve(3);
      circle.begin(state_after(0, tail, length));
      int steps = 0, seen = 0;
      while (seen == 0 && steps < 500) seen = circle.closes(state_after(++steps, tail, length));
      EXPECT_EQ(seen, length) << tail;
      EXPECT_GE(steps, tail + length) << "seen before it was walked";
      EXPECT_LE(steps, 3 * (tail + length) + 1);
    }
}

}  // namespace
}  // namespace cdot::test::circle_test
