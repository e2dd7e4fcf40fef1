// Programs to C++ statements. A quantity gets a line of its own if it has a name or is used twice.
#include "derive/print_program.hpp"

#include <fmt/format.h>

namespace cdot::derive {
namespace {

enum Level { in_sum, in_product, in_power };

class StatementPrinter {
 public:
  StatementPrinter(const Program& program, const Printing& printing)
      : program_(program), printing_(printing), uses_(program.ops.size()),
        variable_(program.ops.size()), used_(printing.reserved) {
    for (const Output& o : program.outputs) ++uses_[index(o.op)];
    for (std::size_t i = program.ops.size(); i-- > 0;) {
      if (uses_[i] == 0) continue;
      for (const int arg : program.ops[i].args) uses_[index(arg)] += times(program.ops[i], arg);
    }
  }

  std::vector<std::string> print() {
    for (const Output& output : program_.outputs) {
      label_ = plain(output.name);
      serial_ = 0;
      define_operands(output.op);
      emit(output.name + " = " + expression(output.op, in_sum) + ";");
    }
    return std::move(lines_);
  }

 private:
  static std::size_t index(int op) { return static_cast<std::size_t>(op); }
  const Operation& at(int op) const { return program_.ops[index(op)]; }

  // A square reads its operand twice, so it should be a variable.
  static int times(const Operation& op, int arg) {
    if (op.kind == OpKind::product) {
      for (std::size_t i = 0; i < op.args.size(); ++i) {
        if (op.args[i] == arg) return op.exponents[i];
      }
    }
    return 1;
  }

  static std::string plain(const std::string& output) {
    std::string s;
    for (const char c : output) {
      if (std::isalnum(static_cast<unsigned char>(c)) || c == '_') s += c;
      if (c == '.') s += '_';
    }
    return s;
  }

  bool is_atom(const Operation& op) const {
    return op.kind == OpKind::number || op.kind == OpKind::input;
  }
  // -x and 2 x of one operand are written where they are used.
  static bool is_scaling(const Operation& op) {
    return op.kind == OpKind::sum && op.args.size() == 1;
  }

  bool wants_variable(int op) const {
    const Operation& o = at(op);
    if (is_atom(o) || (is_scaling(o) && abs(o.coefs[0]) == Rational(1))) return false;
    return !o.name.empty() || uses_[index(op)] > 1;
  }

  // Everything below `op` that wants a line, operands first; `op` itself too if it is more than this output.
  void define_operands(int op) {
    for (const int arg : at(op).args) define(arg);
    if (wants_variable(op) && (uses_[index(op)] > 1)) define(op);
  }

  void define(int op) {
    if (!variable_[index(op)].empty()) return;
    for (const int arg : at(op).args) define(arg);
    if (!wants_variable(op)) return;
    std::string name = at(op).name;
    if (name.empty()) name = fmt::format("{}_{}", label_, ++serial_);
    const std::string value = expression(op, in_sum);
    variable_[index(op)] = unused(std::move(name));
    emit("const T " + variable_[index(op)] + " = " + value + ";");
  }

  std::string unused(std::string name) {
    if (used_.insert(name).second) return name;
    for (int k = 2;; ++k) {
      const std::string other = fmt::format("{}_{}", name, k);
      if (used_.insert(other).second) return other;
    }
  }

  void emit(std::string statement) {
    for (std::string& line : wrapped(printing_.indent + std::move(statement))) {
      lines_.push_back(std::move(line));
    }
  }

  std::string operand(int op, Level level) const {
    return variable_[index(op)].empty() ? expression(op, level) : variable_[index(op)];
  }

  static std::string parenthesised(std::string s, bool needed) {
    return needed ? "(" + s + ")" : s;
  }

  static std::string number(Rational value) {
    if (value.is_integer()) return fmt::format("T({})", value.num());
    return fmt::format("T({})", value.value());
  }

  std::string expression(int op, Level level) const {
    const Operation& o = at(op);
    if (!variable_[index(op)].empty()) return variable_[index(op)];
    switch (o.kind) {
      case OpKind::number: return number(o.value);
      case OpKind::input: {
        const auto found = printing_.inputs.find(o.input);
        return found == printing_.inputs.end() ? o.input : found->second;
      }
      case OpKind::sum: return sum_text(o, level);
      case OpKind::product: return parenthesised(product_text(o), level >= in_power);
      case OpKind::function: return function_text(o);
    }
    return "";
  }

