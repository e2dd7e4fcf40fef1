// The time of one step of 1 ms: compiled, alone and in 4 and 8 lanes, beside the World. `per_lane` is the time of one
// mechanism. Repeat it (--benchmark_repetitions) to see the noise of the machine.
#include <array>
#include <benchmark/benchmark.h>
#include <utility>

#include <cdot/pack.hpp>
#include <cdot/world.hpp>

#include "chain_10_baumgarte_euler.hpp"
#include "chain_10_euler.hpp"
#include "chain_10_rattle.hpp"
#include "chain_10_rk4.hpp"
#include "chain_10_space_euler.hpp"
#include "chain_10_space_rattle.hpp"
#include "chain_10_space_rk4.hpp"
#include "four_bar_space_euler.hpp"
#include "four_bar_space_rattle.hpp"
#include "four_bar_space_rk4.hpp"
#include "machine_euler.hpp"
#include "robot_arm_euler.hpp"
#include "runtime/tool/scene/scene.hpp"
#include "slider_crank_baumgarte_euler.hpp"
#include "slider_crank_euler.hpp"
#include "slider_crank_rattle.hpp"
#include "slider_crank_rk4.hpp"
#include "tailgate_euler.hpp"
#include "tailgate_rk4.hpp"

namespace {

constexpr int steps_of_a_run = 1000;  // then from the start again
constexpr double step = 0.001;        // [s]

void count_lanes(benchmark::State& state, int lanes) {
  state.counters["per_lane"] =
      benchmark::Counter(lanes, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

template <class Space>
void run_world(benchmark::State& state, const std::string& name, cdot::Integrator integrator, cdot::Drift drift) {
  cdot::Scene scene = cdot::read_scene(std::string(CDOT_SOURCE_DIR) + "/specs/scenes/" + name + ".toml");
  scene.settings.integrator = integrator;
  scene.drift = drift;
  scene.accuracy = 0;
  cdot::settle_drift(scene);
  auto world = cdot::build_world_in<Space>(scene);
  const cdot::Snapshot start = world.snapshot();
  int steps = 0;
  for (auto _ : state) {
    if (++steps % steps_of_a_run == 0) world.restore(start);
    benchmark::DoNotOptimize(world.step(step));
  }
  count_lanes(state, 1);
}

template <class Compiled, int lanes>
void run_compiled(benchmark::State& state) {
  typename Compiled::State machine;
  Compiled::reset(machine);
  int steps = 0;
  for (auto _ : state) {
    if (++steps % steps_of_a_run == 0) Compiled::reset(machine);
    benchmark::DoNotOptimize(Compiled::step(machine, step));
  }
  count_lanes(state, lanes);
}

void run_in_plane(benchmark::State& state, const std::string& name, cdot::Integrator integrator) {
  run_world<cdot::Planar<double>>(state, name, integrator, cdot::Drift::projection);
}
void run_in_space(benchmark::State& state, const std::string& name, cdot::Integrator integrator) {
  run_world<cdot::Spatial<double>>(state, "spatial/" + name, integrator, cdot::Drift::projection);
}
void run_by_baumgarte(benchmark::State& state, const std::string& name, cdot::Integrator integrator) {
  run_world<cdot::Planar<double>>(state, name, integrator, cdot::Drift::baumgarte);
}

// Independent products and sums, or divisions: the most that a lane can gain.
template <class T, int lanes, class F>
void run_limit(benchmark::State& state, F f) {
  std::array<T, 16> x;
  for (int i = 0; i < 16; ++i) x[i] = T(1 + 0.01 * i);
  const auto each = [&]<std::size_t... i>(std::array<T, 16> & of, std::index_sequence<i...>) {
    ((of[i] = f(of[i])), ...);
  };
  for (auto _ : state) {
    std::array<T, 16> now = x;
    for (int k = 0; k < 64; ++k) each(now, std::make_index_sequence<16>{});
    benchmark::DoNotOptimize(x = now);
  }
  count_lanes(state, lanes);
}
template <class T, int lanes>
void run_products(benchmark::State& state) {
  run_limit<T, lanes>(state, [](const T& x) { return x * T(0.999) + T(0.001); });
}
template <class T, int lanes>
void run_divisions(benchmark::State& state) {
  run_limit<T, lanes>(state, [](const T& x) { return T(1) / x; });
}

#define CDOT_COMPARE(scene, method) CDOT_COMPARE_WITH(run_in_plane, #scene, scene, method)
#define CDOT_COMPARE_IN_SPACE(scene, method) CDOT_COMPARE_WITH(run_in_space, #scene, scene##_space, method)
#define CDOT_COMPARE_OPEN(scene) CDOT_COMPARE_WITH(run_by_baumgarte, #scene, scene##_baumgarte, euler)
#define CDOT_COMPARE_WITH(world, file, scene, method)                                                               \
  BENCHMARK_CAPTURE(world, scene##_##method, file, cdot::Integrator::method);                                       \
  BENCHMARK(run_compiled<cdot::scenes::scene##_##method<double>, 1>)->Name(#scene "_" #method "/1");                \
  BENCHMARK(run_compiled<cdot::scenes::scene##_##method<cdot::Pack<double, 4>>, 4>)->Name(#scene "_" #method "/4"); \
  BENCHMARK(run_compiled<cdot::scenes::scene##_##method<cdot::Pack<double, 8>>, 8>)->Name(#scene "_" #method "/8");

#define CDOT_LIMIT(part)                                             \
  BENCHMARK(run_##part<double, 1>)->Name(#part "/1");                \
  BENCHMARK(run_##part<cdot::Pack<double, 4>, 4>)->Name(#part "/4"); \
  BENCHMARK(run_##part<cdot::Pack<double, 8>, 8>)->Name(#part "/8");

CDOT_LIMIT(products)
CDOT_LIMIT(divisions)
CDOT_COMPARE(chain_10, euler)
CDOT_COMPARE(chain_10, rk4)
CDOT_COMPARE(chain_10, rattle)
CDOT_COMPARE(slider_crank, euler)
CDOT_COMPARE(slider_crank, rattle)
CDOT_COMPARE(slider_crank, rk4)
CDOT_COMPARE(tailgate, euler)  // a joint and two effects by forces
CDOT_COMPARE(tailgate, rk4)
CDOT_COMPARE(robot_arm, euler)  // three joints, two servos, a brake
CDOT_COMPARE(machine, euler)    // 18 rows of joints, a motor
CDOT_COMPARE_OPEN(chain_10)
CDOT_COMPARE_OPEN(slider_crank)
CDOT_COMPARE_IN_SPACE(chain_10, euler)
CDOT_COMPARE_IN_SPACE(chain_10, rattle)
CDOT_COMPARE_IN_SPACE(chain_10, rk4)
CDOT_COMPARE_IN_SPACE(four_bar, euler)  // 20 rows of rank 17
CDOT_COMPARE_IN_SPACE(four_bar, rattle)
CDOT_COMPARE_IN_SPACE(four_bar, rk4)

}  // namespace

BENCHMARK_MAIN();
