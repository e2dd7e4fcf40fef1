// The time of one step of 1 ms alone and in each of 8 lanes, by whatever compiler and options the script `lanes` is
// given: the least of 200 runs.
#include <algorithm>
#include <chrono>
#include <cstdio>

#include <cdot/pack.hpp>

#include "chain_10_baumgarte.hpp"
#include "chain_10_euler.hpp"
#include "chain_10_rk4.hpp"
#include "slider_crank_baumgarte.hpp"
#include "slider_crank_euler.hpp"
#include "slider_crank_rk4.hpp"

namespace {

// Nanoseconds.
template <class Compiled>
[[gnu::noinline]] double time_of_step() {
  constexpr int steps = 1000;
  typename Compiled::State machine;
  Compiled::reset(machine);
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < steps; ++i) {
    Compiled::step(machine, 0.001);
    asm volatile("" : : "r"(&machine) : "memory");
  }
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count() / steps;
}

template <template <class> class Compiled>
void compare(const char* name) {
  double alone = 1e9, together = 1e9;
  for (int k = 0; k < 200; ++k) {
    alone = std::min(alone, time_of_step<Compiled<double>>());
    together = std::min(together, time_of_step<Compiled<cdot::Pack<double, 8>>>());
  }
  std::printf("%-24s %7.0f %7.1f %6.1f\n", name, alone, together / 8, 8 * alone / together);
}

}  // namespace

int main() {
  using namespace cdot::scenes;
  std::printf("%-24s %7s %7s %6s\n", "[ns]", "alone", "a lane", "ratio");
  compare<slider_crank_euler>("slider_crank euler");
  compare<slider_crank_baumgarte>("slider_crank baumgarte");
  compare<slider_crank_rk4>("slider_crank rk4");
  compare<chain_10_euler>("chain_10 euler");
  compare<chain_10_baumgarte>("chain_10 baumgarte");
  compare<chain_10_rk4>("chain_10 rk4");
}
