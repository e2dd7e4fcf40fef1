// Lowers a program to steps as derive/program/print.cpp writes them, and runs the steps.
#include "derive/interpret/tape.hpp"

#include <limits>
#include <numbers>

namespace cdot::derive {
namespace {

std::size_t place(int i) { return static_cast<std::size_t>(i); }

// As kernels compute: their select asks for a normal number.
double value_of(Fn fn, const double* x) {
  if (fn == Fn::select) return x[0] > std::numeric_limits<double>::min() ? x[1] : x[2];
  return function_of(fn).value(x);
}

}  // namespace

Tape::Tape(const Program& program) {
  const std::vector<int> uses = use_counts(program);
  for (std::size_t i = 0; i < program.ops.size(); ++i) {
    const Operation& op = program.ops[i];
    at_.push_back(-1);
    if (uses[i] == 0) continue;
    switch (op.kind) {
      case OpKind::number:
      case OpKind::factor: at_[i] = constant(op.value.value()); break;
      case OpKind::input:
        at_[i] = constant(op.input == "pi" ? std::numbers::pi : 0);
        if (op.input != "pi") inputs_.push_back(op.input), input_at_.push_back(at_[i]);
        break;
      case OpKind::sum: at_[i] = sum(program, op); break;
      case OpKind::product: at_[i] = product(op); break;
      case OpKind::function: {
        int args[3] = {};
        for (std::size_t k = 0; k < op.args.size(); ++k) args[k] = at_[place(op.args[k])];
        at_[i] = emit(Code::function, args[0], args[1], op.fn, args[2]);
      }
    }
  }
  for (const Output& output : program.outputs) {
    outputs_.push_back(output.name);
    output_at_.push_back(at_[place(output.op)]);
  }
  at_.clear();
}

int Tape::constant(double value) {
  registers_.push_back(value);
  return static_cast<int>(registers_.size()) - 1;
}

int Tape::emit(Code code, int a, int b, Fn fn, int c) {
  const int to = constant(0);
  steps_.push_back({code, fn, to, a, b, c});
  return to;
}

// coef * operand; a number is a constant
int Tape::term(const Program& program, const Operation& sum, std::size_t term, Rational coef) {
  const Operation& operand = program.at(sum.args[term]);
  if (operand.kind == OpKind::number) return constant((coef * operand.value).value());
  const int x = at_[place(sum.args[term])];
  return coef == Rational(1) ? x : emit(Code::multiply, constant(coef.value()), x);
}

// The leading term, then the others in their order, each added or subtracted.
int Tape::sum(const Program& program, const Operation& op) {
  const Lead lead = lead_of(program, op);
  int total = term(program, op, lead.term, lead.negated ? abs(op.coefs[lead.term]) : op.coefs[lead.term]);
  if (lead.negated) total = emit(Code::negate, total);
  for (std::size_t i = 0; i < op.args.size(); ++i) {
    if (i == lead.term) continue;
    const int next = term(program, op, i, abs(op.coefs[i]));
    total = emit(op.coefs[i].sign() < 0 ? Code::subtract : Code::add, total, next);
  }
  return total;
}

int Tape::product(const Operation& op) {
  int result = -1;
  for (std::size_t i = 0; i < op.args.size(); ++i) {
    const int x = at_[place(op.args[i])];
    for (int k = 0; k < op.exponents[i]; ++k) result = result < 0 ? x : emit(Code::multiply, result, x);
  }
  return result;
}

void Tape::run(std::span<const double> inputs, std::span<double> registers, std::span<double> to) const {
  for (std::size_t i = 0; i < input_at_.size(); ++i) registers[place(input_at_[i])] = inputs[i];
  double* const r = registers.data();
  for (const Step& s : steps_) {
    switch (s.code) {
      case Code::add: r[s.to] = r[s.a] + r[s.b]; break;
      case Code::subtract: r[s.to] = r[s.a] - r[s.b]; break;
      case Code::multiply: r[s.to] = r[s.a] * r[s.b]; break;
      case Code::negate: r[s.to] = -r[s.a]; break;
      case Code::function: {
        const double x[3] = {r[s.a], r[s.b], r[s.c]};
        r[s.to] = value_of(s.fn, x);
      }
    }
  }
  for (std::size_t i = 0; i < output_at_.size(); ++i) to[i] = r[output_at_[i]];
}

}  // namespace cdot::derive
