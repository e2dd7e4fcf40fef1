#include "derive/compile/rows/bounds.hpp"

#include <cmath>
#include <fmt/format.h>

#include "derive/kernel/factor.hpp"
#include "derive/kernel/plan.hpp"

namespace cdot::compile {

using derive::element;

BoundWriter::BoundWriter(const RowBlocks& blocks, Algebra& algebra, std::size_t bounded)
    : blocks_(blocks),
      algebra_(algebra),
      number_(bounded),
      effect_(blocks.mechanism().bounded[bounded]),
      block_(blocks.bounded(bounded)),
      in_(blocks.inputs_with_jacobian(algebra, block_)),
      law_(blocks, algebra, effect_, block_, in_) {}

bool BoundWriter::has_events() const { return compile::has_events(blocks_, number_); }

int BoundWriter::acts() const {
  std::vector<int> factors;
  if (has_events()) factors.push_back(algebra_.input(element("events.acts", number_)));
  if (block_.holds >= 0) factors.push_back(in_.at("holds"));
  return algebra_.product(factors, std::vector<int>(factors.size(), 1));
}

int BoundWriter::along(const Values& velocities) const {
  Values in = in_;
  blocks_.replace_velocities(in, block_, velocities);
  return blocks_.call(algebra_, block_, "velocity", in).at("Jv[0]");
}

Values BoundWriter::bounds() const {
  const auto number = [&](std::size_t k, const char* name) {
    return blocks_.number(algebra_, effect_, k, block_.name + "_" + name);
  };
  switch (effect_.law) {
    case Effect::motor:
      return {{"B.rate", number(0, "speed")},
              {"B.lower", algebra_.sum({{number(1, "max")}, {-1}})},
              {"B.upper", number(1, "max")}};
    case Effect::limit: return {{"B.lower", number(0, "lower")}, {"B.upper", number(1, "upper")}};
    case Effect::lock: return {{"B.lower", number(0, "at")}, {"B.upper", number(0, "at")}};
    default: return law_.call(law_.spec().bounded[effect_.row].bounds);
  }
}

int BoundWriter::bound(const Values& bounds, const std::string& name, double missing) const {
  const auto found = bounds.find(name);
  return found == bounds.end() ? algebra_.value(missing) : found->second;
}

bool BoundWriter::is_rate() const {
  return effect_.law == Effect::motor || (effect_.law == Effect::bound && law_.spec().bounded[effect_.row].of_rate);
}

BoundWriter::Ends BoundWriter::ends() const {
  const Values B = bounds();
  const int lower = bound(B, "B.lower", -boundless), given = bound(B, "B.upper", boundless), C = law_.C()[0];
  const int upper = effect_.in_time.empty() ? given : law_.most(given, lower), zero = algebra_.value(0);
  const auto from = [&](int end) { return algebra_.sum({{C, end}, {1, -1}}); };
  Ends ends{from(lower), algebra_.sum({{upper, C}, {1, -1}}), zero, is_apart(lower, upper), zero, zero};
  ends.at_low = algebra_.sum({{ends.below, ends.above}, {1, -1}});
  if (effect_.in_time.empty()) return ends;
  const int low_rate = algebra_.by_time(lower), rate = algebra_.by_time(given);
  const auto of_nearer = [&](int low, int high) { return unless_held(ends, nearer(ends, low, high), low); };
  ends.rate = of_nearer(low_rate, rate);
  ends.acceleration = of_nearer(algebra_.by_time(low_rate), algebra_.by_time(rate));
  return ends;
}

// Constants decide at once, and ends of which one is missing; a coordinate that ends hold in time may be let go.
int BoundWriter::is_apart(int lower, int upper) const {
  const std::optional<double> low = algebra_.constant(lower), high = algebra_.constant(upper);
  if (effect_.law == Effect::lock || lower == upper || (low && high && *low >= *high)) return algebra_.value(0);
  if ((low && *low <= -boundless) || (high && *high >= boundless) || effect_.in_time.empty()) return algebra_.value(1);
  return algebra_.sum({{upper, lower}, {1, -1}});
}

int BoundWriter::nearer(const Ends& ends, int lower, int upper) const {
  return lower == upper ? lower : algebra_.function(Fn::select, {ends.at_low, lower, upper});
}

// Where equal ends hold the coordinate it is `held`.
int BoundWriter::unless_held(const Ends& ends, int number, int held) const {
  if (const std::optional<double> apart = algebra_.constant(ends.apart)) return *apart > 0 ? number : held;
  return algebra_.function(Fn::select, {ends.apart, number, held});
}

int BoundWriter::rate_change() const {
  const Values B = bounds();
  return effect_.in_time.empty() ? bound(B, "B.acceleration", 0) : algebra_.by_time(bound(B, "B.rate", 0));
}

BoundWriter::Kick BoundWriter::kick(int h) const { return while_it_acts(kick_while_it_acts(h)); }

BoundWriter::Kick BoundWriter::in_middle(int h) const {
  if (is_rate()) return kick(h);
  const int zero = algebra_.value(0), most = algebra_.value(boundless), least = algebra_.value(-boundless);
  const int side = algebra_.input(element("side", number_)), other = algebra_.sum({{side}, {-1}});
  return while_it_acts({algebra_.input(element("missed", number_)), zero,
                        algebra_.function(Fn::select, {side, zero, least}),
                        algebra_.function(Fn::select, {other, zero, most})});
}

// A row that does not act has no impulse.
BoundWriter::Kick BoundWriter::while_it_acts(Kick kick) const {
  if (!may_rest()) return kick;
  for (int* bound : {&kick.low, &kick.high})
    *bound = algebra_.function(Fn::select, {acts(), *bound, algebra_.value(0)});
  return kick;
}

int BoundWriter::distance(const std::optional<Program>& event) const {
  if (!event) return algebra_.value(boundless);
  if (!effect_.by_own_force) return law_.call(*event).at("D");
  const int load = algebra_.function(Fn::abs, {algebra_.input(element("force", number_))});
  return law_.with_load(load).call(*event).at("D");
}

BoundWriter::Kick BoundWriter::kick_while_it_acts(int h) const {
  if (effect_.acts_by_force()) return of_force(h);
  return is_rate() ? of_rate(h) : of_ends(h);
}

// A row that does not act serves no end, and has no force.
BoundWriter::Guard BoundWriter::guard() const {
  Guard guard = guard_while_it_acts();
  if (!may_rest()) return guard;
  for (int* number : {&guard.off, &guard.rate, &guard.low, &guard.high, &guard.acceleration})
    *number = algebra_.function(Fn::select, {acts(), *number, algebra_.value(0)});
  return guard;
}

// As the World does it at the start of a run: runtime/step/kick_drift.cpp.
BoundWriter::Kick BoundWriter::while_it_is_met() const {
  constexpr double foreign = 1e-8;
  const Guard at = guard();
  const Ends ends = this->ends();
  const int zero = algebra_.value(0), within = algebra_.value(foreign * std::min(1.0, 10 * effect_.size));
  const int off = algebra_.sum({{algebra_.function(Fn::abs, {at.off}), within}, {1, -1}});
  const auto met = [&](int bound) {
    return unless_held(ends, algebra_.function(Fn::select, {off, zero, bound}), zero);
  };
  return {zero, zero, met(at.low), met(at.high)};
}

BoundWriter::ByLoad BoundWriter::by_load() const {
  const int zero = algebra_.value(0);
  if (!effect_.is_loaded()) return {zero, zero};
  const Values B = law_.call(*law_.spec().bounded[effect_.row].by_load);
  ByLoad by{bound(B, "B.lower", 0), bound(B, "B.upper", 0)};
  if (may_rest())
    for (int* number : {&by.low, &by.high}) *number = algebra_.function(Fn::select, {acts(), *number, zero});
  return by;
}

void BoundWriter::output_by_load() const {
  const ByLoad by = by_load();
  algebra_.output("B." + element("by_low", number_), by.low);
  algebra_.output("B." + element("by_high", number_), by.high);
}

BoundWriter::Guard BoundWriter::guard_while_it_acts() const {
  const int zero = algebra_.value(0);
  if (is_rate()) {
    const Values B = bounds();
    const int lower = bound(B, "B.lower", -boundless), upper = law_.most(bound(B, "B.upper", boundless), lower);
    return {zero, bound(B, "B.rate", 0), lower, upper, rate_change()};
  }
  const Ends ends = this->ends();
  const int off = nearer(ends, ends.above, algebra_.sum({{ends.below}, {-1}}));
  const Kick served = bounds_at(ends);
  return {unless_held(ends, off, ends.above), ends.rate, served.low, served.high, ends.acceleration};
}

// As the World's (runtime/events/events.cpp):
//   value  c, the largest change of C by a displacement of the mechanism's size or a rotation of 1 rad
//   rate   the largest of the sum of all |J v|, sqrt(c dJv/dt), and epsilon c / (slight h)
//   force  (dJv/dt + rate^2 / c) / K
//   hop    6 c a, the square of a rate
// dJv/dt: the larger of the sum of all |J dv/dt|, angular accelerations being at least linear / size, and K |force|.
// a: the larger of |J dv/dt| and K |force|.
BoundWriter::Resolution BoundWriter::resolution() const {
  const auto inverse = [&](int x) { return algebra_.function(Fn::inverse, {x}); };
  const Sizes sizes = sizes_of_terms();
  const int size = algebra_.value(effect_.size), c = algebra_.function(Fn::select, {sizes.value, sizes.value, size});
  const int K_own = blocks_.call(algebra_, block_, "effective_mass", in_).at(derive::triangle_element("K", 0, 0));
  const int K = algebra_.function(Fn::select, {K_own, K_own, algebra_.sum(sizes.masses)});
  const int force = algebra_.function(Fn::abs, {algebra_.input(element("force", number_))});
  const int by_force = algebra_.times(K, force), acceleration = law_.most(algebra_.sum(sizes.accelerations), by_force);
  const int along = law_.most(algebra_.function(Fn::abs, {algebra_.sum(sizes.along)}), by_force);
  const int least =
      algebra_.product({algebra_.input("T(epsilon / slight)"), c, inverse(algebra_.input("h"))}, {1, 1, 1});
  const int by_way = algebra_.function(Fn::sqrt, {algebra_.times(acceleration, c)});
  const int rate = law_.most(law_.most(algebra_.sum(sizes.rates), by_way), least);
  const int way = algebra_.product({rate, inverse(c)}, {2, 1});
  return {c, rate, algebra_.times(algebra_.sum({{acceleration, way}, {1, 1}}), inverse(K)),
          algebra_.product({algebra_.value(6), c, along}, {1, 1, 1})};
}

BoundWriter::Sizes BoundWriter::sizes_of_terms() const {
  const Mechanism& all = blocks_.mechanism();
  const Values J = blocks_.call(algebra_, block_, "dense", in_);
  const int size = algebra_.value(effect_.size), zero = algebra_.value(0);
  Sizes sizes{zero, {}, {}, {}, {}};
  for (std::size_t k = 0; k < block_.bodies->size(); ++k) {
    const int index = (*block_.bodies)[k];
    const Body& body = all.bodies[static_cast<std::size_t>(index)];
    if (!body.moves) continue;
    sizes.masses.add(1, algebra_.value(body.inv_m));
    int linear = zero;
    for (std::size_t i = 0; i < all.columns(); ++i) {
      const auto component = [&](const char* array) {
        return algebra_.input(fmt::format("{}[{}].{}", array, blocks_.body_name(index), all.column(i)));
      };
      const auto size_of = [&](int number) { return algebra_.function(Fn::abs, {number}); };
      const bool straight = i < all.linear();
      const int slope = J.at(element(element("D", 0), all.columns() * k + i)), j = size_of(slope),
                dv = size_of(component("a"));
      if (straight) linear = law_.most(linear, dv);
      sizes.value = law_.most(sizes.value, straight ? algebra_.times(j, size) : j);
      sizes.rates.add(1, algebra_.times(j, size_of(component("v"))));
      sizes.along.add(1, algebra_.times(slope, component("a")));
      const int per_size = algebra_.times(linear, algebra_.value(1 / effect_.size));
      sizes.accelerations.add(1, algebra_.times(j, straight ? dv : law_.most(dv, per_size)));
    }
  }
  return sizes;
}

// J v' = rate by a force within its bounds.
BoundWriter::Kick BoundWriter::of_rate(int h) const {
  const Values B = bounds();
  const int lower = bound(B, "B.lower", -boundless), rate = bound(B, "B.rate", 0);
  const int upper = law_.most(bound(B, "B.upper", boundless), lower);
  return {algebra_.sum({{rate}, {-1}}), algebra_.value(0), algebra_.times(h, lower), algebra_.times(h, upper)};
}

// The force pushes away from the nearer end. Equal ends hold the coordinate.
BoundWriter::Kick BoundWriter::bounds_at(const Ends& ends) const {
  const int zero = algebra_.value(0), most = algebra_.value(boundless), least = algebra_.value(-boundless);
  return {zero, zero, unless_held(ends, nearer(ends, zero, least), least),
          unless_held(ends, nearer(ends, most, zero), most)};
}

// One row serves the nearer end: C may shrink to it within the step, but not further than the end moves.
BoundWriter::Kick BoundWriter::of_ends(int h) const {
  const Ends ends = this->ends();
  const int zero = algebra_.value(0), gap = nearer(ends, ends.above, ends.below);
  const int way = algebra_.times(law_.most(gap, zero), algebra_.function(Fn::inverse, {h}));
  const int bias = unless_held(ends, nearer(ends, way, algebra_.sum({{way}, {-1}})), zero);
  Kick kick = bounds_at(ends);
  kick.bias = algebra_.sum({{bias, ends.rate}, {1, -1}});
  return kick;
}

// As an effect by its force, but with that within limits: lambda = h (F + d rate) - s J v', s = h (d + h k).
BoundWriter::Kick BoundWriter::of_force(int h) const {
  const int F = law_.force_without_limits()[0];
  const LawWriter::Slopes slopes = law_.slopes();
  const int both = algebra_.sum({{slopes.d[0], algebra_.times(h, slopes.k[0])}, {1, 1}});
  const int s = algebra_.times(h, both), tiny = algebra_.value(1e-20);
  const int softness = algebra_.function(Fn::inverse, {law_.most(s, tiny)});
  const int force = algebra_.sum({{F, algebra_.times(slopes.d[0], law_.rate()[0])}, {1, 1}});
  const int bias = algebra_.sum({{algebra_.product({h, force, softness}, {1, 1, 1})}, {-1}});
  if (effect_.pulls) return of_pull(h, bias, softness);
  const Values limits = law_.call(law_.spec().rows.function("limits"));
  return {bias, softness, algebra_.times(h, limits.at("lower[0]")), algebra_.times(h, limits.at("upper[0]"))};
}

// A slack rope may become taut within the step, but not longer.
BoundWriter::Kick BoundWriter::of_pull(int h, int bias, int softness) const {
  const int C = law_.C()[0], zero = algebra_.value(0), way = algebra_.times(C, algebra_.function(Fn::inverse, {h}));
  const auto if_slack = [&](int slack, int taut) { return algebra_.function(Fn::select, {C, slack, taut}); };
  return {if_slack(way, bias), if_slack(zero, softness), zero, algebra_.value(boundless)};
}

bool BoundWriter::holds() const {
  const std::optional<double> apart = algebra_.constant(ends().apart);
  return apart && *apart <= 0;
}

// The part of C beyond the end.
int BoundWriter::past() const {
  const int zero = algebra_.value(0);
  if (!has_ends(blocks_, number_)) return zero;
  const Ends ends = this->ends();
  const int minus = algebra_.sum({{ends.below}, {-1}});
  const int past = unless_held(ends, nearer(ends, law_.least(ends.above, zero), law_.most(minus, zero)), ends.above);
  return may_rest() ? algebra_.function(Fn::select, {acts(), past, zero}) : past;
}

BoundWriter::End BoundWriter::nearest() const {
  End end = nearest_while_it_acts();
  if (!may_rest()) return end;
  for (int* of : {&end.off, &end.side}) *of = algebra_.function(Fn::select, {acts(), *of, algebra_.value(0)});
  return end;
}

int BoundWriter::drift_from_end() const {
  if (!has_ends(blocks_, number_)) return algebra_.value(0);
  const int moves = algebra_.sum({{drift(), ends().rate}, {1, -1}});
  const bool may_vanish = may_rest() && !algebra_.is_zero(moves);
  return may_vanish ? algebra_.function(Fn::select, {acts(), moves, algebra_.value(0)}) : moves;
}

BoundWriter::End BoundWriter::nearest_while_it_acts() const {
  const int zero = algebra_.value(0);
  if (!has_ends(blocks_, number_)) return {zero, zero};
  const Ends ends = this->ends();
  const int side = nearer(ends, algebra_.value(1), algebra_.value(-1));
  return {unless_held(ends, nearer(ends, ends.above, algebra_.sum({{ends.below}, {-1}})), ends.above),
          unless_held(ends, side, zero)};
}

}  // namespace cdot::compile
