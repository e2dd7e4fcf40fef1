// Compiled scenes with effects move as the World does, to round-off; a lane has the bits that it has alone.
#include <cstring>
#include <gtest/gtest.h>

#include <cdot/pack.hpp>

#include "effects_dop853.hpp"
#include "effects_euler.hpp"
#include "effects_rk4.hpp"
#include "tailgate_dop853.hpp"
#include "tailgate_euler.hpp"
#include "tailgate_rk4.hpp"
#include "tests/derive/compile/beside_world.hpp"
#include "thrown_dop853.hpp"
#include "thrown_euler.hpp"
#include "thrown_rk4.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

const std::string tailgate = "specs/scenes/tailgate.toml", effects = "tests/derive/compile/scenes/effects.toml",
                  thrown = "tests/derive/compile/scenes/thrown.toml";

TEST(CompiledEffects, MoveByEulerAsTheWorld) {
  cdot::runs_as_the_world<tailgate_euler<double>>(tailgate, Integrator::euler);
  cdot::runs_as_the_world<effects_euler<double>>(effects, Integrator::euler);
  cdot::runs_as_the_world<thrown_euler<double>>(thrown, Integrator::euler);
}

TEST(CompiledEffects, MoveByRk4AsTheWorld) {
  cdot::runs_as_the_world<tailgate_rk4<double>>(tailgate, Integrator::rk4);
  cdot::runs_as_the_world<effects_rk4<double>>(effects, Integrator::rk4);
  cdot::runs_as_the_world<thrown_rk4<double>>(thrown, Integrator::rk4);
}

TEST(CompiledEffects, MoveByDop853AsTheWorld) {
  cdot::runs_as_the_world<tailgate_dop853<double>>(tailgate, Integrator::dop853);
  cdot::runs_as_the_world<effects_dop853<double>>(effects, Integrator::dop853);
  cdot::runs_as_the_world<thrown_dop853<double>>(thrown, Integrator::dop853);
}

// Lane k starts with its first body turning k times as fast.
template <template <class> class Compiled>
void lanes_are_as_alone() {
  constexpr int lanes = 4;
  using Pack = cdot::Pack<double, lanes>;
  typename Compiled<Pack>::State together;
  typename Compiled<double>::State alone[lanes];
  Compiled<Pack>::reset(together);
  for (int lane = 0; lane < lanes; ++lane) {
    Compiled<double>::reset(alone[lane]);
    alone[lane].v[0].w = 0.5 * lane;
    together.v[0].w.set(lane, 0.5 * lane);
    Compiled<double>::begin(alone[lane]);
  }
  Compiled<Pack>::begin(together);
  for (int k = 0; k < 300; ++k) {
    Compiled<Pack>::step(together);
    for (int lane = 0; lane < lanes; ++lane) {
      Compiled<double>::step(alone[lane]);
      for (int i = 0; i < Compiled<double>::bodies; ++i) {
        const auto& q = together.q[i];
        const double of_lane[] = {q.x[lane], q.y[lane], q.angle[lane]};
        const double of_alone[] = {alone[lane].q[i].x, alone[lane].q[i].y, alone[lane].q[i].angle};
        ASSERT_EQ(std::memcmp(of_lane, of_alone, sizeof of_lane), 0) << "lane " << lane << ", step " << k;
      }
    }
  }
  EXPECT_NE(together.q[0].angle[0], together.q[0].angle[lanes - 1]);
}

TEST(CompiledEffects, LanesAreAsAlone) {
  lanes_are_as_alone<effects_euler>();
  lanes_are_as_alone<effects_rk4>();
  lanes_are_as_alone<tailgate_euler>();
}

}  // namespace
