#include "derive/compile/methods/events.hpp"

#include <fmt/format.h>

namespace cdot::compile {
namespace {

// As the World does it: runtime/solve/latch.cpp. Where a time is unlimited the distance is no number: no event.
constexpr const char* latch_begins = R"(
  // Events at the end of a step.
  static void latch(State& s) {{
    constexpr bool waits[bounded] = {{{}}};
    T after[bounded], until[bounded];
    distances($ss.q, s.time, s.v, after, until);
    const T near = T(single ? 1e-5 : 1e-10);
    Mask some = T(1) < T(0);
    for (int i = 0; i < bounded; ++i) {{
      T &began = s.events.began[i], &ended = s.events.ended[i];
      const auto begins_now = after[i] <= near && began < T(1), ends_now = until[i] <= near && ended < T(1);
      some = some || begins_now || ends_now;
      began = select(begins_now, T(1), began), ended = select(ends_now, T(1), ended);
      s.events.acts[i] = (waits[i] ? began : T(1)) * (T(1) - ended);
    }}
)";

// The next step does not repeat what ended this one: another set of rows acts in it.
constexpr const char* forgets = "    for (Velocity& of_body : s.pull) of_body = choose(some, still(), of_body);\n";

}  // namespace

std::string latch_of(const std::string& waits, const Contents& has) {
  std::string text = fmt::format(latch_begins, waits);
  text += has.pulls() ? forgets : "    (void)some;\n";
  if (has.modes) text += "    s.modes.known = select(some, T(0), s.modes.known);\n";
  if (has.exerts) text += "    s.begins = select(some, T(1), s.begins);\n";
  return text + "  }\n";
}

}  // namespace cdot::compile
