// The time of a step of chains by Dormand-Prince 8, compiled and by hand in minimal coordinates, by turns; medians.
#include <cmath>
#include <fmt/format.h>
#include <vector>

#include <cdot/pack.hpp>

#include "chain_by_dop853_10.hpp"
#include "chain_by_dop853_2.hpp"
#include "chain_by_dop853_3.hpp"
#include "chain_by_dop853_4.hpp"
#include "tests/bench/compile/chain_by_hand.hpp"
#include "tests/bench/compile/clock.hpp"
#include "tests/bench/peers/geometry.hpp"

namespace {

using cdot::bench::cpu_now;
using cdot::bench::median;

using namespace cdot::scenes;

constexpr int turns = 201;
constexpr double until = 2, rates[] = {16, 32, 64};  // [s], steps in a second

// The chain as the scene has it at its start: uniform rods of 1 m and 1 kg (chain.toml.in).
template <class Scene>
cdot::peers::Problem problem_of() {
  cdot::peers::Problem problem;
  problem.gravity = {0, -9.81, 0};
  typename Scene::State start;
  Scene::reset(start);
  for (const auto& q : start.q) {
    cdot::peers::Body& body = problem.bodies.emplace_back();
    body.mass = 1, body.inertia[2] = 1.0 / 12;
    body.start.x = {q.x, q.y, 0}, body.start.q = cdot::peers::about_z(q.angle);
    problem.joints.emplace_back().anchor = {q.x - 0.5 * q.c, q.y - 0.5 * q.s, 0};
  }
  return problem;
}

// Of n steps, in ns each.
template <class Step>
double time_of(int n, Step step) {
  const double start = cpu_now();
  for (int k = 0; k < n; ++k) step();
  return 1e9 * (cpu_now() - start) / n;
}

template <template <class> class Scene>
void compare() {
  using Alone = Scene<double>;
  using Lanes = Scene<cdot::Pack<double, 8>>;
  constexpr int links = Alone::bodies;
  const cdot::peers::Problem problem = problem_of<Alone>();
  for (const double rate : rates) {
    const int n = int(until * rate);
    std::vector<double> alone, of_lanes, by_hand;
    double apart = 0;
    for (int turn = 0; turn < turns; ++turn) {
      const auto hand = chain_by_hand(problem, 1 / rate);
      static typename Alone::State state;
      static typename Lanes::State lanes;
      Alone::reset(state), Lanes::reset(lanes);
      by_hand.push_back(time_of(n, [&] { hand->step(1 / rate); }));
      alone.push_back(time_of(n, [&] { Alone::step(state, 1 / rate); }));
      of_lanes.push_back(time_of(n, [&] { Lanes::step(lanes, 1 / rate); }) / 8);
      apart = std::abs(hand->state(links - 1).x[1] - state.q[links - 1].y);
    }
    const double mine = median(alone), limit = median(by_hand);
    fmt::print("| {} | {} | {:.0f} | {:.0f} | {:.0f} | {:.2f} | {:.0e} |\n", links, rate, mine, median(of_lanes), limit,
               mine / limit, apart);
  }
}

}  // namespace

int main() {
  fmt::print(
      "| links | steps in a second | compiled [ns] | each of 8 lanes | by hand | compiled / by hand | ends apart [m] "
      "|\n|---|---|---|---|---|---|---|\n");
  compare<chain_by_dop853_2>();
  compare<chain_by_dop853_3>();
  compare<chain_by_dop853_4>();
  compare<chain_by_dop853_10>();
}
