// A bevel gear for the joints of every engine: a turns about x, b about y, and 1.3 times as slowly; both start aligned
// with the world.
#pragma once

#include <type_traits>

namespace cdot::test {

template <class Parameters>
void make_bevel_gear(Parameters& p) {
  for (auto* frame : {&p.fa_x_x, &p.ga_x_x}) frame[0] = frame[4] = frame[8] = 1;
  for (auto* frame : {&p.fb_x_x, &p.gb_x_x}) frame[1] = frame[5] = frame[6] = 1;
  p.ratio = static_cast<std::decay_t<decltype(p.ratio)>>(1.3);
}

// By a motor on a of 12 rad/s and at most 1 N m. `turns` is the gear's index_of_angle_a_turns.
template <class Gear>
void drive_bevel_gear(Gear& gear, int turns) {
  gear.by_default(turns);
  gear.angle_a().speed = 12;
  gear.angle_a().most = 1;
}

}  // namespace cdot::test
