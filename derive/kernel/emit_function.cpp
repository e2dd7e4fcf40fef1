#include "derive/kernel/emit_function.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "derive/kernel/factor.hpp"

namespace cdot::derive {
namespace {

// Inputs and output of each function of the contract (runtime/include/cdot/kernel.hpp).
struct Signature {
  std::vector<std::string> inputs;
  std::string output;
};

const std::map<std::string, Signature>& signatures() {
  static const std::map<std::string, Signature> table = {
      {"position", {{"q", "p", "time"}, "T (&C)[ROWS]"}},
      {"jacobian", {{"q", "p", "time"}, "T (&C)[ROWS], Jacobian<T>& J"}},
      {"effective_mass", {{"J", "m"}, "T (&K)[TRIANGLE]"}},
      {"factor", {{"K"}, "T (&F)[TRIANGLE]"}},
      {"solve", {{"F", "rhs"}, "T (&lambda)[ROWS]"}},
      {"velocity", {{"J", "v"}, "T (&Jv)[ROWS]"}},
      {"apply", {{"J", "m", "lambda"}, "Velocity<T> (&v)[BODIES]"}},
      {"dense", {{"J"}, "T (&D)[ROWS][COLUMNS]"}},
      {"inverse_mass_jacobian", {{"J", "m"}, "T (&D)[ROWS][COLUMNS]"}},
      {"gamma", {{"q", "v", "p", "time"}, "T (&g)[ROWS]"}},
      {"time_derivative", {{"q", "p", "time"}, "T (&C_t)[ROWS]"}},
      {"local_jacobian", {{"q", "J"}, "T (&D)[ROWS][COLUMNS]"}},
      {"euler_jacobian", {{"q", "J"}, "T (&D)[ROWS][EULER]"}},
      {"stiffness", {{"q", "p", "time", "lambda"}, "T (&H)[COLUMNS][COLUMNS]"}},
      // of an effect
      {"energy", {{"C", "p"}, "T& E"}},
      {"force", {{"C", "rate", "p", "time"}, "T (&F)[ROWS]"}},
      {"unstored", {{"C", "rate", "p", "time"}, "T (&F)[ROWS]"}},
      {"slopes", {{"C", "rate", "p", "time"}, "T (&k)[ROWS][ROWS], T (&d)[ROWS][ROWS]"}},
      {"limits", {{"C", "p", "time"}, "T (&lower)[ROWS], T (&upper)[ROWS]"}},
      {"bounds", {{"C", "p", "time"}, "RowBounds<T>& B"}},
      {"by_load", {{"C", "p", "time"}, "RowBounds<T>& B"}},
      {"after", {{"C", "rate", "p", "time", "load"}, "T& D"}},
      {"until", {{"C", "rate", "p", "time", "load"}, "T& D"}},
      {"breaks", {{"p", "time", "load"}, "T& D"}}};
  return table;
}

// Declarations with a place for the name. An argument that is not read gets no name.
const std::map<std::string, std::string>& declarations() {
  static const std::map<std::string, std::string> table = {{"q", "const Pose<T> (&{})[BODIES]"},
                                                           {"v", "const Velocity<T> (&{})[BODIES]"},
                                                           {"m", "const InverseMass<T> (&{})[BODIES]"},
                                                           {"p", "const Parameters<T>& {}"},
                                                           {"time", "T {}"},
                                                           {"J", "const Jacobian<T>& {}"},
                                                           {"K", "const T (&{})[TRIANGLE]"},
                                                           {"F", "const T (&{})[TRIANGLE]"},
                                                           {"rhs", "const T (&{})[ROWS]"},
                                                           {"lambda", "const T (&{})[ROWS]"},
                                                           {"C", "const T (&{})[ROWS]"},
                                                           {"rate", "const T (&{})[ROWS]"},
                                                           {"mass", "T {}"},
                                                           {"load", "T {}"},
                                                           {"index", "int {}"}};
  return table;
}

std::string replaced(std::string s, const std::string& what, const std::string& by) {
  for (std::size_t at = s.find(what); at != std::string::npos; at = s.find(what, at + by.size())) {
    s.replace(at, what.size(), by);
  }
  return s;
}

bool mentions(const std::set<std::string>& read, const std::string& name) {
  return std::any_of(read.begin(), read.end(), [&](const std::string& r) {
    return r == name || r.starts_with(name + ".") || r.starts_with(name + "[");
  });
}

std::string indent(int depth) { return std::string(2 * static_cast<std::size_t>(depth), ' '); }

void append(std::vector<std::string>& lines, std::vector<std::string> more) {
  lines.insert(lines.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

// Functions of <cmath>. A using-declaration lets a pack's own be found as well.
std::set<std::string> mathematical_functions(const Program& program) {
  std::set<std::string> functions;
  for (const Operation& op : program.ops) {
    if (op.kind != OpKind::function || function_of(op.fn).of_contract) continue;
    functions.insert(std::string(name_of(op.fn)));
  }
  return functions;
}

// Matrices that are mostly zero are cleared first.
bool is_cleared(const std::string& function) {
  return function == "dense" || function == "inverse_mass_jacobian" || function == "stiffness" ||
         function == "local_jacobian" || function == "euler_jacobian";
}

}  // namespace

FunctionWriter::FunctionWriter(const Joint& joint)
    : bodies_(joint.bodies.size()),
      width_(columns_per_body(joint.dimension)),
      on_any_coordinate_(joint.on_any_coordinate()),
      reads_mass_(joint.law && joint.law->mass) {
  for (std::size_t b = 0; b < bodies_; ++b) name_inputs_of_body(joint, b);
  auto& in = printing_.inputs;
  std::size_t rows = width_ * bodies_;  // at most, but an effect may have rows that depend on each other
  for (const Row& row : joint.rows) rows += row.C->vector ? width_ : 1;
  for (std::size_t i = 0; i < rows; ++i) {
    in[fmt::format("lambda_{}", i + 1)] = fmt::format("lambda[{}]", i);
  }
  in["pi"] = "T(3.14159265358979323846)";
  in["unlimited"] = "T(unbounded)";
  for (const Parameter& p : joint.parameters) {
    if (p.kind == ParameterKind::scalar) in[p.name] = "p." + p.name;
  }
  if (joint.law) name_inputs_of_law(joint);
  for (const BodyPart& part : parts_) printing_.reserved.insert(part.name);
  for (const auto& [name, declaration] : declarations()) printing_.reserved.insert(name);
  for (const char* name : {"C",   "D",     "H",    "Jv",     "g",     "C_t",    "T",      "smallest", "rows",  "bodies",
                           "int", "float", "auto", "double", "const", "static", "struct", "name",     "title", "and",
                           "or",  "not",   "new",  "this",   "for",   "if",     "do",     "else",     "long"}) {
    printing_.reserved.insert(name);
  }
  for (const Function& f : functions) printing_.reserved.emplace(f.name);
}

// The leaves of a law are elements of C and of its rate.
void FunctionWriter::name_inputs_of_law(const Joint& joint) {
  std::size_t row = 0;
  const auto name = [&](const LawInput& input, const std::string& axis) {
    if (input.value) printing_.inputs[input.value->symbol + axis] = element("C", row);
    printing_.inputs[input.rate->symbol + axis] = element("rate", row++);
  };
  for (const LawInput& input : joint.law->inputs) {
    if (!input.rate->vector) name(input, "");
    for (int k = 0; k < joint.dimension && input.rate->vector; ++k) name(input, std::string("_") + "xyz"[k]);
  }
  if (joint.law->mass) printing_.inputs[joint.law->mass->symbol] = "mass";
  printing_.inputs[bounded_value] = "C[0]";
  printing_.inputs[bounded_rate] = "rate[0]";
  printing_.inputs[bounded_load] = "load";
  for (const char* name : {"B", "E", "k", "d", "lower", "upper"}) printing_.reserved.insert(name);
}

void FunctionWriter::name_inputs_of_body(const Joint& joint, std::size_t b) {
  auto& in = printing_.inputs;
  const std::string& L = joint.bodies[b];
  parts_.push_back({L, "q", "Pose<T>", b});
  parts_.push_back({"v" + L, "v", "Velocity<T>", b});
  parts_.push_back({"m" + L, "m", "InverseMass<T>", b});
  for (int k = 0; k < joint.dimension; ++k) {
    const std::string axis(1, "xyz"[k]);
    in["x_" + L + "_" + axis] = L + "." + axis;
    in["v_" + L + "_" + axis] = "v" + L + "." + axis;
    in["w_" + L + "_" + axis] = "v" + L + ".w" + axis;
  }
  in["theta_" + L] = L + ".angle";
  in["w_" + L] = "v" + L + ".w";
  in["inv_m_" + L] = "m" + L + ".m";
  in["inv_I_" + L] = "m" + L + ".I";
  for (const char* component : {"xx", "yy", "zz", "xy", "xz", "yz"}) {
    in["inv_I_" + L + "_" + component] = "m" + L + ".I" + component;
  }
}

bool FunctionWriter::reads(const std::set<std::string>& read, const std::string& argument) const {
  return mentions(read, argument) || std::any_of(parts_.begin(), parts_.end(), [&](const BodyPart& part) {
           return part.argument == argument && mentions(read, part.name);
         });
}

std::string FunctionWriter::arguments(const std::vector<std::string>& names, const std::set<std::string>& read,
                                      std::size_t rows) const {
  std::string list;
  for (const std::string& name : names) {
    std::string declaration = declarations().at(name);
    if (reads(read, name)) {
      declaration = replaced(declaration, "{}", name);
    } else {
      declaration = replaced(replaced(declaration, " {}", ""), "{}", "");
    }
    list += (list.empty() ? "" : ", ") + declaration;
  }
  return sized(std::move(list), rows);
}

// Replaces the contract's array sizes by numbers.
std::string FunctionWriter::sized(std::string declaration, std::size_t rows) const {
  declaration = replaced(declaration, "[BODIES]", fmt::format("[{}]", bodies_));
  declaration = replaced(declaration, "[COLUMNS]", fmt::format("[{}]", width_ * bodies_));
  declaration = replaced(declaration, "[EULER]", fmt::format("[{}]", 7 * bodies_));
  declaration = replaced(declaration, "[TRIANGLE]", fmt::format("[{}]", rows * (rows + 1) / 2));
  return replaced(declaration, "[ROWS]", fmt::format("[{}]", rows));
}

std::vector<std::string> FunctionWriter::body(const Program& program, const BodyOptions& options, int depth) const {
  std::vector<std::string> lines;
  for (const std::string& f : mathematical_functions(program)) {
    lines.push_back(indent(depth) + "using std::" + f + ";");
  }
  const std::set<std::string> read = inputs_read(program, printing_);
  for (const BodyPart& part : parts_) {
    if (!mentions(read, part.name)) continue;
    // `apply` reads the velocities that it overwrites: by value.
    const char* reference = options.in_place && part.argument == "v" ? "" : "&";
    const std::string mass = options.isotropic && part.argument == "m" ? "Isotropic" : "";
    lines.push_back(fmt::format("{}const {}{}{} {} = {}[{}];", indent(depth), mass, part.type, reference, part.name,
                                part.argument, part.body));
  }
  Printing printing = printing_;
  printing.indent = indent(depth);
  printing.zeroed = options.zeroed;
  append(lines, print_statements(program, printing));
  return lines;
}

std::vector<std::string> FunctionWriter::function(const KernelFunction& f, std::size_t rows, int depth) const {
  const std::string& name = f.name;
  const Program& program = f.program;
  const Signature& signature = signatures().at(name);
  std::vector<std::string> inputs = signature.inputs;
  if (reads_mass_) inputs.emplace_back("mass");
  std::string list = arguments(inputs, inputs_read(program, printing_), rows);
  if (f.isotropic) list = replaced(list, "const InverseMass<T>", "const IsotropicInverseMass<T>");
  std::string output = sized(signature.output, rows);
  const bool writes_jacobian = std::any_of(program.outputs.begin(), program.outputs.end(),
                                           [](const Output& o) { return o.name.starts_with("J."); });
  if (program.outputs.empty()) output = replaced(output, "RowBounds<T>& B", "RowBounds<T>&");
  if (!writes_jacobian) output = replaced(output, "Jacobian<T>& J", "Jacobian<T>&");
  std::vector<std::string> lines = {indent(depth) + "template <class T>"};
  append(lines, wrapped(fmt::format("{}static void {}({}, {}) {{", indent(depth), name, list, output)));
  const bool zeroed = is_cleared(name);
  if (zeroed) {
    const char* matrix = name == "stiffness" ? "H" : "D";
    lines.push_back(fmt::format("{}for (auto& row : {}) {{", indent(depth + 1), matrix));
    lines.push_back(fmt::format("{}for (T& entry : row) entry = T(0);", indent(depth + 2)));
    lines.push_back(indent(depth + 1) + "}");
  }
  append(lines, body(program, {name == "apply", zeroed, f.isotropic}, depth + 1));
  lines.push_back(indent(depth) + "}");
  return lines;
}

std::vector<std::string> FunctionWriter::default_value(const std::vector<Case>& cases) const {
  std::set<std::string> read;
  for (const Case& c : cases) {
    read.merge(inputs_read(*c.program, printing_));
    read.insert({"index", "p"});
  }
  std::string list = on_any_coordinate_ ? arguments({"index"}, read, 0) : arguments({"index", "q"}, read, 0);
  list += cases.empty() ? ", Parameters<T>&" : ", Parameters<T>& p";
  list += ", " + arguments({"time"}, read, 0);
  std::vector<std::string> lines = {"  template <class T>"};
  append(lines, wrapped(fmt::format("  static void default_value({}) {{", list)));
  if (!cases.empty()) {
    lines.push_back("    switch (index) {");
    for (const Case& c : cases) {
      append(lines, wrapped(fmt::format("      case {}: {{  // {}", c.index, c.comment)));
      append(lines, body(*c.program, {}, 4));
      lines.push_back("        break;");
      lines.push_back("      }");
    }
    lines.push_back("      default: break;");
    lines.push_back("    }");
  }
  lines.push_back("  }");
  return lines;
}

}  // namespace cdot::derive
