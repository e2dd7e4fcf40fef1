#include "derive/compile/rattle/start.hpp"

#include <fmt/format.h>

#include "derive/compile/methods/bonds.hpp"
#include "derive/compile/methods/weights.hpp"

namespace cdot::compile {
namespace {

// The first step does not repeat what ended another one.
constexpr const char* start_begins = R"(
  // Forces of joints and motors at the start of a run, of mechanisms and in lanes that begin.
  static void start(State& s, const T& h{0}) {{
{1}    Mask begins[groups], some = T(1) < T(0);
    for (int i = 0; i < groups; ++i) begins[i] = s.begins[i] > T(0), some = some || begins[i];
    if (!any(some)) return;
    Velocity pull[bodies];
)";
// Whether motors of unlimited force reach their rates by a blow that loads friction. The rate that a motor misses is
// what exert() asks for in another time. Where an end holds it, the bounds do not bring it there.
constexpr const char* forgets_started = "    for (int i = 0; i < groups; ++i) started[i] = T(1) < T(0);\n";
constexpr const char* finds_started = R"(    Bounded later;
    Velocity way[bodies];
{0}    exert($ss.q, s.time, s.v, {1}way, later);
    T rate[bounded], given[bounded];
    along($ss.q, s.time, s.v, rate);
    for (int i = 0; i < bodies; ++i) way[i] = still();
    for (int e = 0; e < bounded; ++e) {{
      for (int i = 0; i < bodies; ++i) way[i] = way[i] + mu[e] * (B.p[e][i] + B.u[e][i]);
    }}
    along($ss.q, s.time, way, given);
    for (int e = 0; e < bounded; ++e) {{
      if (!is_rate[e]) continue;
      const T missing = h * (B.c[e] - later.c[e]), half = T(0.5) * h;
      const T scale = magnitude(rate[e]) + magnitude(half * B.c[e] - missing) + magnitude(half * given[e] - missing);
      const auto strong = B.low[e] < T(-1e20) && B.high[e] > T(1e20);
      const auto reaches = magnitude(missing - half * given[e]) < T(0.5) * magnitude(missing);
      Mask& of_group = started[group_of_bound[e]];
      const auto struck = strong && reaches && magnitude(missing) > T(single ? 1e-3 : 1e-8) * scale;
      of_group = of_group || (begins[group_of_bound[e]] && struck);
    }}
)";
constexpr const char* start_by_joints = R"(    T lambda[rows];
    exert($ss.q, s.time, s.v, s.J, h, lambda, pull);
)";
constexpr const char* start_with_bounds = R"(    Bounded B;
    T mu[bounded], hold[bounded];
{0}    exert($ss.q, s.time, s.v, {1}pull, B);
    for (int i = 0; i < bounded; ++i) hold[i] = s.hold[i];
{2})";
constexpr const char* start_holds =
    "    for (int i = 0; i < bounded; ++i) s.hold[i] = select(begins[group_of_bound[i]], hold[i], s.hold[i]);\n";
constexpr const char* start_ends =
    R"(    for (int i = 0; i < bodies; ++i) s.pull[i] = choose(begins[group_of_body[i]], pull[i], s.pull[i]);
{}{}    for (T& of_group : s.begins) of_group = T(0);
  }}
)";
constexpr const char* start_lambda =
    "    for (int i = 0; i < rows; ++i) s.lambda[i] = select(begins[group_of_row[i]], lambda[i], s.lambda[i]);\n";

}  // namespace

std::string start_of(const Contents& has) {
  const bool motors = has.starts_motors();
  std::string text =
      fmt::format(start_begins, motors ? ", Mask (&started)[groups]" : "", motors ? forgets_started : "");
  if (has.bounded)
    text +=
        fmt::format(start_with_bounds, has.rows ? "    T lambda[rows];\n" : "", has.rows ? "s.J, h, lambda, " : "h, ",
                    has.loads ? settles_start_with_loads(has) : "    settle(B, hold, mu);\n") +
        fmt::format(sums_pulls, "", has.rows ? fmt::format(sums_lambda, "") : "", "", repeats_of_start(has)) +
        start_holds + sticking_rows_at_start(has);
  else text += start_by_joints;
  if (motors)
    text += fmt::format(finds_started, has.rows ? "    T unused[rows];\n" : "",
                        has.rows ? "s.J, T(2) * h, unused, " : "T(2) * h, ");
  text += shares(has, "lambda");
  return text + fmt::format(start_ends, has.rows ? start_lambda : "", repeats_at_start(has));
}

}  // namespace cdot::compile
