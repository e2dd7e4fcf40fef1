// Expressions to programs, and the cost of a program.
#include "derive/program/program.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <fmt/format.h>
#include <map>
#include <mutex>
#include <unordered_set>

#include "derive/program/builder.hpp"

namespace cdot::derive {
namespace {

void add_cost(const Program& program, const Operation& op, Count& count) {
  const int n = static_cast<int>(op.args.size());
  if (op.kind == OpKind::sum) {
    for (std::size_t i = 0; i < op.args.size(); ++i) {
      const bool scaled = abs(op.coefs[i]) != Rational(1) && program.at(op.args[i]).kind != OpKind::number;
      count.multiply += scaled ? 1 : 0;
    }
    count.add += n - 1 + (lead_of(program, op).negated ? 1 : 0);
  } else if (op.kind == OpKind::product) {
    count.multiply += n - 1;
    for (const int k : op.exponents) count.multiply += k - 1;
  } else if (op.kind == OpKind::function) {
    const Function::Cost& cost = function_of(op.fn).cost;
    count.multiply += cost.multiply;
    count.divide += cost.divide;
    count.root += cost.root;
    count.compare += cost.compare;
    count.call += cost.call;
  }
}

}  // namespace

const std::string* SharedText::kept(const std::string& text) {
  static std::mutex one_at_a_time;
  static std::unordered_set<std::string> texts;
  const std::lock_guard lock(one_at_a_time);
  return &*texts.insert(text).first;
}

std::size_t hash_of(const Operation& op) {
  std::uint64_t hash = op.kind == OpKind::input ? std::hash<std::string>()(op.input.text()) : 0;
  const auto add = [&](std::int64_t n) {
    hash = (hash ^ static_cast<std::uint64_t>(n)) * 0x9E3779B97F4A7C15u;
    hash ^= hash >> 32;
  };
  const auto add_size = [&](Rational r) { add(abs(r).num()), add(r.den()); };
  add(static_cast<int>(op.kind));
  add(static_cast<int>(op.fn));
  add_size(op.value);
  for (const int arg : op.args) add(arg);
  for (const Rational coef : op.coefs) add_size(coef);
  for (const int exponent : op.exponents) add(exponent);
  return hash;
}

int sign_between(const Operation& a, const Operation& b) {
  if (a.kind != b.kind || a.fn != b.fn || a.args != b.args || a.exponents != b.exponents) return 0;
  if (a.value != b.value || a.input != b.input) return 0;
  if (a.coefs == b.coefs) return 1;
  const bool negative = std::ranges::equal(a.coefs, b.coefs, [](Rational c, Rational d) { return c == -d; });
  return negative && a.args.size() > 1 ? -1 : 0;
}

Lead lead_of(const Program& program, const Operation& sum) {
  for (std::size_t i = 0; i < sum.args.size(); ++i) {
    if (sum.coefs[i].sign() > 0) return {i, false};
  }
  for (std::size_t i = 0; i < sum.args.size(); ++i) {
    if (sum.coefs[i] != Rational(-1) || program.at(sum.args[i]).kind == OpKind::number) return {i, false};
  }
  return {0, true};
}

ProgramBuilder::ProgramBuilder(std::size_t expected) : slots_(std::bit_ceil(2 * expected + 64), -1) {
  program_.ops.reserve(expected), hash_.reserve(expected);
}

void ProgramBuilder::enter(int op) {
  std::size_t slot = hash_[static_cast<std::size_t>(op)];
  while (slots_[slot & (slots_.size() - 1)] >= 0) ++slot;
  slots_[slot & (slots_.size() - 1)] = op;
}

int ProgramBuilder::intern(Operation op) {
  const std::size_t hash = hash_of(op);
  for (std::size_t slot = hash; slots_[slot & (slots_.size() - 1)] >= 0; ++slot) {
    const int other = slots_[slot & (slots_.size() - 1)];
    if (hash_[static_cast<std::size_t>(other)] != hash) continue;
    Operation& known = program_.ops[static_cast<std::size_t>(other)];
    const int sign = sign_between(op, known);             // none but one fits, whatever their order
    if (sign < 0) return sum({{other}, {Rational(-1)}});  // it exists already and is not computed again
    if (sign == 0) continue;
    if (known.name.empty()) known.name = std::move(op.name);
    return other;
  }
  const int made = size();
  program_.ops.push_back(std::move(op)), hash_.push_back(hash);
  if (2 * hash_.size() > slots_.size()) {
    slots_.assign(2 * slots_.size(), -1);
    for (int i = 0; i < made; ++i) enter(i);
  }
  enter(made);
  return made;
}

int Builder::number(Rational value) {
  Operation op;
  op.value = value;
  return intern(std::move(op));
}

int Builder::leaf(const Operation& op) { return intern(op); }

Rational Builder::pull_coefficient(int& arg) const {
  const Operation& op = at(arg);
  if (op.kind != OpKind::sum || op.args.size() != 1) return Rational(1);
  arg = op.args[0];
  return op.coefs[0];
}

// The sum of the first n terms, which differ. Sums are taken from the left: x_a - x_b + r keeps the digits of r far
// from the origin, r + x_a - x_b does not.
Summands Builder::ordered(Summands terms, std::size_t n) const {
  auto& [args, coefs] = terms;
  args.shorten(n), coefs.shorten(n);
  const auto is_late = [&](int arg) { return !at(arg).is_position; };
  const bool none_is_zero = std::ranges::none_of(coefs, &Rational::is_zero);
  if (none_is_zero && std::ranges::is_sorted(args, {}, is_late)) return terms;
  Summands sorted;
  for (const bool late : {false, true})
    for (std::size_t i = 0; i < n; ++i)
      if (is_late(args[i]) == late && !coefs[i].is_zero()) sorted.add(coefs[i], args[i]);
  return sorted;
}

int Builder::sum(Summands terms, SharedText name) {
  auto& [args, coefs] = terms;
  std::size_t n = 0;  // terms so far
  for (std::size_t i = 0; i < args.size(); ++i) {
    int arg = args[i];
    const Rational coef = coefs[i] * pull_coefficient(arg);
    const std::size_t same = index_of(std::span(args).first(n), arg);
    coefs[same] = same < n ? coefs[same] + coef : coef;
    if (same == n) args[n++] = arg;
  }
  terms = ordered(std::move(terms), n);
  if (args.empty()) return number(0);
  const bool single = args.size() == 1;
  if (single && at(args[0]).kind == OpKind::number) return number(coefs[0] * at(args[0]).value);
  if (single && coefs[0] == Rational(1)) return args[0];
  Operation op;
  op.kind = OpKind::sum;
  op.args = std::move(args), op.coefs = std::move(coefs);
  op.name = std::move(name);
  return intern(std::move(op));
}

int Builder::product(Operands args, Operands exponents, SharedText name) {
  Rational coef(1);
  std::size_t n = 0;  // factors so far
  for (std::size_t i = 0; i < args.size(); ++i) {
    int arg = args[i];
    const int exponent = exponents[i];
    coef = coef * pow(pull_coefficient(arg), exponent);
    if (at(arg).kind == OpKind::number) {
      coef = coef * pow(at(arg).value, exponent);
      continue;
    }
    const std::size_t same = index_of(std::span(args).first(n), arg);
    exponents[same] = same < n ? exponents[same] + exponent : exponent;
    if (same == n) args[n++] = arg;
  }
  if (coef.is_zero()) return number(0);
  if (n == 0) return number(coef);
  args.shorten(n), exponents.shorten(n);
  Operation op;
  op.kind = OpKind::product;
  op.args = std::move(args);
  op.exponents = std::move(exponents);
  if (coef == Rational(1)) op.name = name;
  const bool plain = n == 1 && op.exponents[0] == 1;
  const int core = plain ? op.args[0] : intern(std::move(op));
  return coef == Rational(1) ? core : sum({{core}, {coef}}, std::move(name));
}

int Builder::function(Fn fn, Operands args, SharedText name) {
  Operation op;
  op.kind = OpKind::function;
  op.fn = fn;
  op.args = std::move(args);
  if (fn == Fn::inverse || fn == Fn::abs) {
    // 1/(-x) = -1/x, |-x| = |x|; other factors stay inside.
    int inner = op.args[0];
    if (pull_coefficient(inner) == Rational(-1)) {
      op.args[0] = inner;
      op.name = name;
      const int core = intern(std::move(op));
      return fn == Fn::abs ? core : sum({{core}, {Rational(-1)}});
    }
  }
  op.name = std::move(name);
  return intern(std::move(op));
}

int Builder::rebuild(const Operation& op, Operands args) {
  switch (op.kind) {
    case OpKind::number: return number(op.value);
    case OpKind::factor:
    case OpKind::input: return leaf(op);
    case OpKind::sum: return sum({std::move(args), op.coefs}, op.name);
    case OpKind::product: return product(std::move(args), op.exponents, op.name);
    case OpKind::function: return function(op.fn, std::move(args), op.name);
  }
  return 0;
}

Program assemble(const std::vector<NamedExpr>& outputs) {
  ProgramBuilder builder;
  std::map<const Node*, int> done;
  std::vector<Expr> roots;
  for (const NamedExpr& output : outputs) roots.push_back(output.e);
  for (const Expr e : topological(roots)) {
    Operation op;
    op.name = e->name;
    Operands args;
    for (const Expr arg : e->args) args.push_back(done.at(&*arg));
    switch (e->kind) {
      case Kind::number: op.value = e->value; break;
      case Kind::symbol:
        op.kind = OpKind::input;
        op.input = e->symbol;
        op.is_position = e->role == Role::position;
        break;
      case Kind::sum:
        op.kind = OpKind::sum;
        op.coefs = e->coefs;
        break;
      case Kind::product:
        op.kind = OpKind::product;
        op.exponents = e->exponents;
        break;
      default: op.kind = OpKind::function; op.fn = e->fn;
    }
    done.emplace(&*e, builder.rebuild(op, std::move(args)));
  }
  for (const NamedExpr& output : outputs) builder.output(output.name, done.at(&*output.e));
  return builder.finish();
}

std::vector<int> use_counts(const Program& program) {
  std::vector<int> uses(program.ops.size());
  for (const Output& output : program.outputs) ++uses[static_cast<std::size_t>(output.op)];
  for (std::size_t i = program.ops.size(); i-- > 0;) {
    if (uses[i] == 0) continue;
    for (const int arg : program.ops[i].args) ++uses[static_cast<std::size_t>(arg)];
  }
  return uses;
}

Count count(const Program& program) {
  const std::vector<int> uses = use_counts(program);
  Count total;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    if (uses[i] > 0) add_cost(program, program.ops[i], total);
  }
  return total;
}

std::string text(const Count& c) {
  std::string s;
  const auto part = [&](int n, const char* what) {
    if (n > 0) s += fmt::format("{}{} {}", s.empty() ? "" : ", ", n, what);
  };
  part(c.add, "+");
  part(c.multiply, "*");
  part(c.divide, "/");
  part(c.root, "sqrt");
  part(c.compare, "<");
  part(c.call, "call");
  return s.empty() ? "nothing" : s;
}

}  // namespace cdot::derive
