// Programs to C++ statements. A quantity gets a line of its own if it has a name or is used twice.
#include "derive/program/print.hpp"

#include <fmt/args.h>
#include <fmt/format.h>

namespace cdot::derive {
namespace {

enum Level { in_sum, in_product, in_power };

constexpr const char* letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";

class StatementPrinter {
 public:
  StatementPrinter(const Program& program, const Printing& printing)
      : program_(program),
        printing_(printing),
        uses_(program.ops.size()),
        variable_(program.ops.size()),
        used_(printing.reserved) {
    for (const Output& o : program.outputs) ++uses_[index(o.op)];
    for (std::size_t i = program.ops.size(); i-- > 0;) {
      if (uses_[i] == 0) continue;
      for (const int arg : program.ops[i].args) uses_[index(arg)] += times(program.ops[i], arg);
    }
  }

  std::vector<std::string> print() {
    // Quantities precede the outputs: an argument may be both read and written.
    for (std::size_t i = 0; i < program_.ops.size(); ++i) {
      if (uses_[i] > 0 && !program_.ops[i].name.empty()) named_[program_.ops[i].name] = static_cast<int>(i);
    }
    for (const Output& output : program_.outputs) {
      label_ = plain(output.name);
      serial_ = 0;
      for (const int arg : at(output.op).args) define(arg);
      if (uses_[index(output.op)] > 1) define(output.op);
    }
    std::map<int, std::string> assigned;
    for (const Output& output : program_.outputs) {
      if (printing_.zeroed && is_zero(output.op)) continue;
      // A negative that two outputs share is computed once: H[5][4] = H[4][5].
      const auto [first, is_new] = assigned.emplace(output.op, output.name);
      const bool copied = !is_new && is_negative(at(output.op));
      emit(output.name + " = " + (copied ? first->second : expression(output.op, in_sum)) + ";");
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

  bool is_zero(int op) const { return at(op).kind == OpKind::number && at(op).value.is_zero(); }

  // "d[arm].x", "B.g[0][arm].x"
  static bool has_name_in_brackets(const std::string& output) {
    for (std::size_t open = 0; (open = output.find('[', open)) != std::string::npos; ++open)
      if (output.find_first_not_of("0123456789", open + 1) != output.find(']', open)) return true;
    return false;
  }

  // The stem for names of nameless quantities of an output: "K21" for "K[1]", "wb" for "J.wb", "g1" for "g[0]",
  // "d_arm_x" for "d[arm].x".
  static std::string plain(const std::string& output) {
    if (has_name_in_brackets(output)) {
      std::string stem;
      for (const char c : output) {
        const bool letter = std::string_view(letters).find(c) != std::string_view::npos;
        if (letter || !stem.ends_with('_')) stem += letter ? c : '_';
      }
      return stem;
    }
    const bool of_object =
        output.size() > 2 && output[1] == '.' && std::string_view("JpBF").find(output[0]) != std::string_view::npos;
    const std::string name = output.substr(of_object ? 2 : 0);
    const std::size_t open = name.find('[');
    if (open == std::string::npos) return name;
    const int i = std::stoi(name.substr(open + 1));
    if (name[0] != 'K' && name[0] != 'F') return name.substr(0, open) + std::to_string(i + 1);
    int row = 0;
    while ((row + 1) * (row + 2) / 2 <= i) ++row;
    return fmt::format("{}{}{}", name[0], row + 1, i - row * (row + 1) / 2 + 1);
  }

  // ia_ra_x_t for I_a^-1 (ra x t): products with an inverse mass or inertia are named after both factors.
  std::string natural_name(const Operation& o) const {
    if (o.kind != OpKind::product || o.args.size() != 2) return "";
    if (o.exponents[0] != 1 || o.exponents[1] != 1) return "";
    const std::string mass = input_text(o.args[0]), other = operand(o.args[1], in_power);
    const bool inertia = mass.size() == 4 && mass[0] == 'm' && (mass.ends_with(".I") || mass.ends_with(".m"));
    const std::size_t dot = other.find("J.") == 0 ? 2 : 0;
    if (!inertia || other.find_first_not_of(letters, dot) != std::string::npos) return "";
    return fmt::format("{}{}_{}", mass[3] == 'I' ? "i" : "m", mass[1], other.substr(dot));
  }

  std::string input_text(int op) const { return at(op).kind == OpKind::input ? expression(op, in_sum) : ""; }

  bool is_atom(const Operation& op) const {
    return op.kind == OpKind::number || op.kind == OpKind::factor || op.kind == OpKind::input;
  }
  // -x and 2 x of one operand are written where they are used.
  static bool is_scaling(const Operation& op) { return op.kind == OpKind::sum && op.args.size() == 1; }

  static bool is_negative(const Operation& op) { return is_scaling(op) && op.coefs[0] == Rational(-1); }

  bool wants_variable(int op) const {
    const Operation& o = at(op);
    if (is_atom(o) || is_negative(o)) return false;
    return !o.name.empty() || uses_[index(op)] > 1;
  }

  void define(int op) {
    if (!variable_[index(op)].empty()) return;
    define_sibling(at(op).name, "_y", "x");
    for (const int arg : at(op).args) define(arg);
    // A sibling that was defined first may already have defined this one.
    if (!variable_[index(op)].empty() || !wants_variable(op)) return;
    std::string name = at(op).name;
    if (name.empty()) name = natural_name(at(op));
    if (name.empty()) name = fmt::format("{}_{}", label_, ++serial_);
    const std::string value = expression(op, in_sum);
    variable_[index(op)] = unused(std::move(name));
    emit("const T " + variable_[index(op)] + " = " + value + ";");
    define_sibling(at(op).name, "_x", "y");
  }

  // The components of a vector come together, x first.
  void define_sibling(const std::string& name, const char* ending, const char* other) {
    if (!name.ends_with(ending)) return;
    const auto sibling = named_.find(name.substr(0, name.size() - 1) + other);
    if (sibling != named_.end() && begun_.insert(sibling->second).second) define(sibling->second);
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

  static std::string parenthesised(std::string s, bool needed) { return needed ? "(" + s + ")" : s; }

  static std::string number(Rational value) {
    if (value.is_integer()) return fmt::format("T({})", value.num());
    return fmt::format("T({})", value.value());
  }

  std::string expression(int op, Level level) const {
    const Operation& o = at(op);
    if (!variable_[index(op)].empty()) return variable_[index(op)];
    switch (o.kind) {
      case OpKind::number:
      case OpKind::factor: return number(o.value);
      case OpKind::input: {
        const auto found = printing_.inputs.find(o.input);
        return found == printing_.inputs.end() ? o.input.text() : found->second;
      }
      case OpKind::sum: return sum_text(o, level);
      case OpKind::product: return parenthesised(product_text(o), level >= in_power);
      case OpKind::function: return function_text(o);
    }
    return "";
  }

  std::string sum_text(const Operation& o, Level level) const {
    const Lead lead = lead_of(program_, o);
    std::string s = lead.negated ? "-" : "";
    const auto append = [&](std::size_t i) {
      const bool leads = i == lead.term;
      if (!leads) s += o.coefs[i].sign() < 0 ? " - " : " + ";
      const Rational c = leads && !lead.negated ? o.coefs[i] : abs(o.coefs[i]);
      if (at(o.args[i]).kind == OpKind::number) {
        s += number(c * at(o.args[i]).value);
        return;
      }
      if (c != Rational(1)) s += number(c) + " * ";
      s += operand(o.args[i], in_product);
    };
    append(lead.term);
    for (std::size_t i = 0; i < o.args.size(); ++i) {
      if (i != lead.term) append(i);
    }
    const bool scaled_only = is_scaling(o) && !lead.negated;
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
    const Function& f = function_of(o.fn);
    if (f.code.empty()) return fmt::format("{}({})", f.name, fmt::join(args, ", "));
    fmt::dynamic_format_arg_store<fmt::format_context> store;
    for (const std::string& arg : args) store.push_back(arg);
    return fmt::vformat(f.code, store);
  }

  const Program& program_;
  const Printing& printing_;
  std::vector<int> uses_;
  std::vector<std::string> variable_;
  std::set<std::string> used_;
  std::vector<std::string> lines_;
  std::map<std::string, int> named_;
  std::set<int> begun_;  // siblings that are being defined
  std::string label_;
  int serial_ = 0;
};

}  // namespace

std::vector<std::string> print_statements(const Program& program, const Printing& printing) {
  return StatementPrinter(program, printing).print();
}

std::set<std::string> inputs_read(const Program& program, const Printing& printing) {
  std::set<std::string> read;
  const std::vector<int> uses = use_counts(program);
  for (std::size_t i = 0; i < uses.size(); ++i) {
    const Operation& op = program.ops[i];
    if (uses[i] == 0 || op.kind != OpKind::input) continue;
    const auto found = printing.inputs.find(op.input);
    read.insert(found == printing.inputs.end() ? op.input.text() : found->second);
  }
  return read;
}

// The byte at which the character in that column starts, or the end.
static std::size_t byte_of_column(const std::string& line, std::size_t column) {
  std::size_t i = 0;
  for (; i < line.size(); ++i) {
    const bool starts = (static_cast<unsigned char>(line[i]) & 0xC0) != 0x80;
    if (starts && column-- == 0) break;
  }
  return i;
}

std::vector<std::string> wrapped(std::string line, Break where) {
  constexpr std::size_t columns = 100;
  std::vector<std::string> lines;
  const std::size_t indent = line.find_first_not_of(' ');
  for (std::size_t end; (end = byte_of_column(line, columns)) < line.size();) {
    std::size_t best = std::string::npos;
    int depth = 0, best_depth = 1000;
    for (std::size_t i = indent; i < end; ++i) {
      if (line[i] == '(' || line[i] == '[') ++depth;
      if (line[i] == ')' || line[i] == ']') --depth;
      const bool after_operator = i > indent && std::string_view("+-*,|").find(line[i - 1]) != std::string_view::npos;
      const bool allowed =
          line[i] == ' ' && i > columns / 3 && (where == Break::at_spaces || (after_operator && depth <= best_depth));
      if (allowed) best = i, best_depth = depth;
    }
    if (best == std::string::npos) break;
    lines.push_back(line.substr(0, best));
    line = std::string(indent + 4, ' ') + line.substr(best + 1);
  }
  lines.push_back(std::move(line));
  return lines;
}

}  // namespace cdot::derive
