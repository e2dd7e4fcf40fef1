#include "derive/compile/methods/rates.hpp"

#include <fmt/format.h>

namespace cdot::compile {
namespace {

constexpr const char* damping = R"(
  // Rows of effects whose forces change with their rates, these effects, and numbers of K = J M^-1 J^T.
  static constexpr int damped = {}, dampers = {}, triangles = {};
)";

constexpr const char* finds_rates = R"(
  // The rate of one row by Newton: the sides found so far bracket it.
  struct RootSearch {{
    T low = T(-1e30), high = T(1e30), best = T(0), least = T(1e30), before = T(1e30);
    T step(const T& guess, const T& newton, const T& miss, const Mask& busy) {{
      const auto better = busy && miss < least, above = newton < T(0);
      best = select(better, guess, best), least = select(better, miss, least);
      high = select(busy && above, guess, high), low = select(busy && !above, guess, low);
      const T next = guess + newton;
      const auto bracketed = low > T(-1e29) && high < T(1e29), fits = low < next && next < high && T(2) * miss < before;
      before = select(busy, miss, before);
      return select(bracketed && !fits, T(0.5) * (low + high) - guess, newton);
    }}
  }};
  // The rates of such effects at the end, were each alone, by Newton. Of several rows a step that brings them no nearer
  // is halved. A lane that is done waits for the others unchanged.
  static void find_rates($dconst T (&C)[damped], const T (&rate)[damped], const T (&K)[triangles], const T& time,
                         const T& h, T (&given)[damped], T (&end)[damped]) {{
    constexpr int effect[damped] = {{{0}}};
    constexpr bool alone[dampers] = {{{1}}};
    T guess[damped], step[damped], miss[dampers], size[dampers];
    RootSearch of_row[damped];
    Mask busy[dampers], now[dampers];
    for (int i = 0; i < damped; ++i) guess[i] = rate[i];
    look($pC, rate, K, guess, time, h, step, given, end, miss, size);
    for (Mask& of_effect : busy) of_effect = T(0) < T(1);
    for (int round = 0; round < 60; ++round) {{
      T from[damped], way[damped], before[dampers];
      bool goes_on = false;
      for (int e = 0; e < dampers; ++e) {{
        if (!alone[e] && round >= 30) busy[e] = T(1) < T(0);
        busy[e] = busy[e] && miss[e] > T(single ? 1e-4 : 1e-6) * size[e];
        before[e] = miss[e], goes_on = goes_on || any(busy[e]);
      }}
      if (!goes_on) break;
      for (int i = 0; i < damped; ++i) {{
        const int e = effect[i];
        from[i] = guess[i], way[i] = alone[e] ? of_row[i].step(guess[i], step[i], miss[e], busy[e]) : step[i];
      }}
      T share = T(1);
      for (int halvings = 0; halvings < 20; ++halvings, share = T(0.5) * share) {{
        bool tries = false;
        for (int e = 0; e < dampers; ++e) {{
          now[e] = busy[e];
          if (halvings > 0) now[e] = alone[e] ? T(1) < T(0) : busy[e] && !(miss[e] < before[e]);
          tries = tries || any(now[e]);
        }}
        if (!tries) break;
        for (int i = 0; i < damped; ++i) guess[i] = select(now[effect[i]], from[i] + share * way[i], guess[i]);
        look($pC, rate, K, guess, time, h, step, given, end, miss, size);
      }}
      bool back = false;
      for (int e = 0; e < dampers; ++e) {{
        now[e] = busy[e] && !(miss[e] < before[e]);
        if (alone[e]) now[e] = T(1) < T(0);
        busy[e] = busy[e] && !now[e], back = back || any(now[e]);
      }}
      for (int i = 0; i < damped; ++i) guess[i] = select(now[effect[i]], from[i], guess[i]);
      if (back) look($pC, rate, K, guess, time, h, step, given, end, miss, size);
    }}
    auto back = T(1) < T(0);
    for (int i = 0; i < damped; ++i) {{
      const auto worse = miss[effect[i]] > of_row[i].least;
      guess[i] = select(worse, of_row[i].best, guess[i]), back = back || worse;
    }}
    if (any(back)) look($pC, rate, K, guess, time, h, step, given, end, miss, size);
  }}
)";

}  // namespace

std::string damping_of(std::size_t rows, int effects, std::size_t triangle) {
  return fmt::format(damping, rows, effects, triangle);
}

std::string find_rates_of(const std::vector<int>& effect_of) {
  std::vector<bool> alone;
  for (std::size_t row = 0; row < effect_of.size(); ++row) {
    const bool first = row == 0 || effect_of[row] != effect_of[row - 1];
    if (first) alone.push_back(true);
    else alone.back() = false;
  }
  return fmt::format(finds_rates, fmt::join(effect_of, ", "), fmt::join(alone, ", "));
}

}  // namespace cdot::compile
