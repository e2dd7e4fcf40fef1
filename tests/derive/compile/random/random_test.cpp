// Scenes that a search among random mechanisms found: compiled, they did not move as the World does.
#include <gtest/gtest.h>

#include "hauled_off_rk4.hpp"
#include "one_way_euler.hpp"
#include "one_way_implicit.hpp"
#include "one_way_rattle.hpp"
#include "one_way_rk4.hpp"
#include "ratchet_implicit.hpp"
#include "ratchet_rattle.hpp"
#include "sheared_euler.hpp"
#include "sheared_implicit.hpp"
#include "sheared_rattle.hpp"
#include "sheared_rk4.hpp"
#include "slipping_implicit.hpp"
#include "slow_turn_implicit.hpp"
#include "stopped_flight_euler.hpp"
#include "strained_euler.hpp"
#include "tests/derive/compile/beside_world.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

const std::string room = "tests/derive/compile/random/";

// A freewheel without a largest torque.
TEST(CompiledRandom, ABoundMayBeInfinite) {
  const std::string one_way = room + "one_way.toml";
  cdot::runs_as_the_world<one_way_euler<double>>(one_way, Integrator::euler, 1e-11);
  cdot::runs_as_the_world<one_way_implicit<double>>(one_way, Integrator::implicit, 1e-11);
  cdot::runs_as_the_world<one_way_rk4<double>>(one_way, Integrator::rk4, 1e-11);
}

// By RATTLE clutches begin a step with a force that they had in the last one.
TEST(CompiledRandom, ClutchesActInBothHalvesOfAStep) {
  cdot::runs_as_the_world<one_way_rattle<double>>(room + "one_way.toml", Integrator::rattle, 1e-11);
  cdot::runs_as_the_world<ratchet_rattle<double>>(room + "ratchet.toml", Integrator::rattle, 1e-11, 0.9, 0.005);
}

// A pin shears before the hinge breaks, and a motor that starts at once shears another one.
TEST(CompiledRandom, PinsShearBeforeJointsBreak) {
  cdot::runs_as_the_world<sheared_euler<double>>(room + "sheared.toml", Integrator::euler, 1e-11, 0.3);
  cdot::runs_as_the_world<sheared_implicit<double>>(room + "sheared.toml", Integrator::implicit, 1e-11, 0.3);
  cdot::runs_as_the_world<sheared_rattle<double>>(room + "sheared.toml", Integrator::rattle, 1e-11, 0.3);
  cdot::runs_as_the_world<sheared_rk4<double>>(room + "sheared.toml", Integrator::rk4, 1e-11, 0.3);
}

// Friction that stops a body within a step makes its joints do work, which says nothing about a body at rest.
TEST(CompiledRandom, AStepThatEndsAtRestIsTakenWhole) {
  cdot::runs_as_the_world<slipping_implicit<double>>(room + "slipping.toml", Integrator::implicit, 1e-11, 0.7, 0.005);
}

// A step counts as rest by the size of the mechanism. The end of a bungee in the world takes no part in that.
TEST(CompiledRandom, AMechanismHasTheSizeThatItHasInTheWorld) {
  cdot::runs_as_the_world<slow_turn_implicit<double>>(room + "slow_turn.toml", Integrator::implicit, 1e-11, 1);
}

// The tooth holds as strongly as at the middle of the step, however many rounds that takes.
TEST(CompiledRandom, ARatchetGripsAtTheMiddleOfAStep) {
  cdot::runs_as_the_world<ratchet_implicit<double>>(room + "ratchet.toml", Integrator::implicit, 1e-11, 0.9, 0.005);
}

// The rope is the same row as the motor, but for the round-off of what the slide takes from it.
TEST(CompiledRandom, ARopeDependsOnAMotor) {
  cdot::runs_as_the_world<strained_euler<double>>(room + "strained.toml", Integrator::euler, 1e-11, 0.3, 0.005);
}

// A step brings the rods to their end, and round-off does not decide whether its correction holds them there.
TEST(CompiledRandom, AnEndIsReachedToRoundOff) {
  cdot::runs_as_the_world<stopped_flight_euler<double>>(room + "stopped_flight.toml", Integrator::euler, 1e-11, 0.5);
}

// Rows of ends that are not met have no impulse, so that no motor depends on them as it starts.
TEST(CompiledRandom, AMotorStartsBesideEndsThatAreNotMet) {
  cdot::runs_as_the_world<hauled_off_rk4<double>>(room + "hauled_off.toml", Integrator::rk4, 1e-9, 0.5);
}

}  // namespace
