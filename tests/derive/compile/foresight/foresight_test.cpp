// The corrections of compiled steps are foreseen by those before: fewer rounds, where the step is steady and where it
// is not the same trajectory.
#include <algorithm>
#include <gtest/gtest.h>

#include "chain_10_euler.hpp"
#include "chain_10_rattle.hpp"
#include "chain_10_space_rattle.hpp"
#include "coin_euler.hpp"
#include "rolling_euler.hpp"
#include "slider_crank_euler.hpp"
#include "slider_crank_rattle.hpp"
#include "tests/derive/compile/beside_world.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

// A number that counts how often it is multiplied.
struct Counted {
  Counted() = default;
  Counted(double number) : number(number) {}  // NOLINT: as a double
  double number;
  inline static long products = 0;

  friend Counted operator+(Counted a, Counted b) { return a.number + b.number; }
  friend Counted operator-(Counted a, Counted b) { return a.number - b.number; }
  friend Counted operator-(Counted a) { return -a.number; }
  friend Counted operator*(Counted a, Counted b) { return ++products, a.number * b.number; }
  friend Counted operator/(Counted a, Counted b) { return a.number / b.number; }
  friend bool operator<(Counted a, Counted b) { return a.number < b.number; }
  friend bool operator>(Counted a, Counted b) { return a.number > b.number; }
  friend bool operator<=(Counted a, Counted b) { return a.number <= b.number; }
  friend bool operator>=(Counted a, Counted b) { return a.number >= b.number; }
  friend Counted select(bool condition, Counted a, Counted b) { return condition ? a : b; }
  friend Counted sqrt(Counted a) { return std::sqrt(a.number); }
};

// Of a step of 1 ms in the mean, after the first ones.
template <template <class> class Compiled>
double products() {
  typename Compiled<Counted>::State state;
  Compiled<Counted>::reset(state);
  for (int k = 0; k < 20; ++k) Compiled<Counted>::step(state);
  Counted::products = 0;
  for (int k = 0; k < 500; ++k) Compiled<Counted>::step(state);
  return double(Counted::products) / 500;
}

// A guess of their multipliers would move the bodies for good: these rows have no error.
TEST(Foresight, LeavesOutRowsOfVelocities) {
  cdot::runs_as_the_world<coin_euler<double>>("specs/scenes/gallery/coin.toml", Integrator::euler, 1e-11, 2);
  cdot::runs_as_the_world<rolling_euler<double>>("tests/derive/compile/scenes/rolling.toml", Integrator::euler);
}

TEST(Foresight, StepsTakeFewRounds) {
  EXPECT_LT(products<slider_crank_euler>(), 830);
  EXPECT_LT(products<slider_crank_rattle>(), 920);
  EXPECT_LT(products<chain_10_euler>(), 1900);
  EXPECT_LT(products<chain_10_rattle>(), 1930);
  EXPECT_LT(products<chain_10_space_rattle>(), 10500);
}

// Multipliers that are polynomials of degree 4 in the number of the step, in units that change.
double polynomial(int row, int step) {
  const double t = 0.3 * step - 1;
  return 1 + row + t * (2 - t * (0.5 * row + t * (1 - 0.25 * t)));
}

TEST(Foresight, ContinuesPolynomials) {
  using Chain = chain_10_euler<double>;
  Chain::State state;
  Chain::reset(state);
  state.known = 0;
  double found[Chain::rows], foreseen[Chain::rows];
  for (int step = 0; step < 12; ++step) {
    const double unit = step < 9 ? 0.5 : 0.25;
    Chain::foresee(state, unit, foreseen);
    for (int row = 0; row < Chain::rows; ++row) {
      found[row] = unit * polynomial(row, step);
      const double now = unit * polynomial(row, step), last = unit * polynomial(row, step - 1);
      const double by_order[] = {0, last, 2 * last - unit * polynomial(row, step - 2)};
      if (step == 3 || step == 4) continue;
      EXPECT_NEAR(foreseen[row], step < 3 ? by_order[step] : now, 2e-13) << "step " << step;
    }
    Chain::remember(state, true, false, unit, found, foreseen);
    EXPECT_EQ(state.known, std::min(step + 1, 5));
  }
}

// Steps of other lengths begin other series.
template <class Compiled>
void changes_its_step(const std::string& file, Integrator integrator, double within) {
  using S = std::conditional_t<cdot::is_spatial<Compiled>, cdot::Spatial<double>, cdot::Planar<double>>;
  auto world = cdot::world_of<S>(cdot::read_scene(std::string(CDOT_SOURCE_DIR) + "/" + file), integrator);
  typename Compiled::State state;
  Compiled::reset(state);
  constexpr double steps[] = {0.001, 0.001, 0.0004, 0.001, 0.0002, 0.0007, 0.0007};
  for (int k = 0; k < 500; ++k) {
    const double step = steps[k % 20 < 13 ? 0 : k % 7];
    ASSERT_TRUE(world.step(step));
    ASSERT_LT(Compiled::step(state, step), 1e-12) << file << ", step " << k;
  }
  EXPECT_LT(cdot::distance<Compiled>(state, world), within) << file;
}

TEST(Foresight, FollowsChangesOfTheStep) {
  changes_its_step<chain_10_euler<double>>("specs/scenes/chain_10.toml", Integrator::euler, 1e-10);
  changes_its_step<chain_10_rattle<double>>("specs/scenes/chain_10.toml", Integrator::rattle, 1e-10);
  changes_its_step<slider_crank_euler<double>>("specs/scenes/slider_crank.toml", Integrator::euler, 2e-9);
  changes_its_step<slider_crank_rattle<double>>("specs/scenes/slider_crank.toml", Integrator::rattle, 1e-10);
  changes_its_step<chain_10_space_rattle<double>>("specs/scenes/spatial/chain_10.toml", Integrator::rattle, 1e-10);
}

// Of K, and of the matrix that aims: J of another pose in place of J.
template <class Compiled>
void solves_for_its_rows() {
  const auto state = cdot::state_after<Compiled>(150);
  cdot::solves_for_rows<Compiled>(state.J, 1e-12,
                                  [&](auto& b, auto& lambda, auto& d) { Compiled::solve(state.J, b, lambda, d); });
  typename Compiled::Pose at[Compiled::bodies];
  for (int k = 0; k < Compiled::bodies; ++k) at[k] = state.q[k], at[k].angle += 0.1 * k;
  Compiled::turn(at);
  typename Compiled::Aim aim;
  Compiled::aim(at, state.time, state.J, aim);
  typename Compiled::Jacobian J;
  Compiled::evaluate(at, state.time, J);
  cdot::solves_for_rows<Compiled>(J, 1e-12,
                                  [&](auto& b, auto& lambda, auto& d) { Compiled::solve(state.J, aim, b, lambda, d); });
}

TEST(Foresight, SolvesForItsRows) {
  solves_for_its_rows<chain_10_euler<double>>();
  solves_for_its_rows<slider_crank_rattle<double>>();
  solves_for_its_rows<chain_10_rattle<double>>();
}

}  // namespace
