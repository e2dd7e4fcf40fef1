// The claim that a distance of two runs allows, by runs whose errors are known.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "runtime/text/files.hpp"
#include "runtime/tool/search/attempt.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::judge_test {
namespace {

Scene box(const TemporaryFolder& folder, double size) {
  const std::string file = (folder / "box.toml").string();
  text::write_file(file, fmt::format("duration = 1\naccuracy = 1e-4\n[[body]]\nname = \"box\"\nmass = 1\n"
                                     "shape = {{ box = [{0}, {0}] }}\n",
                                     size));
  return read_scene(file);
}

// A body whose error grows with time, from 0.1 s on, to 2e4 local errors of a run, but to no more than 0.2 m: so far
// apart are all loose runs of a mechanism that magnifies differences. The energy's error falls with the local errors.
Attempt attempt_of(double local_error, int intervals, double share_of_time) {
  constexpr double magnified = 2e4, most = 0.2;
  Attempt attempt;
  attempt.knob = {Integrator::dop853, local_error, 1, intervals};
  attempt.energy_share = local_error, attempt.whole = share_of_time == 1;
  for (int k = 0; k <= intervals * share_of_time; ++k) {
    Frame frame;
    frame.time = static_cast<double>(k) / intervals;
    frame.bodies.resize(1);
    frame.bodies[0].x = std::min(most, magnified * local_error) * std::clamp(4 * (frame.time - 0.1), 0.0, 1.0);
    attempt.frames.push_back(frame);
  }
  return attempt;
}

// The first run tells nothing about the error of the last one. That of the run between them, which ended after a
// quarter of the time since it was too far from the first, tells.
TEST(Claims, CountARunBetweenThatEndedEarly) {
  const Scene scene = box(TemporaryFolder(), 1);
  const Yardstick yardstick(scene);
  for (const double fine : {2e-8, 9e-9, 2e-9, 2e-10, 2e-11}) {
    const Attempt coarse = attempt_of(2e-2, 16, 1), between = attempt_of(2e-6, 64, 0.25);
    Attempt now = attempt_of(fine, 64, 1);
    judge(scene, yardstick, coarse, between, now);
    const double off = now.frames.back().bodies[0].x;
    fmt::print("  local error {:.0e}: claims {:.1e}, is off by {:.1e}\n", fine, now.claimed, off);
    EXPECT_LT(off, now.claimed) << fine;
    EXPECT_EQ(now.reached, fine < 1e-9) << fine;
    EXPECT_GT(now.holds_until, 0.09) << fine;  // by the ends of the coarse run's intervals it is 0.0625
  }
}

// At 1000 m/s a local error allows a thousand times as much of the velocity. An error of one such step goes on for a
// second, but the loose run happens to make none.
TEST(Claims, CountTheErrorsOfFastBodies) {
  const Scene scene = box(TemporaryFolder(), 1);
  Attempt coarse = attempt_of(2e-5, 16, 1), fine = attempt_of(1e-9, 64, 1);
  for (Frame& frame : coarse.frames) frame.bodies[0].x = 0;
  for (Frame& frame : fine.frames) frame.bodies[0].vx = 1000, frame.bodies[0].x = 1e-6 * frame.time;
  judge(scene, Yardstick(scene), coarse, {}, fine);
  EXPECT_GT(fine.claimed, 1e-6);
}

// Two runs may agree by chance on steps that were left to another method, whatever their local errors are: the whole
// distance must be within what is asked for, and the last two distances tell about the error.
TEST(Claims, TrustNoChanceOnStepsLeftToAnotherMethod) {
  const Scene scene = box(TemporaryFolder(), 1);
  const auto judged = [&](double before, double distance, long long rescued) {
    Attempt coarse = attempt_of(2e-2, 64, 1), fine = attempt_of(2e-7, 64, 1);
    fine.knob.parts = 4, coarse.apart = before, coarse.result.counts.rescued = fine.result.counts.rescued = rescued;
    for (std::size_t k = 0; k < coarse.frames.size(); ++k)
      fine.frames[k].bodies[0].x = 0, coarse.frames[k].bodies[0].x = distance * coarse.frames[k].time;
    judge(scene, Yardstick(scene), coarse, {}, fine);
    return fine;
  };
  EXPECT_TRUE(judged(1, 5e-3, 0).reached);
  EXPECT_FALSE(judged(1, 5e-3, 1).reached);
  EXPECT_TRUE(judged(1e-5, 9e-5, 1).reached);
  EXPECT_NEAR(judged(1e-5, 9e-5, 1).claimed, 9e-5, 1e-6);
  EXPECT_NEAR(judged(9e-5, 1e-6, 1).claimed, 9e-5, 1e-6);
}

// Each event is located to 1e-9 of the body's size, whatever the local error is: two runs that agree better on a
// thousand of them may both be wrong.
TEST(Claims, AreNoFinerThanTheEventsAre) {
  const Scene scene = box(TemporaryFolder(), 1);
  const auto judged = [&](long long events) {
    Attempt coarse = attempt_of(2e-9, 64, 1), fine = attempt_of(2e-12, 64, 1);
    coarse.result.counts.events = fine.result.counts.events = events;
    for (std::size_t k = 0; k < coarse.frames.size(); ++k)
      fine.frames[k].bodies[0].x = 0, coarse.frames[k].bodies[0].x = 1e-9 * coarse.frames[k].time;
    judge(scene, Yardstick(scene), coarse, {}, fine);
    return fine;
  };
  EXPECT_TRUE(judged(70000).reached);
  EXPECT_FALSE(judged(71000).reached);
  EXPECT_NEAR(judged(71000).achieved, 71000e-9 * std::sqrt(2.0), 1e-12);
}

// A loose run that does not resolve a fast oscillation is 0.05 rad off, of 1e-4 asked for, as far as it gets. Where
// stability bounds the steps that may be so, whatever the energy says; else it is a distance like any other.
TEST(Claims, TrustNoLargeGainWhereStabilityBoundsTheSteps) {
  const Scene scene = box(TemporaryFolder(), 1);
  const auto judged = [&](double distance, bool dear) {
    Attempt coarse = attempt_of(2e-2, 64, 1), fine = attempt_of(2e-7, 64, 1);
    coarse.dear = fine.dear = dear;
    for (std::size_t k = 0; k < coarse.frames.size(); ++k)
      fine.frames[k].bodies[0].x = 0, coarse.frames[k].bodies[0].x = distance * coarse.frames[k].time;
    judge(scene, Yardstick(scene), coarse, {}, fine);
    return fine;
  };
  EXPECT_TRUE(judged(0.05, false).reached);
  EXPECT_FALSE(judged(0.05, true).reached);
  EXPECT_GT(judged(0.05, true).achieved, 0.001);
  EXPECT_TRUE(judged(0.01, true).reached);
}

// Equal steps throw a drive that is too stiff for them from limit to limit. Two runs agree on that.
TEST(Claims, TrustNoEqualStepsThatThrowADriveFromLimitToLimit) {
  const Scene scene = box(TemporaryFolder(), 1);
  const auto judged = [&](double limited, bool alike) {
    Attempt coarse = attempt_of(0, 64, 1), fine = attempt_of(0, 64, 1);
    for (Attempt* one : {&coarse, &fine}) one->knob.integrator = Integrator::implicit;
    coarse.apart = 1, fine.knob.parts = 4, fine.result.solves = 100;
    fine.swings = swings(fine.knob, limited);
    if (alike) judge(scene, Yardstick(scene), coarse, {}, fine);
    else judge_unlike(scene, Yardstick(scene), coarse, fine);
    return fine.reached;
  };
  for (const bool alike : {true, false}) {
    EXPECT_TRUE(judged(3.9, alike)) << alike;  // times too stiff for steps of an interval, which are four times as long
    EXPECT_FALSE(judged(4.1, alike)) << alike;
  }
  EXPECT_FALSE(swings({Integrator::euler, 0, 1}, 1e9));
  EXPECT_FALSE(swings({Integrator::radau5, 1e-6, 1}, 1e9));
}

// Local errors of 10 : 1 surely gain 1.8. If the errors fall by no more and have one sign, half of the coarse error is
// no part of the distance.
TEST(Claims, CountErrorsOnTheSameSide) {
  const Scene scene = box(TemporaryFolder(), 1);
  Attempt coarse = attempt_of(1e-11, 64, 1), fine = attempt_of(1e-12, 64, 1);
  for (Frame& frame : coarse.frames) frame.bodies[0].x = 1.9e-8 * frame.time;
  for (Frame& frame : fine.frames) frame.bodies[0].x = 1e-8 * frame.time;
  judge(scene, Yardstick(scene), coarse, {}, fine);
  EXPECT_GT(fine.claimed, 1e-8);
}

// Local errors of 1e-6 and of 1e-12 promise errors of 1e6 : 1. Where events are located to 1e-9 m, 1e3 : 1 is left;
// where they are located to 1e-9 of 1000 m, nothing is.
TEST(Claims, CountWhatLocatedEventsLeave) {
  const TemporaryFolder folder;
  const Yardstick of_a_metre(box(folder, 0.7)), of_a_kilometre(box(folder, 700));
  Attempt coarse, fine;
  coarse.knob = {Integrator::rk4, 1e-6}, fine.knob = {Integrator::rk4, 1e-12};
  EXPECT_NEAR(sure_gain(of_a_metre, coarse, fine, 1e-5), std::sqrt(1e6), 0.01 * std::sqrt(1e6));
  fine.result.counts.events = 1;
  EXPECT_NEAR(sure_gain(of_a_metre, coarse, fine, 1e-5), std::sqrt(1e3), 0.01 * std::sqrt(1e3));
  EXPECT_LT(sure_gain(of_a_kilometre, coarse, fine, 1e-5), 1.5);
}

// How loose the second half of a run may be. The distance grows with time; the energy's error of the run before
// does, too, or is made in the second half.
TEST(Claims, ArePromisedBeforeARunGoesOnLooser) {
  const Yardstick yardstick(box(TemporaryFolder(), 1));
  const auto looser = [&](double distance, double energy_to_come, int events, int events_so_far = 0, int kinks = 0) {
    Attempt coarse = attempt_of(2e-2, 16, 1), fine = attempt_of(2e-6, 64, 0.5);
    for (Frame& frame : coarse.frames) frame.bodies[0].x = distance * frame.time;
    for (Frame& frame : fine.frames) frame.bodies[0].x = 0;
    for (const Frame& frame : coarse.frames) coarse.energy_shares.push_back(1e-3 / energy_to_come * frame.time);
    coarse.energy_share = 1e-3, fine.energy_share = 1e-7, coarse.result.counts.events = events;
    fine.result.counts.events = events_so_far;
    coarse.result.counts.taken = 20, coarse.result.kinked = kinks;
    return looser_error(yardstick, 1, coarse, fine);
  };
  EXPECT_EQ(looser(1e-6, 1, 0), 0.25e-4);  // a share of the accuracy
  EXPECT_GT(looser(1e-3, 1, 0), 5e-6);
  EXPECT_LT(looser(1e-3, 1, 0), 1e-4);
  EXPECT_EQ(looser(3e-2, 1, 0), 2e-6);  // of its own knob
  EXPECT_LT(looser(3e-4, 4, 0), 0.5 * looser(3e-4, 1, 0));
  EXPECT_EQ(looser(1e-6, 1000, 0), 2e-6);
  EXPECT_EQ(looser(1e-6, 1, 2, 1), 2e-6);     // an event may lie ahead
  EXPECT_GT(looser(1e-6, 1, 2, 2), 2e-5);     // both lie behind
  EXPECT_EQ(looser(1e-6, 1, 0, 0, 1), 2e-6);  // a kink may lie ahead
}

}  // namespace
}  // namespace cdot::test::judge_test
