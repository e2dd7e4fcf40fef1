#include "derive/compile/rows/bounds.hpp"

#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "derive/kernel/factor.hpp"
#include "derive/kernel/plan.hpp"

namespace cdot::compile {

using derive::element;

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
    algebra.output(element("after", b), row.distance(of_spec ? blocks.law(effect).bounded[effect.row].after : none));
    algebra.output(element("until", b), row.distance(of_spec ? blocks.law(effect).bounded[effect.row].until : none));
  }
  return algebra.finish_as_kernels();
}

Program strain_of(const RowBlocks& blocks, Constants& constants) {
  Algebra algebra(constants);
  for (std::size_t k = 0; k < blocks.mechanism().bonds.size(); ++k) {
    const Bond& bond = blocks.mechanism().bonds[k];
    const SpecPrograms& spec = blocks.bond(bond);
    const std::string& owner = bond.joint < 0 ? blocks.bounded(static_cast<std::size_t>(bond.rope)).name
                                              : blocks.joint(static_cast<std::size_t>(bond.joint)).name;
    Values in;
    for (std::size_t p = 0; p < spec.parameters.size(); ++p)
      in[spec.parameters[p]] =
          algebra.value(bond.numbers[p], fmt::format("{}_{}_{}", owner, bond.type, spec.parameters[p]));
    in["pi"] = algebra.value(std::numbers::pi);
    in["time"] = algebra.input("time");
    in[derive::bounded_load] = algebra.input(element("load", static_cast<std::size_t>(bond.holds)));
    const Values out = algebra.inlined(
        *spec.bounded.front().breaks, [&](const std::string& text) { return in.at(text); }, "bond");
    algebra.output(element("from", k), out.at("D"));
  }
  return algebra.finish();
}

Program guard_of(const RowBlocks& blocks, Constants& constants) {
  Algebra algebra(constants);
  for (std::size_t b = 0; b < blocks.mechanism().bounded.size(); ++b) {
    const BoundWriter row(blocks, algebra, b);
    const BoundWriter::Guard guard = row.guard();
    const int missing = algebra.sum({{guard.rate, row.rate()}, {1, -1}});
    algebra.output("B." + element("off", b), guard.off);
    algebra.output("B." + element("missing", b), missing);
    algebra.output("B." + element("low", b), guard.low);
    algebra.output("B." + element("high", b), guard.high);
    if (blocks.mechanism().has_loads()) row.output_by_load();
  }
  return algebra.finish_as_kernels();
}

Program resolve_of(const RowBlocks& blocks, Constants& constants) {
  Algebra algebra(constants);
  for (std::size_t b = 0; b < blocks.mechanism().bounded.size(); ++b) {
    const BoundWriter::Resolution resolution = BoundWriter(blocks, algebra, b).resolution();
    algebra.output(element("of_value", b), resolution.value);
    algebra.output(element("of_rate", b), resolution.rate);
    algebra.output(element("of_force", b), resolution.force);
  }
  return algebra.finish();
}

namespace {

// The resultant force of a joint's rows, by the linear columns of its last body that moves.
int force_of(const RowBlocks& blocks, const JointRows& joints, Algebra& algebra, int joint) {
  const Mechanism& all = blocks.mechanism();
  const RowSystem& system = joints.system();
  std::size_t k = 0;
  while (system.blocks()[k].name != blocks.joint(static_cast<std::size_t>(joint)).name) ++k;
  const RowBlock& block = system.blocks()[k];
  std::size_t last = block.bodies->size() - 1;
  while (last > 0 && !all.bodies[static_cast<std::size_t>((*block.bodies)[last])].moves) --last;
  const Values J = blocks.call(algebra, block, "dense", joints.inputs(algebra, k));
  Summands squares;
  for (std::size_t c = 0; c < all.linear(); ++c) {
    Summands force;
    for (std::size_t r = 0; r < block.rows->count(); ++r)
      force.add(1, algebra.times(J.at(element(element("D", r), all.columns() * last + c)),
                                 algebra.input(element("lambda", system.first_row(k) + r))));
    squares.add(1, algebra.product({algebra.sum(force)}, {2}));
  }
  return algebra.function(Fn::sqrt, {algebra.sum(squares)});
}

}  // namespace

