// A lane of a pack has the bits that it has alone, whatever the other lanes do.
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <random>

#include <cdot/pack.hpp>

#include "chain_10_dop853.hpp"
#include "chain_10_euler.hpp"
#include "chain_10_rk4.hpp"
#include "four_bar_rattle.hpp"
#include "slider_crank_euler.hpp"
#include "slider_crank_rattle.hpp"
#include "slider_crank_rk4.hpp"

namespace {

// Lane k starts with its first body turning k times as fast.
template <class T>
T spin_of(int lane) {
  return T(0.25) * T(lane);
}

template <template <class> class Compiled, class T>
bool are_equal(const typename Compiled<T>::State& alone, const typename Compiled<T>::State& lane) {
  return std::memcmp(&alone.q, &lane.q, sizeof alone.q) == 0 && std::memcmp(&alone.v, &lane.v, sizeof alone.v) == 0;
}

template <template <class> class Compiled, class T, int width>
typename Compiled<T>::State lane_of(const typename Compiled<cdot::Pack<T, width>>::State& pack, int lane) {
  typename Compiled<T>::State s{};
  for (int i = 0; i < Compiled<T>::bodies; ++i) {
    const auto& q = pack.q[i];
    const auto& v = pack.v[i];
    s.q[i] = {q.x[lane], q.y[lane], q.angle[lane], q.c[lane], q.s[lane]};
    s.v[i] = {v.x[lane], v.y[lane], v.w[lane]};
  }
  return s;
}

template <template <class> class Compiled, class T, int width>
void lanes_are_as_alone() {
  using Pack = cdot::Pack<T, width>;
  typename Compiled<Pack>::State together;
  typename Compiled<T>::State alone[width];
  Compiled<Pack>::reset(together);
  for (int lane = 0; lane < width; ++lane) {
    Compiled<T>::reset(alone[lane]);
    alone[lane].v[0].w = spin_of<T>(lane);
    together.v[0].w.set(lane, spin_of<T>(lane));
    Compiled<T>::begin(alone[lane]);
  }
  Compiled<Pack>::begin(together);
  for (int k = 0; k < 300; ++k) {
    Compiled<Pack>::step(together);
    for (int lane = 0; lane < width; ++lane) {
      Compiled<T>::step(alone[lane]);
      ASSERT_TRUE((are_equal<Compiled, T>(alone[lane], lane_of<Compiled, T, width>(together, lane))))
          << "lane " << lane << ", step " << k;
    }
  }
  EXPECT_NE(together.q[0].angle[0], together.q[0].angle[width - 1]);
}

using namespace cdot::scenes;

TEST(CompiledLanes, OfDoublesAreAsAlone) {
  lanes_are_as_alone<chain_10_euler, double, 4>();
  lanes_are_as_alone<chain_10_rk4, double, 4>();
  lanes_are_as_alone<chain_10_rk4, double, 8>();
  lanes_are_as_alone<chain_10_dop853, double, 4>();
  lanes_are_as_alone<slider_crank_euler, double, 8>();
  lanes_are_as_alone<slider_crank_rk4, double, 8>();
}

TEST(CompiledLanes, OfFloatsAreAsAlone) {
  lanes_are_as_alone<slider_crank_euler, float, 8>();
  lanes_are_as_alone<slider_crank_rk4, float, 4>();
}

// Each lane moves the faster the larger its number, off its joints.
template <template <class> class Compiled, int width>
void kick(typename Compiled<cdot::Pack<double, width>>::State& together,
          typename Compiled<double>::State (&alone)[width], std::mt19937& random) {
  const auto change = [&](int lane, double least) { return 0.3 * (lane + least) * (random() / 2147483648.0 - 1); };
  const double least = random() % 2;
  for (int i = 0; i < Compiled<double>::bodies; ++i)
    for (int lane = 0; lane < width; ++lane) {
      auto& v = alone[lane].v[i];
      v.x += change(lane, least), v.y += change(lane, least), v.w += 5 * change(lane, least);
      together.v[i].x.set(lane, v.x), together.v[i].y.set(lane, v.y), together.v[i].w.set(lane, v.w);
    }
}

// Newton's method begins anew, or fails, in some lanes only.
template <template <class> class Compiled>
void kicked_lanes_are_as_alone() {
  constexpr int width = 4;
  typename Compiled<cdot::Pack<double, width>>::State together;
  typename Compiled<double>::State alone[width];
  std::mt19937 random(7);
  Compiled<cdot::Pack<double, width>>::reset(together);
  for (auto& lane : alone) Compiled<double>::reset(lane);
  for (int k = 0; k < 600; ++k) {
    if (k % 10 == 0) kick<Compiled, width>(together, alone, random);
    Compiled<cdot::Pack<double, width>>::step(together, 0.004);
    for (int lane = 0; lane < width; ++lane) {
      Compiled<double>::step(alone[lane], 0.004);
      ASSERT_TRUE((are_equal<Compiled, double>(alone[lane], lane_of<Compiled, double, width>(together, lane))))
          << "lane " << lane << ", step " << k;
    }
  }
}

TEST(CompiledLanes, AreAsAloneWhereOthersBeginAnew) {
  kicked_lanes_are_as_alone<slider_crank_euler>();
  kicked_lanes_are_as_alone<chain_10_euler>();
  kicked_lanes_are_as_alone<slider_crank_rattle>();
  kicked_lanes_are_as_alone<four_bar_rattle>();
}

struct Pose {
  double angle, c, s;
};
struct Move {
  double w;
};

// Of an angle in both halves of the turn, from one beside it and from one too far for the series. A pose that turns by
// that much has the same.
TEST(CompiledArithmetic, TurnsBesideAnotherAngle) {
  for (int k = -400; k < 400; ++k) {
    const double from = 0.37 * k, to = from + 0.001 * k;
    double s = 0, c = 0;
    sin_cos_beside<false>(std::sin(from), std::cos(from), to - from, to, s, c);
    EXPECT_NEAR(s, std::sin(to), 4e-16) << from << ", " << to;
    EXPECT_NEAR(c, std::cos(to), 4e-16) << from << ", " << to;
    sin_cos_beside<true>(std::sin(from), std::cos(from), to - from, to, s, c);
    EXPECT_NEAR(s, std::sin(to), 4e-16) << from << ", " << to;
    EXPECT_NEAR(c, std::cos(to), 4e-16) << from << ", " << to;
    Pose pose{from, std::cos(from), std::sin(from)};
    sin_cos_after(pose, Move{to - from});
    EXPECT_TRUE(pose.s == s && pose.c == c) << from << ", " << to;
  }
}

#if defined(__SSE2__) || defined(__aarch64__)
// Four angles side by side have the bits that each has alone.
TEST(CompiledArithmetic, TurnsFourPosesAsOne) {
  for (int k = -400; k < 400; ++k) {
    Pose poses[4], turned[4];
    for (int i = 0; i < 4; ++i) {
      poses[i].angle = 0.37 * k + i, turned[i].angle = poses[i].angle + 0.001 * k * i;
      sin_cos(poses[i].angle, turned[i].s, turned[i].c);
    }
    sin_cos_of(poses, 0, 1, 2, 3);
    for (int i = 0; i < 4; ++i) EXPECT_TRUE(poses[i].s == turned[i].s && poses[i].c == turned[i].c) << k << ", " << i;
    const Four angles{turned[0].angle, turned[1].angle, turned[2].angle, turned[3].angle};
    sin_cos_near<true>(turned, poses, angles, 0, 1, 2, 3);
    for (int i = 0; i < 4; ++i) {
      double s = 0, c = 0;
      sin_cos_beside<true>(poses[i].s, poses[i].c, turned[i].angle - poses[i].angle, turned[i].angle, s, c);
      EXPECT_TRUE(turned[i].s == s && turned[i].c == c) << k << ", " << i;
    }
  }
}

#endif

// A State is a snapshot: its bytes are the whole run.
TEST(CompiledState, IsASnapshot) {
  using Chain = chain_10_rk4<double>;
  Chain::State state, kept;
  Chain::reset(state);
  for (int k = 0; k < 50; ++k) Chain::step(state);
  std::memcpy(&kept, &state, sizeof state);
  for (int k = 0; k < 50; ++k) Chain::step(state), Chain::step(kept);
  EXPECT_EQ(std::memcmp(&kept, &state, sizeof state), 0);
}

}  // namespace
