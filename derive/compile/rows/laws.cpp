#include "derive/compile/rows/laws.hpp"

#include <algorithm>
#include <numbers>

#include "derive/kernel/factor.hpp"
#include "derive/kernel/plan.hpp"
#include "derive/program/print.hpp"

namespace cdot::compile {
namespace {

// Outputs "C[0]", "C[1]", ... in order.
std::vector<int> elements(const Values& values, const std::string& array, std::size_t count) {
  std::vector<int> list;
  for (std::size_t r = 0; r < count; ++r) list.push_back(values.at(derive::element(array, r)));
  return list;
}

}  // namespace

// Less than half a turn from the last step's angle.
Unwound unwound(Algebra& algebra, int number, int C) {
  const auto place = static_cast<std::size_t>(number);
  const int last = algebra.input(derive::element("angles.angle", place)), zero = algebra.value(0);
  const int turns = algebra.input(derive::element("angles.turns", place)), turn = algebra.value(2 * std::numbers::pi);
  const int half = algebra.value(std::numbers::pi), ahead = algebra.sum({{C, turns, last}, {1, 1, -1}});
  const int back = algebra.sum({{turn}, {-1}});
  const int less = algebra.function(Fn::select, {algebra.sum({{ahead, half}, {1, -1}}), back, zero});
  const int more = algebra.function(Fn::select, {algebra.sum({{ahead, half}, {-1, -1}}), turn, less});
  const int all = algebra.sum({{turns, more}, {1, 1}});
  return {algebra.sum({{C, all}, {1, 1}}), all};
}

LawWriter::LawWriter(const RowBlocks& rows, Algebra& algebra, const Effect& effect, const RowBlock& block,
                     const Values& in)
    : rows_(rows), algebra_(algebra), effect_(effect), block_(block), in_(in) {
  const std::size_t count = block_.rows->count();
  RowBlock whole = block_;
  if (effect.acts_by_force()) whole.holds = -1;  // a law may have no number at C = 0
  C_ = elements(rows.call(algebra, whole, "position", in), "C", count);
  if (effect.angle >= 0) C_[0] = unwound(algebra, effect.angle, C_[0]).angle;
  rate_ = elements(rows.call(algebra, whole, "velocity", in), "Jv", count);
  drift_ = elements(rows.call(algebra, whole, "time_derivative", in), "C_t", count);
  for (std::size_t r = 0; r < count; ++r) rate_[r] = algebra.sum({{rate_[r], drift_[r]}, {1, 1}});
}

LawWriter LawWriter::at(std::vector<int> C, std::vector<int> rate) const {
  LawWriter there = *this;
  there.C_ = std::move(C), there.rate_ = std::move(rate);
  return there;
}

LawWriter LawWriter::with_masses(std::vector<int> K) const {
  LawWriter other = *this;
  other.K_ = std::move(K);
  return other;
}

LawWriter LawWriter::with_load(int load) const {
  LawWriter other = *this;
  other.load_ = load;
  return other;
}

LawWriter LawWriter::at_rest() const { return at(C_, std::vector<int>(C_.size(), algebra_.value(0))); }

// Leaves of a law are C, rates, its parameters and the time.
Values LawWriter::call(const Program& function) const {
  const SpecPrograms& law = spec();
  Values in;
  for (std::size_t p = 0; p < law.parameters.size(); ++p)
    in[law.parameters[p]] = rows_.number(algebra_, effect_, p, number_name(block_, law.parameters[p]));
  in["pi"] = algebra_.value(std::numbers::pi);
  in["time"] = algebra_.input("time");
  if (load_ >= 0) in[derive::bounded_load] = load_;
  for (const auto& [leaf, place] : law.leaves) {
    const std::vector<int>& of = place.starts_with("C") ? C_ : rate_;
    in[leaf] = of[static_cast<std::size_t>(std::stoi(place.substr(place.find('[') + 1)))];
  }
  return algebra_.inlined(
      function, [&](const std::string& text) { return in.at(text); }, block_.name);
}

int LawWriter::least(int a, int b) const {
  return algebra_.function(Fn::select, {algebra_.sum({{b, a}, {1, -1}}), a, b});
}

int LawWriter::most(int a, int b) const {
  return algebra_.function(Fn::select, {algebra_.sum({{a, b}, {1, -1}}), a, b});
}

std::vector<int> LawWriter::force_without_limits() const {
  if (effect_.law == Effect::spring) return spring_force();
  if (effect_.law == Effect::load)
    return std::vector<int>(C_.size(), rows_.number(algebra_, effect_, 0, block_.name + "_force"));
  return elements(call(spec().rows.function("force")), "F", C_.size());
}

std::vector<int> LawWriter::force() const {
  std::vector<int> F = force_without_limits();
  if (effect_.pulls) F[0] = most(F[0], algebra_.value(0));
  if (!has_limits()) return F;
  const Values limits = call(spec().rows.function("limits"));
  for (std::size_t r = 0; r < F.size(); ++r) {
    const auto lower = limits.find(derive::element("lower", r)), upper = limits.find(derive::element("upper", r));
    if (lower != limits.end()) F[r] = most(lower->second, least(F[r], upper->second));
  }
  return F;
}

// By its frequency f and damping ratio z: k = (2 pi f)^2 / K, d = 2 z 2 pi f / K.
LawWriter::Slopes LawWriter::spring_slopes() const {
  const std::vector<double>& n = effect_.numbers;
  Slopes slopes;
  const double w = 2 * std::numbers::pi * n[1];
  const Values K = n[0] == 0 || !K_.empty() ? Values{} : rows_.call(algebra_, block_, "effective_mass", in_);
  for (std::size_t r = 0; r < C_.size(); ++r) {
    if (n[0] == 0) {
      slopes.k.push_back(algebra_.value(n[1], block_.name + "_stiffness"));
      slopes.d.push_back(algebra_.value(n[2], block_.name + "_damping"));
      continue;
    }
    const int mass = algebra_.function(Fn::inverse, {K_.empty() ? K.at(derive::triangle_element("K", r, r)) : K_[r]});
    slopes.k.push_back(algebra_.times(algebra_.value(w * w, block_.name + "_w2"), mass));
    slopes.d.push_back(algebra_.times(algebra_.value(2 * n[2] * w, block_.name + "_2zw"), mass));
  }
  for (int* slope : {&slopes.k[0], &slopes.d[0]})  // a rope is slack where C > 0
    if (effect_.pulls && !algebra_.is_zero(*slope))
      *slope = algebra_.function(Fn::select, {C_[0], algebra_.value(0), *slope});
  return slopes;
}

std::vector<int> LawWriter::spring_force() const {
  const Slopes slopes = spring_slopes();
  const int rest = algebra_.value(effect_.numbers[3], block_.name + "_rest");
  std::vector<int> F;
  for (std::size_t r = 0; r < C_.size(); ++r) {
    const int stretch = algebra_.sum({{C_[r], rest}, {1, -1}});
    F.push_back(
        algebra_.sum({{algebra_.times(slopes.k[r], stretch), algebra_.times(slopes.d[r], rate_[r])}, {-1, -1}}));
  }
  return F;
}

LawWriter::Slopes LawWriter::slopes() const {
  if (effect_.law == Effect::spring) return spring_slopes();
  if (effect_.law == Effect::load) {
    const std::vector<int> none(C_.size(), algebra_.value(0));
    return {none, none};
  }
  const Values slopes = call(spec().rows.function("slopes"));
  return {bound(slopes, "k"), bound(slopes, "d")};
}

LawWriter::Slopes LawWriter::slopes_within_limits() const {
  Slopes all = slopes();
  if (!has_limits()) return all;
  const std::vector<int> F = force_without_limits();
  const Values limits = call(spec().rows.function("limits"));
  const int zero = algebra_.value(0);
  for (std::size_t r = 0; r < F.size(); ++r) {
    const auto lower = limits.find(derive::element("lower", r)), upper = limits.find(derive::element("upper", r));
    if (lower == limits.end()) continue;
    const int above = algebra_.sum({{F[r], lower->second}, {1, -1}});
    const int below = algebra_.sum({{upper->second, F[r]}, {1, -1}});
    for (int* slope : {&all.k[r], &all.d[r]})
      *slope = algebra_.function(Fn::select, {above, algebra_.function(Fn::select, {below, *slope, zero}), zero});
  }
  return all;
}

bool LawWriter::reads_rates() const {
  if (effect_.law == Effect::load) return false;
  if (effect_.law == Effect::spring)
    return !std::ranges::all_of(spring_slopes().d, [&](int d) { return algebra_.is_zero(d); });
  const std::set<std::string> read = derive::inputs_read(spec().rows.function("force"), {});
  return std::ranges::any_of(
      spec().leaves, [&](const auto& leaf) { return leaf.second.starts_with("rate") && read.contains(leaf.first); });
}

// False for a row that only tells where a direction points.
bool LawWriter::acts(std::size_t row) const {
  const Program& force = spec().rows.function("force");
  const auto output = std::ranges::find(force.outputs, derive::element("F", row), &derive::Output::name);
  const Operation& op = force.at(output->op);
  return op.kind != OpKind::number || !op.value.is_zero();
}

std::vector<int> LawWriter::bound(const Values& slopes, const std::string& letter) const {
  std::vector<int> bounds;
  for (std::size_t r = 0; r < C_.size(); ++r) {
    Summands terms;
    for (std::size_t c = 0; c < C_.size(); ++c) {
      const int slope = slopes.at(derive::element(derive::element(letter, r), c));
      if (c == r || acts(c)) terms.add(1, c == r ? slope : algebra_.function(Fn::abs, {slope}));
    }
    const int sum = algebra_.sum(terms), zero = algebra_.value(0);
    bounds.push_back(algebra_.function(Fn::select, {sum, sum, zero}));
  }
  return bounds;
}

int LawWriter::energy() const {
  if (effect_.law == Effect::load)
    return algebra_.sum({{algebra_.times(rows_.number(algebra_, effect_, 0, block_.name + "_force"), C_[0])}, {-1}});
  if (effect_.law != Effect::spring)
    return spec().rows.has("energy") ? call(spec().rows.function("energy")).at("E") : algebra_.value(0);
  const Slopes slopes = spring_slopes();
  const int rest = algebra_.value(effect_.numbers[3], block_.name + "_rest");
  Summands terms;
  for (std::size_t r = 0; r < C_.size(); ++r) {
    const int stretch = algebra_.sum({{C_[r], rest}, {1, -1}});
    terms.add({1, 2}, algebra_.product({slopes.k[r], stretch}, {1, 2}));
  }
  return algebra_.sum(terms);
}

}  // namespace cdot::compile
