// A run under the watch of its balance.
#pragma once

#include <cmath>
#include <gtest/gtest.h>

#include <cdot/world.hpp>

#include "tests/runtime/balance/method.hpp"

namespace cdot::test {

// The share that a method may leave at h = 1e-3 of a motion of about one unit per second, by its order.
inline double allowed(const Method& method) { return method.order() == 1 ? 4e-3 : method.order() == 2 ? 3e-5 : 1e-6; }

template <class S>
BalanceWatch watch(BasicWorld<S>& world, double duration, double h) {
  BalanceWatch watch;
  watch.look(world.balance());
  const long steps = std::lround(duration / h);
  for (long i = 0; i < steps; ++i) {
    EXPECT_TRUE(world.step(h));
    watch.look(world.balance());
  }
  return watch;
}

}  // namespace cdot::test
