#include "derive/compile/bounded/active_set.hpp"

#include <fmt/format.h>

namespace cdot::compile {
namespace {

// Four maxima and minima, side by side in the processor.
constexpr const char* largest_row = R"(
  // The largest size.
  template <int n>
  static T largest(const T (&x)[n]) {
    T a = T(0), b = a, c = a, d = a, e = a, f = a, g = a, h = a;
    int i = 0;
    for (; i + 4 <= n; i += 4) {
      a = larger(x[i], a), b = larger(x[i + 1], b), c = larger(x[i + 2], c), d = larger(x[i + 3], d);
      e = lower(x[i], e), f = lower(x[i + 1], f), g = lower(x[i + 2], g), h = lower(x[i + 3], h);
    }
    for (; i < n; ++i) a = larger(x[i], a), e = lower(x[i], e);
    return larger(-lower(lower(e, f), lower(g, h)), larger(larger(a, b), larger(c, d)));
  }
)";

constexpr const char* bounded_type = R"(
  // Rows with bounds: S mu + softness mu = c, mu between low and high. g and l are the velocities and the impulses of
  // joints that answer to a unit impulse on a row; K = J M^-1 J^T of the row alone.
  struct Bounded {{
    Velocity g[bounded][bodies];
{0}    T S[bounded * (bounded + 1) / 2], c[bounded], low[bounded], high[bounded], K[bounded];
  }};
  static constexpr bool is_rate[bounded] = {{{1}}};
)";

