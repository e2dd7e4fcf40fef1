#include "derive/compile/rows/bounds.hpp"

#include <cmath>

#include "derive/kernel/factor.hpp"

namespace cdot::compile {
namespace {

constexpr double boundless = 1e30;  // in float, too

}  // namespace

bool prescribes_rate(const RowBlocks& blocks, std::size_t bounded) {
  const Effect& effect = blocks.mechanism().bounded[bounded];
  return effect.law == Effect::motor || (effect.law == Effect::bound && blocks.law(effect).bounded[effect.row].of_rate);
}

bool has_events(const RowBlocks& blocks, std::size_t bounded) {
  const Effect& effect = blocks.mechanism().bounded[bounded];
  return effect.law == Effect::bound && blocks.law(effect).bounded[effect.row].has_events();
}

bool waits(const RowBlocks& blocks, std::size_t bounded) {
  const Effect& effect = blocks.mechanism().bounded[bounded];
  return effect.law == Effect::bound && blocks.law(effect).bounded[effect.row].after;
}

Program distances_of(const RowBlocks& blocks, Constants& constants) {
  Algebra algebra(constants);
  for (std::size_t b = 0; b < blocks.mechanism().bounded.size(); ++b) {
    const Effect& effect = blocks.mechanism().bounded[b];
    const BoundWriter row(blocks, algebra, b);
    const bool of_spec = effect.law == Effect::bound;
    const std::optional<Program> none;
    algebra.output(derive::element("after", b),
                   row.distance(of_spec ? blocks.law(effect).bounded[effect.row].after : none));
    algebra.output(derive::element("until", b),
                   row.distance(of_spec ? blocks.law(effect).bounded[effect.row].until : none));
  }
  return algebra.finish();
}

bool has_ends(const RowBlocks& blocks, std::size_t bounded) {
  return !prescribes_rate(blocks, bounded) && blocks.mechanism().bounded[bounded].law != Effect::limited;
}

BoundWriter::BoundWriter(const RowBlocks& blocks, Algebra& algebra, std::size_t bounded)
    : blocks_(blocks),
      algebra_(algebra),
      number_(bounded),
      effect_(blocks.mechanism().bounded[bounded]),
      block_(blocks.bounded(bounded)),
      in_(blocks.inputs_with_jacobian(algebra, block_)),
      law_(blocks, algebra, effect_, block_, in_) {}

int BoundWriter::along(const Values& velocities) const {
  Values in = in_;
  blocks_.replace_velocities(in, block_, velocities);
  return blocks_.call(algebra_, block_, "velocity", in).at("Jv[0]");
}

Values BoundWriter::bounds() const {
  const auto number = [&](std::size_t k, const char* name) {
    const std::string full = block_.name + "_" + name;
    return effect_.in_time.contains(k) ? blocks_.number(algebra_, effect_, k, full)
                                       : algebra_.value(std::clamp(effect_.numbers[k], -boundless, boundless), full);
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

bool BoundWriter::are_equal(int lower, int upper) const {
  const std::optional<double> low = algebra_.constant(lower), high = algebra_.constant(upper);
  return effect_.law == Effect::lock || (low && high && *low >= *high);
}

int BoundWriter::rate_change() const {
  const auto speed = effect_.in_time.find(0);
  if (effect_.law != Effect::motor || speed == effect_.in_time.end()) return algebra_.value(0);
  return blocks_.in_time(algebra_, speed->second, "rate", block_.name + "_speed");
}

// A row that does not act has no impulse.
BoundWriter::Kick BoundWriter::kick(int h) const {
  Kick kick = kick_while_it_acts(h);
  if (!has_events(blocks_, number_)) return kick;
  for (int* bound : {&kick.low, &kick.high})
    *bound = algebra_.function(Fn::select, {acts(), *bound, algebra_.value(0)});
  return kick;
}

int BoundWriter::distance(const std::optional<Program>& event) const {
  return event ? law_.call(*event).at("D") : algebra_.value(boundless);
}

BoundWriter::Kick BoundWriter::kick_while_it_acts(int h) const {
  if (effect_.law == Effect::limited) return of_force(h);
  return is_rate() ? of_rate(h) : of_ends(h);
}

// J v' = rate by a force within its bounds.
BoundWriter::Kick BoundWriter::of_rate(int h) const {
  const Values B = bounds();
  const int lower = bound(B, "B.lower", -boundless), rate = bound(B, "B.rate", 0);
  const int upper = law_.most(bound(B, "B.upper", boundless), lower);
  return {algebra_.sum({{rate}, {-1}}), algebra_.value(0), algebra_.times(h, lower), algebra_.times(h, upper)};
}

// One row serves the nearer end: C may shrink to it within the step, but not further. Equal ends hold the coordinate.
BoundWriter::Kick BoundWriter::of_ends(int h) const {
  const Values B = bounds();
  const int zero = algebra_.value(0), most = algebra_.value(boundless), least = algebra_.value(-boundless);
  const int lower = bound(B, "B.lower", -boundless), upper = bound(B, "B.upper", boundless), C = law_.C()[0];
  if (are_equal(lower, upper)) return {zero, zero, least, most};
  const int above = algebra_.sum({{C, lower}, {1, -1}}), below = algebra_.sum({{upper, C}, {1, -1}});
  const int at_low = algebra_.sum({{below, above}, {1, -1}}), per_time = algebra_.function(Fn::inverse, {h});
  const int gap = algebra_.function(Fn::select, {at_low, above, below});
  const int bias = algebra_.times(law_.most(gap, zero), per_time);
  return {algebra_.function(Fn::select, {at_low, bias, algebra_.sum({{bias}, {-1}})}), zero,
          algebra_.function(Fn::select, {at_low, zero, least}), algebra_.function(Fn::select, {at_low, most, zero})};
}

// As an effect by its force, but with that within limits: lambda = h (F + d rate) - s J v', s = h (d + h k).
BoundWriter::Kick BoundWriter::of_force(int h) const {
  const int F = law_.force_without_limits()[0];
  const LawWriter::Slopes slopes = law_.slopes();
  const Values limits = law_.call(law_.spec().rows.function("limits"));
  const int both = algebra_.sum({{slopes.d[0], algebra_.times(h, slopes.k[0])}, {1, 1}});
  const int s = algebra_.times(h, both), tiny = algebra_.value(1e-20);
  const int softness = algebra_.function(Fn::inverse, {law_.most(s, tiny)});
  const int force = algebra_.sum({{F, algebra_.times(slopes.d[0], law_.rate()[0])}, {1, 1}});
  return {algebra_.sum({{algebra_.product({h, force, softness}, {1, 1, 1})}, {-1}}), softness,
          algebra_.times(h, limits.at("lower[0]")), algebra_.times(h, limits.at("upper[0]"))};
}

int BoundWriter::past() const {
  const int past = past_while_it_acts();
  return has_events(blocks_, number_) ? algebra_.function(Fn::select, {acts(), past, algebra_.value(0)}) : past;
}

int BoundWriter::past_while_it_acts() const {
  const int zero = algebra_.value(0), C = law_.C()[0];
  if (effect_.law == Effect::limited || is_rate()) return zero;
  const Values B = bounds();
  const int lower = bound(B, "B.lower", -boundless), upper = bound(B, "B.upper", boundless);
  const int above = algebra_.sum({{C, lower}, {1, -1}}), below = algebra_.sum({{upper, C}, {1, -1}});
  if (are_equal(lower, upper)) return above;
  const int at_low = algebra_.sum({{below, above}, {1, -1}});
  return algebra_.function(Fn::select,
                           {at_low, law_.least(above, zero), law_.most(algebra_.sum({{below}, {-1}}), zero)});
}

}  // namespace cdot::compile