Program carry_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants) {
  Algebra algebra(constants);
  for (std::size_t b = 0; b < blocks.mechanism().bounded.size(); ++b) {
    const Effect& effect = blocks.mechanism().bounded[b];
    int load = algebra.value(0);
    if (effect.loaded_by_row >= 0) {
      const std::string force = element("force", static_cast<std::size_t>(effect.loaded_by_row));
      load = algebra.function(Fn::abs, {algebra.input(force)});
    }
    if (effect.loaded_by_joint >= 0) load = force_of(blocks, joints, algebra, effect.loaded_by_joint);
    algebra.output(element("load", b), load);
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
  if (effect_.law == Effect::limited) return of_force(h);
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
  const int zero = algebra_.value(0);
  if (algebra_.is_zero(nearest_while_it_acts().side)) return {zero, zero, zero, zero};  // a lock
  const int within = algebra_.value(foreign * std::min(1.0, 10 * effect_.size));
  const int off = algebra_.sum({{algebra_.function(Fn::abs, {at.off}), within}, {1, -1}});
  return {zero, zero, algebra_.function(Fn::select, {off, zero, at.low}),
          algebra_.function(Fn::select, {off, zero, at.high})};
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
  const Values B = bounds();
  const int zero = algebra_.value(0), least = algebra_.value(-boundless), most = algebra_.value(boundless);
  const int lower = bound(B, "B.lower", -boundless), upper = law_.most(bound(B, "B.upper", boundless), lower);
  if (is_rate()) {
    const int acceleration = effect_.law == Effect::motor ? rate_change() : bound(B, "B.acceleration", 0);
    return {zero, bound(B, "B.rate", 0), lower, upper, acceleration};
  }
  const int C = law_.C()[0], above = algebra_.sum({{C, lower}, {1, -1}}), below = algebra_.sum({{upper, C}, {1, -1}});
  if (are_equal(lower, upper)) return {above, zero, least, most, zero};
  const int at_low = algebra_.sum({{below, above}, {1, -1}});
  return {algebra_.function(Fn::select, {at_low, above, algebra_.sum({{below}, {-1}})}), zero,
          algebra_.function(Fn::select, {at_low, zero, least}), algebra_.function(Fn::select, {at_low, most, zero}),
          zero};
}

// As the World's (runtime/events/events.cpp):
//   value  c, the largest change of C by a displacement of the mechanism's size or a rotation of 1 rad
//   rate   the largest of the sum of all |J v|, sqrt(c dJv/dt), and epsilon c / (slight h)
//   force  (dJv/dt + rate^2 / c) / K
// dJv/dt: the larger of the sum of all |J dv/dt|, angular accelerations being at least linear / size, and K |force|.
BoundWriter::Resolution BoundWriter::resolution() const {
  const auto inverse = [&](int x) { return algebra_.function(Fn::inverse, {x}); };
  const Sizes sizes = sizes_of_terms();
  const int size = algebra_.value(effect_.size), c = algebra_.function(Fn::select, {sizes.value, sizes.value, size});
  const int K_own = blocks_.call(algebra_, block_, "effective_mass", in_).at(derive::triangle_element("K", 0, 0));
  const int K = algebra_.function(Fn::select, {K_own, K_own, algebra_.sum(sizes.masses)});
  const int force = algebra_.function(Fn::abs, {algebra_.input(element("force", number_))});
  const int acceleration = law_.most(algebra_.sum(sizes.accelerations), algebra_.times(K, force));
  const int least =
      algebra_.product({algebra_.input("T(epsilon / slight)"), c, inverse(algebra_.input("h"))}, {1, 1, 1});
  const int by_way = algebra_.function(Fn::sqrt, {algebra_.times(acceleration, c)});
  const int rate = law_.most(law_.most(algebra_.sum(sizes.rates), by_way), least);
  const int way = algebra_.product({rate, inverse(c)}, {2, 1});
  return {c, rate, algebra_.times(algebra_.sum({{acceleration, way}, {1, 1}}), inverse(K))};
}

BoundWriter::Sizes BoundWriter::sizes_of_terms() const {
  const Mechanism& all = blocks_.mechanism();
  const Values J = blocks_.call(algebra_, block_, "dense", in_);
  const int size = algebra_.value(effect_.size), zero = algebra_.value(0);
  Sizes sizes{zero, {}, {}, {}};
  for (std::size_t k = 0; k < block_.bodies->size(); ++k) {
    const int index = (*block_.bodies)[k];
    const Body& body = all.bodies[static_cast<std::size_t>(index)];
    if (!body.moves) continue;
    sizes.masses.add(1, algebra_.value(body.inv_m));
    int linear = zero;
    for (std::size_t i = 0; i < all.columns(); ++i) {
      const auto speed = [&](const char* array) {
        return algebra_.function(
            Fn::abs, {algebra_.input(fmt::format("{}[{}].{}", array, blocks_.body_name(index), all.column(i)))});
      };
      const bool straight = i < all.linear();
      const int j = algebra_.function(Fn::abs, {J.at(element(element("D", 0), all.columns() * k + i))}),
                dv = speed("a");
      if (straight) linear = law_.most(linear, dv);
      sizes.value = law_.most(sizes.value, straight ? algebra_.times(j, size) : j);
      sizes.rates.add(1, algebra_.times(j, speed("v")));
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

// The part of C beyond the end.
int BoundWriter::past() const {
  const End end = nearest_while_it_acts();
  const int zero = algebra_.value(0), low = law_.least(end.off, zero), high = law_.most(end.off, zero);
  const int past = algebra_.is_zero(end.side) ? end.off : algebra_.function(Fn::select, {end.side, low, high});
  return may_rest() ? algebra_.function(Fn::select, {acts(), past, zero}) : past;
}

BoundWriter::End BoundWriter::nearest() const {
  End end = nearest_while_it_acts();
  if (!may_rest()) return end;
  for (int* of : {&end.off, &end.side}) *of = algebra_.function(Fn::select, {acts(), *of, algebra_.value(0)});
  return end;
}

BoundWriter::End BoundWriter::nearest_while_it_acts() const {
  const int zero = algebra_.value(0), C = law_.C()[0];
  if (effect_.law == Effect::limited || is_rate()) return {zero, zero};
  const Values B = bounds();
  const int lower = bound(B, "B.lower", -boundless), upper = bound(B, "B.upper", boundless);
  const int above = algebra_.sum({{C, lower}, {1, -1}}), below = algebra_.sum({{upper, C}, {1, -1}});
  if (are_equal(lower, upper)) return {above, zero};
  const int at_low = algebra_.sum({{below, above}, {1, -1}}), minus = algebra_.sum({{below}, {-1}});
  return {algebra_.function(Fn::select, {at_low, above, minus}),
          algebra_.function(Fn::select, {at_low, algebra_.value(1), algebra_.value(-1)})};
}

}  // namespace cdot::compile
