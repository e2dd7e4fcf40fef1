// Lowers a program to steps as derive/program/print.cpp writes them.
#include "derive/interpret/tape.hpp"

#include <numbers>

namespace cdot::derive {
namespace {

std::size_t place(int i) { return static_cast<std::size_t>(i); }

// The functions of a program, in the order of Fn, follow the arithmetic.
Tape::Code code_of(Fn fn) { return static_cast<Tape::Code>(static_cast<int>(Tape::Code::sqrt) + static_cast<int>(fn)); }
static_assert(static_cast<int>(Tape::Code::sin) - static_cast<int>(Tape::Code::sqrt) == static_cast<int>(Fn::sin));
static_assert(static_cast<int>(Tape::Code::sign) - static_cast<int>(Tape::Code::sqrt) == static_cast<int>(Fn::sign));
static_assert(static_cast<int>(Tape::Code::pivot) - static_cast<int>(Tape::Code::sqrt) == static_cast<int>(Fn::pivot));

// Registers are numbered as they arise; the constants among them come first at the end.
class Lowering {
 public:
  explicit Lowering(const Program& program) : program_(program) {}

  Tape lower(std::vector<std::string>& inputs, std::vector<std::string>& outputs) {
    const std::vector<int> uses = use_counts(program_);
    for (std::size_t i = 0; i < program_.ops.size(); ++i) at_.push_back(uses[i] == 0 ? -1 : lower(program_.ops[i]));
    for (const Output& output : program_.outputs) {
      outputs.push_back(output.name);
      tape_.output_at.push_back(at_[place(output.op)]);
    }
    inputs = std::move(inputs_);
    return constants_first();
  }

 private:
  int lower(const Operation& op) {
    switch (op.kind) {
      case OpKind::number:
      case OpKind::factor: return constant(op.value.value());
      case OpKind::input: return input(op.input);
      case OpKind::sum: return sum(op);
      case OpKind::product: return product(op);
      case OpKind::function: break;
    }
    int args[3] = {};
    for (std::size_t k = 0; k < op.args.size(); ++k) args[k] = at_[place(op.args[k])];
    return emit(code_of(op.fn), args[0], args[1], args[2]);
  }

  int input(const std::string& name) {
    if (name == "pi") return constant(std::numbers::pi);
    if (name == "unlimited") return constant(unbounded);
    inputs_.push_back(name);
    tape_.input_at.push_back(next());
    return tape_.input_at.back();
  }

  int next() { return tape_.registers++; }
  int constant(double value) {
    constants_.push_back({next(), value});
    return constants_.back().at;
  }
  int emit(Tape::Code code, int a, int b = 0, int c = 0) {
    const int to = next();
    tape_.steps.push_back({code, to, a, b, c});
    return to;
  }

  // coef * operand; a number is a constant
  int term(const Operation& sum, std::size_t term, Rational coef) {
    const Operation& operand = program_.at(sum.args[term]);
    if (operand.kind == OpKind::number) return constant((coef * operand.value).value());
    const int x = at_[place(sum.args[term])];
    return coef == Rational(1) ? x : emit(Tape::Code::multiply, constant(coef.value()), x);
  }

  // The leading term, then the others in their order, each added or subtracted.
  int sum(const Operation& op) {
    const Lead lead = lead_of(program_, op);
    int total = term(op, lead.term, lead.negated ? abs(op.coefs[lead.term]) : op.coefs[lead.term]);
    if (lead.negated) total = emit(Tape::Code::negate, total);
    for (std::size_t i = 0; i < op.args.size(); ++i) {
      if (i == lead.term) continue;
      const int next = term(op, i, abs(op.coefs[i]));
      total = emit(op.coefs[i].sign() < 0 ? Tape::Code::subtract : Tape::Code::add, total, next);
    }
    return total;
  }

  int product(const Operation& op) {
    int result = -1;
    for (std::size_t i = 0; i < op.args.size(); ++i) {
      const int x = at_[place(op.args[i])];
      for (int k = 0; k < op.exponents[i]; ++k) result = result < 0 ? x : emit(Tape::Code::multiply, result, x);
    }
    return result;
  }

  Tape constants_first() {
    std::vector<int> moved(place(tape_.registers), -1);
    for (const Constant& c : constants_) {
      moved[place(c.at)] = static_cast<int>(tape_.constants.size());
      tape_.constants.push_back(c.value);
    }
    int next = static_cast<int>(tape_.constants.size());
    for (int& to : moved) to = to < 0 ? next++ : to;
    for (Tape::Step& s : tape_.steps)
      for (int* at : {&s.to, &s.a, &s.b, &s.c}) *at = moved[place(*at)];
    for (std::vector<int>* list : {&tape_.input_at, &tape_.output_at})
      for (int& at : *list) at = moved[place(at)];
    return std::move(tape_);
  }

  struct Constant {
    int at;
    double value;
  };
  const Program& program_;
  Tape tape_;
  std::vector<Constant> constants_;
  std::vector<std::string> inputs_;
  std::vector<int> at_;  // register of each operation
};

}  // namespace

NamedTape::NamedTape(const Program& program) : tape_(Lowering(program).lower(inputs_, outputs_)) {}

std::vector<double> NamedTape::registers() const {
  std::vector<double> registers(place(tape_.registers));
  place_constants(tape_, registers.data());
  return registers;
}

void NamedTape::run(std::span<const double> inputs, std::span<double> registers, std::span<double> to) const {
  for (std::size_t i = 0; i < inputs.size(); ++i) registers[place(tape_.input_at[i])] = inputs[i];
  run_tape(tape_, registers.data());
  for (std::size_t i = 0; i < to.size(); ++i) to[i] = registers[place(tape_.output_at[i])];
}

}  // namespace cdot::derive
