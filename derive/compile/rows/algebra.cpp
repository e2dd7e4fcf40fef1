#include "derive/compile/rows/algebra.hpp"

#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "derive/program/effort.hpp"

namespace cdot::compile {
namespace {

constexpr int finest = 64, largest = 4096;       // exact numbers: multiples of 1/64 up to 4096
constexpr std::int64_t most_effort = 4'000'000;  // of a program: a chain of ten links takes 0.3 to 7 million

}  // namespace

int Algebra::value(double number, const std::string& name) {
  if (!name.empty()) constants_.known.insert(name);
  if (constants_.inputs.contains(name)) {
    constants_.inputs_read[name] = constants_.at_start["p." + name] = number;
    return input("p." + name);
  }
  return fixed(number, name);
}

int Algebra::shared(double number, const std::string& name) {
  constants_.known.insert(name);
  if (constants_.inputs.contains(name)) return value(number, name);
  const double size = std::abs(number), slight = 8 * std::numeric_limits<double>::epsilon() * size;
  auto first = constants_.sizes.lower_bound(size - slight);
  if (first == constants_.sizes.end() || first->first > size + slight)
    first = constants_.sizes.emplace(size, std::pair(name, number)).first;
  const auto& [of_first, as_first] = first->second;
  const int op = fixed(as_first, of_first);
  return (number < 0) == (as_first < 0) ? op : sum({{op}, {-1}});
}

int Algebra::fixed(double number, const std::string& name) {
  const double scaled = number * finest;
  if (scaled == std::round(scaled) && std::abs(number) <= largest)
    return builder_.number(Rational(static_cast<std::int64_t>(scaled), finest));
  if (name.empty() && number < 0) return sum({{fixed(-number, {})}, {Rational(-1)}});
  if (!name.empty()) constants_.named[name] = number;
  const int op = input(name.empty() ? fmt::format("T({})", number) : "T(" + name + ")");
  real_[op] = number;
  return op;
}

int Algebra::input(const std::string& text, bool is_position) {
  Operation op;
  op.kind = OpKind::input;
  op.input = text;
  op.is_position = is_position;
  return builder_.leaf(op);
}

std::optional<double> Algebra::constant(int op) const {
  if (const auto found = real_.find(op); found != real_.end()) return found->second;
  const Operation& o = builder_.at(op);
  if (o.kind == OpKind::number) return o.value.value();
  if (o.kind != OpKind::sum || o.args.size() != 1) return std::nullopt;
  const std::optional<double> inner = constant(o.args[0]);
  return inner ? std::optional(o.coefs[0].value() * *inner) : std::nullopt;
}

std::pair<int, Rational> Algebra::without_factor(int op) const {
  const Operation& o = builder_.at(op);
  const bool is_multiple = o.kind == OpKind::sum && o.args.size() == 1;
  return is_multiple ? std::pair(o.args[0], o.coefs[0]) : std::pair(op, Rational(1));
}

std::optional<std::map<std::string, double>> Algebra::linear(int op) const {
  std::map<std::string, double> coefficients;
  return add_linear(op, 1, coefficients) ? std::optional(std::move(coefficients)) : std::nullopt;
}

bool Algebra::add_linear(int op, double factor, std::map<std::string, double>& coefficients) const {
  const Operation& o = builder_.at(op);
  if (const std::optional<double> known = constant(op)) return *known == 0;
  if (o.kind == OpKind::input) return coefficients[o.input] += factor, true;
  if (o.kind == OpKind::sum) {
    for (std::size_t i = 0; i < o.args.size(); ++i)
      if (!add_linear(o.args[i], factor * o.coefs[i].value(), coefficients)) return false;
    return true;
  }
  int varies = -1;
  for (std::size_t i = 0; o.kind == OpKind::product && i < o.args.size(); ++i) {
    if (const std::optional<double> known = constant(o.args[i])) factor *= std::pow(*known, o.exponents[i]);
    else if (varies >= 0 || o.exponents[i] != 1) return false;
    else varies = o.args[i];
  }
  return varies >= 0 && add_linear(varies, factor, coefficients);
}

double Algebra::at_start(int op) {
  if (const auto known = at_start_.find(op); known != at_start_.end()) return known->second;
  const Operation o = builder_.at(op);
  std::vector<double> args;
  for (const int arg : o.args) args.push_back(at_start(arg));
  double value = 0;
  if (const std::optional<double> constant = this->constant(op)) value = *constant;
  else if (o.kind == OpKind::input) value = constants_.at_start.at(o.input);
  else if (o.kind == OpKind::sum)
    for (std::size_t i = 0; i < args.size(); ++i) value += o.coefs[i].value() * args[i];
  else if (o.kind == OpKind::function) value = derive::function_of(o.fn).value(args.data());
  else {
    value = o.kind == OpKind::product ? 1 : o.value.value();
    for (std::size_t i = 0; i < args.size(); ++i) value *= std::pow(args[i], o.exponents[i]);
  }
  return at_start_[op] = value;
}

int Algebra::by_time(int op) {
  if (const auto known = by_time_.find(op); known != by_time_.end()) return known->second;
  const Operation o = builder_.at(op);
  int rate = value(0);
  if (o.kind == OpKind::input) {
    const std::string& text = o.input;
    const std::size_t dot = text.find(").");
    if (text == "time") rate = value(1);
    else if (text.starts_with("table_") && text.ends_with(".value")) rate = input(text.substr(0, dot) + ").rate");
    else if (text.starts_with("table_") && text.ends_with(".rate"))
      rate = input(text.substr(0, dot) + ").acceleration");
  } else if (o.kind == OpKind::sum) {
    Summands terms;
    for (std::size_t i = 0; i < o.args.size(); ++i) terms.add(o.coefs[i], by_time(o.args[i]));
    rate = sum(terms);
  } else if (o.kind == OpKind::product) {
    Summands terms;
    for (std::size_t i = 0; i < o.args.size(); ++i) {
      derive::Operands factors = o.args, exponents = o.exponents;
      exponents[i] -= 1;
      if (exponents[i] == 0) factors[i] = value(1), exponents[i] = 1;
      factors.push_back(by_time(o.args[i])), exponents.push_back(1);
      terms.add(Rational(o.exponents[i]), product(factors, exponents));
    }
    rate = sum(terms);
  } else if (o.kind == OpKind::function) {
    rate = function_by_time(o, op);
  }
  return by_time_[op] = rate;
}

// f = f(x); most of them by x' alone.
int Algebra::function_by_time(const Operation& f, int op) {
  const int x = f.args[0], rate = by_time(x);
  const auto of = [&](Fn fn, int arg) { return function(fn, {arg}); };
  const auto minus = [&](int arg) { return sum({{arg}, {-1}}); };
  switch (f.fn) {
    case Fn::select: return function(Fn::select, {x, by_time(f.args[1]), by_time(f.args[2])});
    case Fn::atan2: {
      const int y = x, other = f.args[1];
      const int turned = sum({{times(other, rate), times(y, by_time(other))}, {1, -1}});
      return times(turned, of(Fn::inverse, sum({{product({y}, {2}), product({other}, {2})}, {1, 1}})));
    }
    case Fn::sqrt: return product({rate, of(Fn::inverse, op), value(0.5)}, {1, 1, 1});
    case Fn::sin: return times(rate, of(Fn::cos, x));
    case Fn::cos: return minus(times(rate, of(Fn::sin, x)));
    case Fn::tan: return times(rate, sum({{value(1), product({op}, {2})}, {1, 1}}));
    case Fn::sinh: return times(rate, of(Fn::cosh, x));
    case Fn::cosh: return times(rate, of(Fn::sinh, x));
    case Fn::exp: return times(rate, op);
    case Fn::log: return times(rate, of(Fn::inverse, x));
    case Fn::abs: return times(rate, of(Fn::sign, x));
    case Fn::inverse:
    case Fn::pivot: return minus(product({rate, op}, {1, 2}));
    case Fn::sign: break;
  }
  return value(0);
}

bool Algebra::is_zero(int op) const { return is_number(op) && builder_.at(op).value.is_zero(); }

int Algebra::sum(const Summands& terms, const std::string& name) {
  Summands rest;
  Rational whole;
  double real = 0;
  int reals = 0, last = -1;
  Rational last_coef;
  for (std::size_t i = 0; i < terms.args.size(); ++i) {
    const int arg = terms.args[i];
    const Rational coef = terms.coefs[i];
    if (is_number(arg)) {
      whole = whole + coef * builder_.at(arg).value;
    } else if (const std::optional<double> known = constant(arg)) {
      real += coef.value() * *known;
      ++reals, last = arg, last_coef = coef;
    } else {
      rest.add(coef, arg);
    }
  }
  if (reals == 1 && whole.is_zero()) rest.add(last_coef, last);
  else if (reals > 0) {
    if (const double sum = real + whole.value(); sum != 0) rest.add(1, value(sum));
  } else if (!whole.is_zero()) rest.add(1, builder_.number(whole));
  return builder_.sum(std::move(rest), name);
}

int Algebra::product(const derive::Operands& args, const derive::Operands& exponents, const std::string& name) {
  derive::Operands rest, powers;
  Rational whole(1);
  double real = 1;
  int reals = 0, last = -1, last_power = 1;
  for (std::size_t i = 0; i < args.size(); ++i) {
    int arg = args[i];
    const int power = exponents[i];
    while (builder_.at(arg).kind == OpKind::sum && builder_.at(arg).args.size() == 1) {
      whole = whole * derive::pow(builder_.at(arg).coefs[0], power);
      arg = builder_.at(arg).args[0];
    }
    if (is_number(arg)) {
      whole = whole * derive::pow(builder_.at(arg).value, power);
    } else if (const std::optional<double> known = constant(arg)) {
      real *= std::pow(*known, power);
      ++reals, last = arg, last_power = power;
    } else {
      rest.push_back(arg), powers.push_back(power);
    }
  }
  if (whole.is_zero()) return builder_.number(0);
  if (reals == 1 && last_power == 1 && derive::abs(whole) == Rational(1)) {
    rest.push_back(last), powers.push_back(1);
  } else if (reals > 0) {
    rest.push_back(value(real * whole.value())), powers.push_back(1);
    whole = 1;
  }
  if (whole != Rational(1)) rest.push_back(builder_.number(whole)), powers.push_back(1);
  return builder_.product(std::move(rest), std::move(powers), name);
}

int Algebra::function(Fn fn, const derive::Operands& args, const std::string& name) {
  std::vector<double> values;
  for (const int arg : args) {
    const std::optional<double> known = constant(arg);
    if (!known) return builder_.function(fn, args, name);
    values.push_back(*known);
  }
  return value(derive::function_of(fn).value(values.data()));
}

std::map<std::string, int> Algebra::inlined(const Program& program, const std::function<int(const std::string&)>& input,
                                            const std::string& prefix) {
  std::vector<int> to(program.ops.size(), -1);
  const std::vector<int> uses = derive::use_counts(program);
  for (std::size_t i = 0; i < program.ops.size(); ++i) {
    if (uses[i] == 0) continue;
    const Operation& op = program.ops[i];
    derive::Operands args;
    for (const int arg : op.args) args.push_back(to[static_cast<std::size_t>(arg)]);
    const std::string name = op.name.empty() ? "" : prefix + "_" + op.name.text();
    switch (op.kind) {
      case OpKind::number:
      case OpKind::factor: to[i] = builder_.number(op.value); break;
      case OpKind::input: to[i] = input(op.input); break;
      case OpKind::sum: to[i] = sum({args, op.coefs}, name); break;
      case OpKind::product: to[i] = product(args, op.exponents, name); break;
      case OpKind::function: to[i] = function(op.fn, args, name); break;
    }
  }
  std::map<std::string, int> outputs;
  for (const derive::Output& o : program.outputs) outputs[o.name] = to[static_cast<std::size_t>(o.op)];
  return outputs;
}

Program Algebra::finish() {
  Program program = builder_.finish();
  try {
    derive::Effort effort{most_effort};
    return derive::simplify(program, effort);
  } catch (const derive::NumberTooLarge&) {  // of exact numbers that came together
    return program;
  }
}

}  // namespace cdot::compile
