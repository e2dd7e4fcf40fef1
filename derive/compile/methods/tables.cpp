#include "derive/compile/methods/tables.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace cdot::compile {
namespace {

constexpr const char* followed_type = R"(
  // A number that follows a table of time.
  struct Followed {
    T value, rate, acceleration;
  };
  // The last row that no lane comes before, or the first one: lanes mostly share a time, so few rows are left.
  template <unsigned rows>
  static unsigned first_row(const double (&times)[rows], const T& time) {
    unsigned first = 0;
    for (unsigned end = rows; end - first > 1;) {
      const unsigned middle = first + (end - first) / 2;
      (any(time < T(times[middle])) ? end : first) = middle;
    }
    return first;
  }
)";

constexpr const char* table =
    R"(  // Cubics between the rows, in the time since the first row of each; before and after them a constant.
  static Followed table_{0}(const T& time) {{
    static constexpr double times[] = {{{1}}};
    static constexpr double pieces[][4] = {{{2}}};
    T begin = T(0), a = T({3}), b = T(0), c = T(0), d = T(0);
{4}    for (unsigned k = first_row(times, {5}); k < sizeof times / sizeof times[0]; ++k) {{
      const auto later = !({5} < T(times[k]));
      if (!any(later)) break;
      begin = select(later, T(times[k]), begin), a = select(later, T(pieces[k][0]), a);
      b = select(later, T(pieces[k][1]), b), c = select(later, T(pieces[k][2]), c), d = select(later, T(pieces[k][3]), d);
    }}
    const T t = {5} - begin;
    return {{a + t * (b + t * (c + t * d)), b + t * (T(2) * c + t * T(3) * d), T(2) * c + t * T(6) * d}};
  }}
)";

// Rounded by adding a large number; then the whole periods before.
constexpr const char* periods =
    R"(    constexpr double to_integer = single ? 12582912.0 : 6755399441055744.0;  // 1.5 times a power of 2
    const T share = (time - T({0})) * T({1}), near = share + T(to_integer) - T(to_integer);
    const T shift = T({2}) * select(near > share, near - T(1), near);
)";

constexpr const char* next_break = R"(
  // The first time later than this one at which a number breaks.
  static T next_break(const T& time) {
    T next = T(1e30);
)";

constexpr const char* breaks_of_table = R"(    {{
      static constexpr double breaks[] = {{{0}}};
{1}      for (unsigned k = first_row(breaks, time{2}); k < sizeof breaks / sizeof breaks[0]; ++k) {{
        const T of_row = T(breaks[k]){3};
        next = select(of_row > time && of_row < next, of_row, next);
        if (!any(!(of_row > time))) break;
      }}
    }}
)";

constexpr const char* parts_begin = R"(
  // Goes on from the time of a break, in the lanes of `now`, with the numbers after it: beyond round-off.
  static void pass(State& s, const T& at, const Mask& now) {
    State after = s;
    after.time = at + T(4 * epsilon) * at;
)";

constexpr const char* passed = R"(    replace(s, after, now);
  }
  // How near a break is to the start or the end of a step that was meant to start or to end there.
  static T near_to(const T& time, const T& h) {
    const T round_off = T(4 * epsilon) * magnitude(time), near = T(1e-9) * h;
    return select(near > round_off, near, round_off);
  }

  // In parts that end where a number in time breaks: they end with the value before, and the next part begins with that
  // after. A lane that is done waits for the others unchanged.
  static T step(State& s, T h = T(default_step)) {
    const T end = s.time + h, begin = next_break(s.time);
    const auto begins_there = begin - s.time <= near_to(s.time, h);
    if (any(begins_there)) pass(s, begin, begins_there);
    T left = h, residual = T(0);
    for (auto goes_on = T(0) < T(1); any(goes_on);) {
      const T at = next_break(s.time + near_to(s.time, h)), way = at - s.time;
      const auto meets = goes_on && way < left;
      State next = s;
      const T error = advance(next, select(meets, way - T(4 * epsilon) * at, select(goes_on, left, h)));
      if (any(meets)) pass(next, at, meets);
      replace(s, next, goes_on);
      residual = select(goes_on, error, residual);
      left = end - s.time;
      goes_on = meets && left > near_to(s.time, h);
    }
    return residual;
  }
)";

std::string numbers(const std::vector<double>& list) { return fmt::format("{}", fmt::join(list, ", ")); }

std::string shifted(const Table& of, double from) {
  const double period = of.times.back() - of.times.front();
  return fmt::format(periods, from, 1 / period, period);
}

std::string text_of(const Table& of, std::size_t number) {
  std::string pieces;
  for (const auto& piece : of.pieces)
    pieces += fmt::format("{}{{{}, {}, {}, {}}}", pieces.empty() ? "" : ", ", piece[0], piece[1], piece[2], piece[3]);
  return fmt::format(table, number, numbers(of.times), pieces, of.pieces.front()[0],
                     of.repeats ? shifted(of, of.times.front()) : "", of.repeats ? "(time - shift)" : "time");
}

}  // namespace

bool breaks(const Mechanism& mechanism) {
  return std::ranges::any_of(mechanism.tables, [](const Table& of) { return !of.breaks.empty(); });
}

// Of a table that repeats, the breaks of this period and of the next one.
std::string tables_of(const Mechanism& mechanism) {
  if (mechanism.tables.empty()) return {};
  std::string text = followed_type;
  for (std::size_t k = 0; k < mechanism.tables.size(); ++k) text += text_of(mechanism.tables[k], k);
  if (!breaks(mechanism)) return text;
  text += next_break;
  for (const Table& of : mechanism.tables) {
    if (of.breaks.empty()) continue;
    std::vector<double> times = of.breaks;
    for (const double at : of.breaks)
      if (of.repeats) times.push_back(at + of.times.back() - of.times.front());
    text += fmt::format(breaks_of_table, numbers(times), of.repeats ? shifted(of, of.times.front()) : "",
                        of.repeats ? " - shift" : "", of.repeats ? " + shift" : "");
  }
  return text + "    return next;\n  }\n";
}

std::string step_in_parts(Method method, const Contents& has) {
  std::string text = parts_begin;
  const bool accelerates = works_on_accelerations(method) && !has.strides();
  if (method != Method::euler && has.rows) text += "    evaluate($safter.q, after.time, after.J);\n";
  if (method != Method::euler && has.rows && !has.strides()) text += "    project(after);\n";
  if (has.strides()) text += "    after.modes.known = T(0);\n";
  if (accelerates && has.rows)
    text += "    accelerate($safter.q, after.time, after.v, after.J, after.lambda, after.a);\n";
  if (accelerates && !has.rows) text += "    fall($safter.q, after.time, after.v, after.a);\n";
  if (has.pulls()) text += "    for (Velocity& of_body : after.pull) of_body = still();\n";
  if (has.pulls() && has.rows) text += "    for (T& of_row : after.lambda) of_row = T(0);\n";
  if (has.exerts) text += "    for (T& of_group : after.begins) of_group = T(1);\n";
  return text + passed;
}

}  // namespace cdot::compile
