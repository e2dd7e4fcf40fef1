// Mechanisms of one freedom step in a few angles: their equations against those of the rows, and their way against the
// World's at any step.
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>

#include <cdot/pack.hpp>

#include "compound_pendulum_euler.hpp"
#include "crank_by_rows.hpp"
#include "crank_rocker_euler.hpp"
#include "crank_with_inputs.hpp"
#include "four_bar_euler.hpp"
#include "slider_crank_euler.hpp"
#include "tests/derive/compile/beside_world.hpp"
#include "trammel_euler.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

constexpr const char* crank = "specs/scenes/slider_crank.toml";

// test(mechanism): its struct.
template <class Test>
void of_each_mechanism(Test test) {
  test(compound_pendulum_euler<double>{}), test(crank_rocker_euler<double>{}), test(four_bar_euler<double>{});
  test(slider_crank_euler<double>{}), test(trammel_euler<double>{});
}

template <class Compiled>
struct Numbers {
  using Velocity = typename Compiled::Velocity;
  Velocity of[Compiled::bodies];
};

// v = t, from what a unit of momentum along t leaves: any v that is no multiple of t is projected onto it.
template <class Compiled>
Numbers<Compiled> tangent(const typename Compiled::State& state) {
  Numbers<Compiled> any, t;
  for (int k = 0; k < Compiled::bodies; ++k) any.of[k] = {1.0 + k, 0.5 - k, 2.0 + 3 * k};
  Compiled::go_along(state.F, any.of, t.of);
  return t;
}

// 2 v M u = (u + v)^2 - u^2 - v^2
template <class Compiled>
double along(const typename Compiled::State& state, const Numbers<Compiled>& u, const Numbers<Compiled>& v) {
  Numbers<Compiled> sum;
  for (int k = 0; k < Compiled::bodies; ++k) sum.of[k] = u.of[k] + v.of[k];
  const auto twice = [&](const Numbers<Compiled>& of) { return Compiled::weighed(state.q, of.of); };
  return (twice(sum) - twice(u) - twice(v)) / 2;
}

// By the rows: J t = 0; and M (v - t w t^T M v) is normal to t, so that it is J^T lambda.
template <class Compiled>
void projects_onto_the_joints() {
  auto state = cdot::state_after<Compiled>(150);
  Compiled::evaluate(state.q, state.time, state.J);
  const Numbers<Compiled> t = tangent<Compiled>(state);
  double rate[Compiled::rows];
  Compiled::rates(state.J, t.of, rate);
  for (int row = 0; row < Compiled::rows; ++row) EXPECT_NEAR(rate[row], 0, 1e-13) << "row " << row;
  EXPECT_GT(along<Compiled>(state, t, t), 1e-6);
  for (int k = 0; k < 3 * Compiled::bodies; ++k) {
    Numbers<Compiled> v{}, kept;
    double* const number[] = {&v.of[k / 3].x, &v.of[k / 3].y, &v.of[k / 3].w};
    *number[k % 3] = 1;
    Compiled::go_along(state.F, v.of, kept.of);
    for (int i = 0; i < Compiled::bodies; ++i) v.of[i] = v.of[i] - kept.of[i];
    EXPECT_NEAR(along<Compiled>(state, v, t), 0, 1e-14) << "component " << k;
  }
}

TEST(OneFreedom, ProjectsOntoTheJoints) {
  of_each_mechanism([]<class Compiled>(Compiled) { projects_onto_the_joints<Compiled>(); });
}

// d = M^-1 J^T lambda by the rows' own solve() gives its lambda back.
template <class Compiled>
void finds_impulses() {
  auto state = cdot::state_after<Compiled>(150);
  Compiled::evaluate(state.q, state.time, state.J);
  double b[Compiled::rows], lambda[Compiled::rows], found[Compiled::rows];
  for (int row = 0; row < Compiled::rows; ++row) b[row] = 0.2 + 0.1 * ((7 * row) % 11);
  typename Compiled::Velocity d[Compiled::bodies];
  Compiled::solve(state.J, b, lambda, d);
  Compiled::find_impulses(state.q, state.F, d, found);
  double size = 0;
  for (const double of_row : lambda) size = std::max(size, std::abs(of_row));
  for (int row = 0; row < Compiled::rows; ++row) EXPECT_NEAR(found[row], lambda[row], 1e-12 * size) << "row " << row;
}

TEST(OneFreedom, FindsTheImpulsesOfTheRows) {
  of_each_mechanism([]<class Compiled>(Compiled) { finds_impulses<Compiled>(); });
}

// From rest to fast: where J turns far in a step, rounds on K renew it, in the World as here.
template <class Compiled>
void goes_as_the_world_at_any_step(const std::string& file, double within) {
  for (const double step : {0.0003, 0.001, 0.0013, 0.002, 0.003, 0.005, 0.008}) {
    SCOPED_TRACE(step);
    auto world = cdot::world_of(cdot::read_scene(std::string(CDOT_SOURCE_DIR) + "/" + file), Integrator::euler);
    typename Compiled::State state;
    Compiled::reset(state);
    for (int k = 0; k < 300; ++k) {
      ASSERT_TRUE(world.step(step));
      Compiled::step(state, step);
    }
    EXPECT_LT(cdot::distance<Compiled>(state, world), within) << file;
    EXPECT_LT(state.residual, 1e-12);
  }
}

