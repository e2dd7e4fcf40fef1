#include "derive/compile/methods/strides.hpp"

#include <algorithm>
#include <string_view>

namespace cdot::compile {
namespace {

// As the World does it: runtime/step/step_runge_kutta.cpp and between.cpp.
constexpr const char* steps = R"(
  static T smaller(const T& a, const T& b) { return select(b < a, b, a); }
  // The margin of the row that is furthest beyond its event, beside that at the choice of the modes.
  static T furthest(const Modes& m) {
    T worst = T(0);
    for (int i = 0; i < watched; ++i) worst = smaller(worst, m.margin[i] - smaller(m.chosen[i], T(0)));
    return worst;
  }

  // Where the first row has just passed its event, between 0 and 1, by linear interpolation.
  static T first_event(const T (&chosen)[watched], const T (&before)[watched], const T (&after)[watched]) {
    T first = T(1);
    for (int i = 0; i < watched; ++i) {
      const T aim = smaller(chosen[i], T(0)) - T(2), low = before[i] - aim, high = after[i] - aim;
      first = select(high < T(0) && low > high, smaller(first, low / (low - high)), first);
    }
    return first;
  }

  // Ends the stride from s to `next` where the first row has just passed its event, in the lanes of `busy`. Every third
  // round bisects, in case linear interpolation stalls.
  static void go_to_event(const State& s, State& next, T& length, Mask busy, T& residual) {
    T low = T(0), high = length, before[watched], after[watched];
    for (int i = 0; i < watched; ++i) before[i] = s.modes.margin[i], after[i] = next.modes.margin[i];
    T last[bounded];  // forces: as cones that slip know them
    for (int i = 0; i < bounded; ++i) last[i] = next.modes.force[i];
    Mask stalls = T(1) < T(0);
    for (int search = 0; search < 61 && any(busy || stalls); ++search) {
      const T share = larger(T(0.001), smaller(T(0.999), first_event(s.modes.chosen, before, after)));
      T at = low + (search % 3 == 2 ? T(0.5) : share) * (high - low);
      stalls = stalls || (busy && !(at > low && at < high));
      if (search == 60) stalls = stalls || busy;
      at = select(stalls, high, at);
      State there = s;
      for (int i = 0; i < bounded; ++i) there.modes.force[i] = last[i];
      const T error = stride(there, at), furthest_there = furthest(there.modes);
      for (int i = 0; i < bounded; ++i) last[i] = there.modes.force[i];
      const Mask passed = furthest_there < T(-1), ends = stalls || (busy && passed && furthest_there >= T(-3));
      replace(next, there, ends);
      length = select(ends, at, length), residual = select(ends, error, residual);
      busy = busy && !ends, stalls = stalls && !ends;
      high = select(passed, at, high), low = select(passed, low, at);
      for (int i = 0; i < watched; ++i) {
        after[i] = select(passed, there.modes.margin[i], after[i]);
        before[i] = select(passed, before[i], there.modes.margin[i]);
      }
    }
  }

  // In strides that end at events; after 32 of them the rest of the step goes on without looking for more. A lane that is
  // done waits for the others unchanged.
  static T step(State& s, T h = T(default_step)) {
    const T start = s.time;
    T done = T(0), residual = T(0), events = T(0);
    s.modes.step = h;
    for (T& of_joint : s.bonds.struck) of_joint = T(0);
    for (Mask goes_on = T(0) < T(1); any(goes_on);) {
      const Mask unknown = goes_on && s.modes.known < T(0.5);
      if (any(unknown)) {
        State chosen = s;
        choose_modes(chosen, h);
        replace(s, chosen, unknown);
      }
      State next = s;
      T length = h - done, error = stride(next, length);
      const Mask passed = goes_on && furthest(next.modes) < T(-1), meets = passed && events < T(33);
      if (any(meets)) go_to_event(s, next, length, meets, error);
      next.modes.known = select(passed, T(0), T(1));
      forget_jammed(next.modes);
      done = select(meets, done + length, h);
      next.time = start + done;
      replace(s, next, goes_on);
      residual = select(goes_on, error, residual);
      events = events + T(1);
      goes_on = meets && done < h;
    }
    for (int k = 0; k < joints; ++k) s.bonds.load[k] = larger(s.bonds.load[k], s.bonds.struck[k]);
    return residual;
  }
)";

constexpr std::string_view of_loads = "      forget_jammed(next.modes);\n";
constexpr std::string_view of_blows[] = {
    "    for (T& of_joint : s.bonds.struck) of_joint = T(0);\n",
    "    for (int k = 0; k < joints; ++k) s.bonds.load[k] = larger(s.bonds.load[k], s.bonds.struck[k]);\n"};
constexpr std::string_view of_cones[] = {
    "    T last[bounded];  // forces: as cones that slip know them\n"
    "    for (int i = 0; i < bounded; ++i) last[i] = next.modes.force[i];\n",
    "      for (int i = 0; i < bounded; ++i) there.modes.force[i] = last[i];\n",
    "      for (int i = 0; i < bounded; ++i) last[i] = there.modes.force[i];\n", "    s.modes.step = h;\n"};

}  // namespace

std::string step_by_events(const Contents& has) {
  std::string text = steps;
  const auto leave_out = [&](std::string_view lines) { text.erase(text.find(lines), lines.size()); };
  if (!has.cones) std::ranges::for_each(of_cones, leave_out);
  if (!has.weighs_blows()) std::ranges::for_each(of_blows, leave_out);
  if (!has.loads) leave_out(of_loads);
  return text;
}

}  // namespace cdot::compile