  std::string sum_text(const Operation& o, Level level) const {
    // A positive term leads; without one the sum opens with a minus sign.
    std::size_t lead = 0;
    while (lead < o.args.size() && o.coefs[lead].sign() < 0) ++lead;
    if (lead == o.args.size()) lead = 0;
    std::string s;
    const auto append = [&](std::size_t i) {
      const Rational c = o.coefs[i];
      if (s.empty()) s += c.sign() < 0 ? "-" : "";
      else s += c.sign() < 0 ? " - " : " + ";
      if (at(o.args[i]).kind == OpKind::number) {
        s += number(abs(c) * at(o.args[i]).value);
        return;
      }
      if (abs(c) != Rational(1)) s += number(abs(c)) + " * ";
      s += operand(o.args[i], in_product);
    };
    append(lead);
    for (std::size_t i = 0; i < o.args.size(); ++i) {
      if (i != lead) append(i);
    }
    const bool scaled_only = is_scaling(o) && o.coefs[0].sign() > 0;
    return parenthesised(s, level >= in_power || (level >= in_product && !scaled_only));
  }

  std::string product_text(const Operation& o) const {
    std::string s;
    for (std::size_t i = 0; i < o.args.size(); ++i) {
      const std::string factor = operand(o.args[i], in_product);
      for (int k = 0; k < o.exponents[i]; ++k) s += (s.empty() ? "" : " * ") + factor;
    }
    return s;
  }

  std::string function_text(const Operation& o) const {
    std::vector<std::string> args;
    for (const int arg : o.args) args.push_back(operand(arg, in_sum));
    if (o.fn == Fn::select) {
      return fmt::format("select({} > smallest<T>(), {}, {})", args[0], args[1], args[2]);
    }
    return fmt::format("{}({})", name_of(o.fn), fmt::join(args, ", "));
  }

  const Program& program_;
  const Printing& printing_;
  std::vector<int> uses_;
  std::vector<std::string> variable_;
  std::set<std::string> used_;
  std::vector<std::string> lines_;
  std::string label_;
  int serial_ = 0;
};

}  // namespace

std::vector<std::string> print_statements(const Program& program, const Printing& printing) {
  return StatementPrinter(program, printing).print();
}

std::set<std::string> inputs_read(const Program& program, const Printing& printing) {
  std::set<std::string> read;
  std::vector<bool> needed(program.ops.size());
  for (const Output& o : program.outputs) needed[static_cast<std::size_t>(o.op)] = true;
  for (std::size_t i = program.ops.size(); i-- > 0;) {
    if (!needed[i]) continue;
    const Operation& op = program.ops[i];
    for (const int arg : op.args) needed[static_cast<std::size_t>(arg)] = true;
    if (op.kind != OpKind::input) continue;
    const auto found = printing.inputs.find(op.input);
    read.insert(found == printing.inputs.end() ? op.input : found->second);
  }
  return read;
}

std::vector<std::string> wrapped(std::string line) {
  constexpr std::size_t columns = 100;
  std::vector<std::string> lines;
  const std::size_t indent = line.find_first_not_of(' ');
  while (line.size() > columns) {
    std::size_t best = std::string::npos;
    int depth = 0, best_depth = 1000;
    for (std::size_t i = indent; i < columns; ++i) {
      if (line[i] == '(' || line[i] == '[') ++depth;
      if (line[i] == ')' || line[i] == ']') --depth;
      const bool after_operator =
          line[i] == ' ' && i + 1 < line.size() && i > indent &&
          (line[i - 1] == '+' || line[i - 1] == '-' || line[i - 1] == '*' || line[i - 1] == ',');
      if (after_operator && depth <= best_depth && i > columns / 3) best = i, best_depth = depth;
    }
    if (best == std::string::npos) break;
    lines.push_back(line.substr(0, best));
    line = std::string(indent + 4, ' ') + line.substr(best + 1);
  }
  lines.push_back(std::move(line));
  return lines;
}

}  // namespace cdot::derive
