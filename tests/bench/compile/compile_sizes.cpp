// The time of a step of chains of 10 to 160 links by Runge-Kutta 4, compiled and in the World, by turns; medians.
#include <fmt/format.h>
#include <vector>

#include <cdot/world.hpp>

#include "chain_of_10.hpp"
#include "chain_of_160.hpp"
#include "chain_of_20.hpp"
#include "chain_of_40.hpp"
#include "chain_of_80.hpp"
#include "runtime/tool/scene/scene.hpp"
#include "tests/bench/compile/clock.hpp"

namespace {

using cdot::bench::cpu_now;
using cdot::bench::median;

constexpr int turns = 21, steps = 40;
constexpr double step = 1e-4;  // [s]

template <class Chain>
void compare(int links) {
  auto world = cdot::build_world<double>(cdot::read_scene(fmt::format("{}/chain_{}.toml", CDOT_SCENES, links)));
  world.prepare();
  static typename Chain::State state;
  Chain::reset(state);
  std::vector<double> compiled, in_world, ratio;
  for (int turn = 0; turn < turns; ++turn) {
    const double start = cpu_now();
    for (int k = 0; k < steps; ++k) Chain::step(state, step);
    const double middle = cpu_now();
    for (int k = 0; k < steps; ++k)
      if (!world.step(step)) return fmt::print("{} links: the World's step failed\n", links);
    const double end = cpu_now();
    compiled.push_back((middle - start) / steps), in_world.push_back((end - middle) / steps);
    ratio.push_back(in_world.back() / compiled.back());
  }
  fmt::print("| {} | {:.1f} | {:.1f} | {:.2f} |\n", int(Chain::rows), 1e6 * median(compiled), 1e6 * median(in_world),
             median(ratio));
}

}  // namespace

int main() {
  using namespace cdot::scenes;
  fmt::print("| rows | compiled [us] | World [us] | World / compiled |\n|---|---|---|---|\n");
  compare<chain_of_10<double>>(10);
  compare<chain_of_20<double>>(20);
  compare<chain_of_40<double>>(40);
  compare<chain_of_80<double>>(80);
  compare<chain_of_160<double>>(160);
}