constexpr const char* solves_bounded = R"(
  static const T& entry(const T (&S)[bounded * (bounded + 1) / 2], int i, int j) {
    return i >= j ? S[i * (i + 1) / 2 + j] : S[j * (j + 1) / 2 + i];
  }

  // S mu = c in the free rows, with mu of the others given. S = L D L^T; a row that depends on others gets 0: what is
  // left of it is the round-off of what joints and other rows took from K.
  static void divide(const Bounded& B, const Mask (&free)[bounded], const T (&c)[bounded], T (&mu)[bounded]) {
    const auto& S = B.S;
    T U[bounded][bounded], L[bounded][bounded], inv_D[bounded], x[bounded], taken[bounded];
    for (int j = 0; j < bounded; ++j)
      for (int i = j; i < bounded; ++i) {
        T u = entry(S, i, j);
        if (i == j) taken[j] = larger(B.K[j], u);
        for (int k = 0; k < j; ++k) {
          if (i == j) taken[j] = taken[j] + L[j][k] * L[j][k] * taken[k];
          u = u - U[i][k] * L[j][k];
        }
        if (i == j) inv_D[j] = select(free[j], pivot(u, taken[j]), T(0));
        U[i][j] = u;
        L[i][j] = u * inv_D[j];
      }
    for (int i = 0; i < bounded; ++i) {
      x[i] = c[i];
      for (int j = 0; j < bounded; ++j) x[i] = x[i] - select(free[j], T(0), entry(S, i, j) * mu[j]);
      for (int k = 0; k < i; ++k) x[i] = x[i] - L[i][k] * x[k];
    }
    for (int i = bounded; i-- > 0;) {
      x[i] = x[i] * inv_D[i];
      for (int k = i + 1; k < bounded; ++k) x[i] = x[i] - L[k][i] * x[k];
      x[i] = select(free[i], x[i], T(0));
    }
    for (int i = 0; i < bounded; ++i) mu[i] = select(free[i], x[i], mu[i]);
  }

  // A row whose bounds are equal has no choice.
  static Mask is_free(const Bounded& B, const T (&hold)[bounded], int i) {
    return magnitude(hold[i]) < T(0.5) && B.low[i] < B.high[i];
  }

  // Rows beyond a bound take it; rows at a bound that they would leave are free again. First all at once, then one by
  // one (Murty). `hold`: -1 at the lower bound, 1 at the upper one, 0 free; it begins as it was in the last step. A
  // lane that is done waits for the others unchanged. True in lanes where a row reached or left a bound.
  static Mask find_active(Bounded& B, Mask busy, T (&hold)[bounded], T (&mu)[bounded], T (&missed)[bounded]) {
    constexpr int fast = 10, slow = 2 * bounded + 10;
    const T scale = largest(B.c);
    Mask moved = T(1) < T(0);
    for (int round = 0; round < fast + slow && any(busy); ++round) {
      Mask free[bounded];
      T now[bounded];
      for (int i = 0; i < bounded; ++i) free[i] = is_free(B, hold, i), now[i] = mu[i];
      divide(B, free, B.c, now);
      for (int i = 0; i < bounded; ++i) mu[i] = select(busy, now[i], mu[i]);
      for (int i = 0; i < bounded; ++i) {
        missed[i] = -B.c[i];
        for (int j = 0; j < bounded; ++j) missed[i] = missed[i] + entry(B.S, i, j) * mu[j];
      }
      auto changed = T(1) < T(0);
      for (int i = bounded; i-- > 0;) {
        const auto may = round < fast ? busy : busy && !changed;
        const auto down = may && free[i] && mu[i] < B.low[i], up = may && free[i] && mu[i] > B.high[i];
        const T tolerance = T(single ? 1e-5 : 1e-12) * scale;
        const auto leaves = (hold[i] < T(-0.5) && missed[i] < -tolerance) || (hold[i] > T(0.5) && missed[i] > tolerance);
        const auto out = may && !free[i] && leaves && B.low[i] < B.high[i];
        hold[i] = select(down, T(-1), select(up, T(1), select(out, T(0), hold[i])));
        mu[i] = select(down, B.low[i], select(up, B.high[i], mu[i]));
        changed = changed || down || up || out;
      }
      busy = busy && changed;
      moved = moved || busy;
    }
    return moved;
  }

  // The rows that row d depends on, with itself: those by whose impulses it could be replaced; and how these impulses
  // grow while that of row d does, without a change of the motion.
  static void find_contradiction(const Bounded& B, int d, const Mask (&free)[bounded], Mask (&rows_of_it)[bounded],
                                 T (&growth)[bounded]) {
    T c[bounded], x[bounded];
    Mask others[bounded];
    for (int i = 0; i < bounded; ++i) {
      others[i] = i == d ? T(1) < T(0) : free[i];
      c[i] = entry(B.S, i, d), x[i] = T(0);
    }
    divide(B, others, c, x);
    for (int i = 0; i < bounded; ++i) {
      rows_of_it[i] = i == d ? free[d] : free[i] && x[i] * x[i] * B.K[i] > T(single ? 1e-6 : 1e-12) * B.K[d];
      growth[i] = i == d ? T(1) : -x[i];
    }
  }

  // Rows that contradict each other: their impulses grow until one meets its bound, so rows with a bound ahead become
  // slightly soft. Without any, motors among them yield, `softness` times as soft as their rows; if ends contradict, all
  // yield.
  static Mask part(Bounded& B, const Mask& busy, const T (&hold)[bounded], const T (&missed)[bounded],
                   Mask (&yields)[bounded], const T& softness) {
    const T slight = T(single ? 1e-4 : 1e-9) * largest(B.c);
    Mask free[bounded], now[bounded], meets[bounded], rows_of_it[bounded];
    T growth[bounded];
    Mask some = T(1) < T(0), contradicts = some;
    for (int i = 0; i < bounded; ++i) free[i] = is_free(B, hold, i), now[i] = meets[i] = some;
    for (int d = 0; d < bounded; ++d) {
      const Mask unmet = busy && free[d] && magnitude(missed[d]) > slight && !yields[d];
      if (!any(unmet)) continue;
      find_contradiction(B, d, free, rows_of_it, growth);
      contradicts = contradicts || unmet;
      Mask by_bounds = T(1) < T(0);
      for (int i = 0; i < bounded; ++i) {
        const T ahead = select(growth[i] * missed[d] < T(0), B.high[i], B.low[i]);
        rows_of_it[i] = rows_of_it[i] && unmet && !yields[i];
        const Mask meets_it = rows_of_it[i] && magnitude(ahead) < T(1e20);
        meets[i] = meets[i] || meets_it, by_bounds = by_bounds || meets_it;
      }
      for (int i = 0; i < bounded; ++i)
        if (is_rate[i]) now[i] = now[i] || (rows_of_it[i] && !by_bounds);
    }
    for (int i = 0; i < bounded; ++i) some = some || now[i] || meets[i];
    for (int i = 0; i < bounded; ++i) {
      T& diagonal = B.S[i * (i + 1) / 2 + i];
      const T slightly = select(meets[i] || (contradicts && !some), T(single ? 1e-4 : 1e-8) * B.K[i], T(0));
      diagonal = diagonal + select(now[i], softness * B.K[i], slightly);
      yields[i] = yields[i] || now[i] || meets[i];
    }
    return contradicts;
  }

  // Parts contradicting rows until none is left. True in lanes where motors yielded, and then a row reached or left a
  // bound.
  static Mask part_and_settle(Bounded& B, Mask busy, T (&hold)[bounded], T (&mu)[bounded], const T& softness) {
    T missed[bounded];
    Mask yields[bounded];
    Mask eased = T(1) < T(0);
    for (Mask& of_row : yields) of_row = eased;
    for (int round = 0; any(busy); ++round) {
      const Mask moved = find_active(B, busy, hold, mu, missed);
      for (const Mask& of_row : yields) eased = eased || (moved && of_row);
      busy = round < 2 ? part(B, busy, hold, missed, yields, softness) : T(1) < T(0);
    }
    return eased;
  }

  static constexpr double usual_softness = 0.1;  // of motors that others hold
  static void settle(Bounded& B, T (&hold)[bounded], T (&mu)[bounded], const T& softness = T(usual_softness)) {
    T rigid[bounded];
    for (int i = 0; i < bounded; ++i) {
      const auto endless = (hold[i] < T(-0.5) && B.low[i] < T(-1e20)) || (hold[i] > T(0.5) && B.high[i] > T(1e20));
      hold[i] = select(endless, T(0), hold[i]);
      mu[i] = select(hold[i] < T(-0.5), B.low[i], select(hold[i] > T(0.5), B.high[i], T(0)));
      mu[i] = select(B.low[i] < B.high[i], mu[i], B.low[i]);
      rigid[i] = entry(B.S, i, i);
    }
    // A motor that yielded to a row now at its bound need not yield any more.
    if (const Mask eased = part_and_settle(B, T(0) < T(1), hold, mu, softness); any(eased)) {
      for (int i = 0; i < bounded; ++i) {
        T& diagonal = B.S[i * (i + 1) / 2 + i];
        diagonal = select(eased, rigid[i], diagonal);
      }
      part_and_settle(B, eased, hold, mu, softness);
    }
    for (int i = 0; i < bounded; ++i)
      mu[i] = select(mu[i] < B.low[i], B.low[i], select(mu[i] > B.high[i], B.high[i], mu[i]));
  }
)";

}  // namespace

std::string bounded_of(const std::string& is_rate, const Contents& has) {
  std::string text;
  if (has.rows || has.bounded || has.midpoint || has.snaps || has.collocated > 0) text += largest_row;
  if (!has.bounded) return text;
  const std::string impulses =
      std::string(has.rows ? "    T l[bounded][rows];\n" : "") +
      (has.loads ? "    T by_low[bounded], by_high[bounded];  // what each unit of a load adds to them\n" : "") +
      (has.rattle ? "    Velocity p[bounded][bodies], u[bounded][bodies];\n" : "");
  return text + fmt::format(bounded_type, impulses, is_rate) + solves_bounded;
}

}  // namespace cdot::compile