TEST(OneFreedom, GoesAsTheWorldAtAnyStep) {
  goes_as_the_world_at_any_step<slider_crank_euler<double>>(crank, 2e-9);
  goes_as_the_world_at_any_step<crank_rocker_euler<double>>("specs/scenes/crank_rocker.toml", 2e-9);
  goes_as_the_world_at_any_step<trammel_euler<double>>("specs/scenes/gallery/trammel.toml", 2e-9);
  goes_as_the_world_at_any_step<compound_pendulum_euler<double>>("specs/scenes/compound_pendulum.toml", 2e-9);
}

// Some lanes go by their angles where others go by their rows: each has its step.
TEST(OneFreedom, LanesOfSomeStepsAreAsAlone) {
  constexpr int lanes = 4;
  using Alone = slider_crank_euler<double>;
  using Together = slider_crank_euler<cdot::Pack<double, lanes>>;
  constexpr double steps[] = {0.0005, 0.0011, 0.0016, 0.004};
  cdot::Pack<double, lanes> step;
  Alone::State alone[lanes];
  Together::State together;
  Together::reset(together);
  for (int lane = 0; lane < lanes; ++lane) Alone::reset(alone[lane]), step.set(lane, steps[lane]);
  int by_rows[lanes] = {};
  for (int k = 0; k < 400; ++k) {
    Together::step(together, step);
    for (int lane = 0; lane < lanes; ++lane) {
      Alone::step(alone[lane], steps[lane]);
      by_rows[lane] += alone[lane].known == 0;
      const double* const of_alone = reinterpret_cast<const double*>(&alone[lane]);
      for (std::size_t n = 0; n < sizeof(Alone::State) / sizeof(double); ++n) {
        const double of_lane = reinterpret_cast<const cdot::Pack<double, lanes>*>(&together)[n][lane];
        ASSERT_EQ(std::memcmp(&of_lane, &of_alone[n], sizeof of_lane), 0)
            << "lane " << lane << ", step " << k << ", number " << n;
      }
    }
  }
  EXPECT_EQ(by_rows[0], 0);
  EXPECT_GT(by_rows[2], 20);
  EXPECT_LT(by_rows[2], 380);
  EXPECT_GT(by_rows[3], 50);
}

// A change of the velocities or of the step in a run, as a game makes them.
TEST(OneFreedom, FollowsBlowsAndOtherSteps) {
  auto world = cdot::world_of(cdot::read_scene(std::string(CDOT_SOURCE_DIR) + "/" + crank), Integrator::euler);
  using Compiled = slider_crank_euler<double>;
  Compiled::State state;
  Compiled::reset(state);
  for (int k = 0; k < 600; ++k) {
    const double step = k % 50 < 40 ? 0.001 : 0.0003;
    if (k % 70 == 69) {
      auto v = world.velocity(1);
      v.w += 40, v.x -= 1;
      world.set_velocity(1, v);
      state.v[1].w += 40, state.v[1].x -= 1;
    }
    ASSERT_TRUE(world.step(step));
    ASSERT_LT(Compiled::step(state, step), 1e-12) << k;
  }
  EXPECT_LT(cdot::distance<Compiled>(state, world), 1e-8);
}

// After 16,000 turns the last place of an angle is 1.5e-11 rad: moves must not be differences of such angles.
TEST(OneFreedom, KeepsItsWayAfterManyTurns) {
  using Compiled = slider_crank_euler<double>;
  Compiled::State state, turned;
  Compiled::reset(state), Compiled::reset(turned);
  turned.q[0].angle += 16000 * 2 * 3.14159265358979323846;
  Compiled::begin(turned);
  for (int k = 0; k < 300; ++k) {
    ASSERT_LT(Compiled::step(state), 1e-12);
    ASSERT_LT(Compiled::step(turned), 1e-12);
    ASSERT_GT(turned.known, 0) << "by its rows in step " << k;
  }
  EXPECT_NEAR(turned.v[0].w, state.v[0].w, 1e-6);
  EXPECT_NEAR(turned.q[2].x, state.q[2].x, 1e-8);
}

// Other lengths of the links, which a run may set, beside the same step on rows.
template <class Compiled>
typename Compiled::State with_other_lengths() {
  typename Compiled::State state;
  Compiled::reset(state);
  state.p.A_pb_x = -0.14, state.p.O_pb_y = 0.004, state.p.guide_pb_y = 0.01;
  Compiled::begin(state);
  return state;
}

TEST(OneFreedom, TakesLengthsOfARun) {
  using Compiled = crank_with_inputs<double>;
  using ByRows = crank_by_rows<double>;
  auto state = with_other_lengths<Compiled>();
  auto by_rows = with_other_lengths<ByRows>();
  for (int k = 0; k < 300; ++k) Compiled::step(state), ByRows::step(by_rows);
  EXPECT_NEAR(state.q[0].angle, by_rows.q[0].angle, 2e-9);
  EXPECT_NEAR(state.q[2].y, 0.01, 1e-12);
  EXPECT_GT(state.known, 0);
  for (int row = 0; row < Compiled::rows; ++row) EXPECT_NEAR(state.lambda[row], by_rows.lambda[row], 1e-9) << row;
}

// Joints that no pose meets: the step says so, and throws no body.
TEST(OneFreedom, TellsOfLoopsThatCannotClose) {
  using Compiled = slider_crank_euler<double>;
  Compiled::State state;
  Compiled::reset(state);
  state.q[1].x += 5, state.q[2].x += 5;
  state.q[1].angle = 1.5, state.q[0].angle = 1.5;
  Compiled::begin(state);
  for (int k = 0; k < 200; ++k) Compiled::step(state);
  for (const auto& q : state.q) EXPECT_LT(std::hypot(q.x, q.y), 10) << state.residual;
}

}  // namespace
