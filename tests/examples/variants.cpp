// A batch of variants: a scene compiled to its own step, eight at a time in the lanes of a pack. It finds how fast a
// pendulum must start to go over the top, by eight guesses at a time.
#include <cmath>
#include <cstdio>

#include <cdot/pack.hpp>

#include "simple_pendulum.hpp"

namespace {

constexpr int lanes = 8;
using Lane = cdot::Pack<double, lanes>;
using Pendulum = cdot::scenes::simple_pendulum<Lane>;

// The first lane that goes over the top when lane k starts upwards at `from` + k `apart` [m/s]; `lanes` if none does.
int first_over(double from, double apart) {
  Pendulum::State state;
  Pendulum::reset(state);
  for (int k = 0; k < lanes; ++k) state.v[Pendulum::bob].y.set(k, from + k * apart);
  Pendulum::begin(state);
  bool over[lanes] = {}, fell[lanes] = {};
  for (int step = 0; step < 4000; ++step) {
    Pendulum::step(state);
    for (int k = 0; k < lanes; ++k) {
      const double x = state.q[Pendulum::bob].x[k], y = state.q[Pendulum::bob].y[k];
      fell[k] |= y < -0.5;
      over[k] |= x < 0 && y > 0 && !fell[k];
    }
  }
  int first = 0;
  while (first < lanes && !over[first]) ++first;
  return first;
}

}  // namespace

int main() {
  double too_slow = 0, fast_enough = 9;
  for (int round = 0; round < 6; ++round) {
    const double apart = (fast_enough - too_slow) / (lanes + 1);
    const int first = first_over(too_slow + apart, apart);
    fast_enough = too_slow + (first + 1) * apart;
    too_slow = fast_enough - apart;
  }
  const double exact = std::sqrt(2 * 9.81 * 1);  // m v^2 / 2 = m g l
  std::printf("over the top from %.6f m/s on; exactly %.6f\n", fast_enough, exact);
  return std::fabs(fast_enough - exact) < 1e-4 ? 0 : 1;
}
