#include "derive/compile/methods/events.hpp"

#include <fmt/format.h>

namespace cdot::compile {
namespace {

// As the World does it: runtime/events/latch.cpp. Where a time is unlimited the distance is no number: no event.
constexpr const char* latch_begins = R"(
  // Events at the end of a step.
  static void latch(State& s) {{
    constexpr bool waits[bounded] = {{{0}}};
{3}{1}    for (int i = 0; i < bounded; ++i) {{
      T &began = s.events.began[i], &ended = s.events.ended[i];
{4}{2}      began = select(begins_now, T(1), began), ended = select(ends_now, T(1), ended);
      s.events.acts[i] = (waits[i] ? began : T(1)) * (T(1) - ended);
    }}
)";

constexpr const char* finds_distances = R"(    T after[bounded], until[bounded];
    distances($ss.q, s.time, s.v, {}after, until);
    const T near = T(single ? 1e-5 : 1e-10);
)";

constexpr const char* no_groups = R"(    Mask some[groups];
    for (Mask& of_group : some) of_group = T(1) < T(0);
)";
constexpr const char* none = "    Mask some = T(1) < T(0);\n";
constexpr const char* notes_any = "      some = some || begins_now || ends_now;\n";
constexpr const char* notes_group =
    "      some[group_of_bound[i]] = some[group_of_bound[i]] || begins_now || ends_now;\n";

// The next step of the mechanism does not repeat what ended this one: another set of rows acts in it.
constexpr const char* forgets =
    "    for (int i = 0; i < bodies; ++i) s.pull[i] = choose(some[group_of_body[i]], still(), s.pull[i]);\n";
constexpr const char* forgets_lambda =
    "    for (int i = 0; i < rows; ++i) s.lambda[i] = select(some[group_of_row[i]], T(0), s.lambda[i]);\n";
constexpr const char* restarts =
    "    for (int i = 0; i < groups; ++i) s.begins[i] = select(some[i], T(1), s.begins[i]);\n";

}  // namespace

std::string distances_now(const Contents& has) {
  return fmt::format(finds_distances, !has.forces ? "" : has.modes ? "s.modes.force, " : "s.force, ");
}

std::string latch_of(const std::string& waits, const Contents& has) {
  const bool alone = has.pulls();  // each mechanism begins anew alone
  std::string text = fmt::format(latch_begins, waits,
                                 alone       ? no_groups
                                 : has.modes ? none
                                             : "",
                                 alone       ? notes_group
                                 : has.modes ? notes_any
                                             : "",
                                 distances_now(has), happens_now);
  if (alone) text += forgets;
  if (alone && has.weighs_joints() && !has.exerts) text += forgets_lambda;  // which are the loads of that pull
  if (has.modes) text += "    s.modes.known = select(some, T(0), s.modes.known);\n";
  if (has.exerts) text += restarts;
  return text + "  }\n";
}

}  // namespace cdot::compile
