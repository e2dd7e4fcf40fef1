// Kernels to C++: generated/planar/<joint>.hpp and the registry.
#include <fmt/format.h>

#include <algorithm>

#include "derive/emit.hpp"
#include "derive/print_program.hpp"

namespace cdot::derive {
namespace {

// Signatures of the contract: parameters by the names that the statements use. N: bodies, R: rows, T: numbers of the
// triangle of K.
struct Signature {
  const char* function;
  std::vector<const char*> inputs;
  const char* output;
};

const std::vector<Signature>& signatures() {
  static const std::vector<Signature> list = {
      {"position", {"q", "p", "time"}, "T (&C)[R]"},
      {"jacobian", {"q", "p", "time"}, "T (&C)[R], Jacobian<T>& J"},
      {"effective_mass", {"J", "m"}, "T (&K)[TRI]"},
      {"factor", {"K"}, "T (&F)[TRI]"},
      {"solve", {"F", "b"}, "T (&lambda)[R]"},
      {"velocity", {"J", "v"}, "T (&Jv)[R]"},
      {"apply", {"J", "m", "lambda"}, "Velocity<T> (&v)[N]"},
      {"dense", {"J"}, "T (&D)[R][COLUMNS]"},
      {"inverse_mass_jacobian", {"J", "m"}, "T (&D)[R][COLUMNS]"},
      {"gamma", {"q", "v", "p", "time"}, "T (&g)[R]"},
      {"time_derivative", {"q", "p", "time"}, "T (&C_t)[R]"},
      {"stiffness", {"q", "p", "time", "lambda"}, "T (&H)[COLUMNS][COLUMNS]"}};
  return list;
}

const std::map<std::string, std::string>& input_types() {
  static const std::map<std::string, std::string> types = {
      {"q", "const Pose<T> (&q)[N]"},          {"v", "const Velocity<T> (&v)[N]"},
      {"m", "const InverseMass<T> (&m)[N]"},   {"p", "const Parameters<T>& p"},
      {"time", "T time"},                      {"J", "const Jacobian<T>& J"},
      {"K", "const T (&K)[TRI]"},              {"F", "const T (&F)[TRI]"},
      {"b", "const T (&b)[R]"},                {"lambda", "const T (&lambda)[R]"}};
  return types;
}

std::string replaced(std::string s, const std::string& what, const std::string& by) {
  for (std::size_t at = s.find(what); at != std::string::npos; at = s.find(what, at + by.size())) {
    s.replace(at, what.size(), by);
  }
  return s;
}

const char* text(RowKind kind) {
  switch (kind) {
    case RowKind::equality: return "equality";
    case RowKind::inequality: return "inequality";
    case RowKind::velocity: return "velocity";
  }
  return "";
}

const char* text(ParameterKind kind) {
  switch (kind) {
    case ParameterKind::point: return "point";
    case ParameterKind::vector: return "vector";
    case ParameterKind::unit: return "unit";
    case ParameterKind::frame: return "frame";
    case ParameterKind::scalar: return "scalar";
  }
  return "";
}

std::string quoted(const std::string& s) {
  return "\"" + replaced(replaced(s, "\\", "\\\\"), "\"", "\\\"") + "\"";
}

class KernelWriter {
 public:
  explicit KernelWriter(const Kernel& kernel) : kernel_(kernel), joint_(*kernel.joint) {
    for (std::size_t b = 0; b < joint_.bodies.size(); ++b) {
      const std::string& L = joint_.bodies[b];
      bodies_.push_back({L, "q", fmt::format("const Pose<T>& {0} = q[{1}];", L, b)});
      bodies_.push_back({"v" + L, "v", fmt::format("const Velocity<T>& v{0} = v[{1}];", L, b)});
      bodies_.push_back({"m" + L, "m", fmt::format("const InverseMass<T>& m{0} = m[{1}];", L, b)});
      auto& in = printing_.inputs;
      for (const char* axis : {"x", "y"}) {
        in["x_" + L + "_" + axis] = L + "." + axis;
        in["v_" + L + "_" + axis] = "v" + L + "." + axis;
      }
      in["theta_" + L] = L + ".angle";
      in["c_" + L] = L + ".c";
      in["s_" + L] = L + ".s";
      in["w_" + L] = "v" + L + ".w";
      in["inv_m_" + L] = "m" + L + ".m";
      in["inv_I_" + L] = "m" + L + ".I";
    }
    for (std::size_t i = 0; i < 9; ++i) {
      printing_.inputs["lambda_" + std::to_string(i + 1)] = "lambda[" + std::to_string(i) + "]";
    }
    printing_.inputs["pi"] = "T(3.14159265358979323846)";
    for (const Parameter& p : joint_.parameters) {
      if (p.kind == ParameterKind::scalar) printing_.inputs[p.name] = "p." + p.name;
    }
    for (const Borrowed& body : bodies_) printing_.reserved.insert(body.name);
    for (const auto& [name, type] : input_types()) printing_.reserved.insert(name);
    for (const char* name : {"C", "D", "H", "Jv", "g", "C_t", "T", "abs", "sign", "select", "inverse", "pivot",
                             "sqrt", "sin", "cos", "tan", "exp", "log", "atan2", "rows", "bodies", "int",
                             "double", "float", "new", "this", "auto", "for", "if", "do", "name", "title"}) {
      printing_.reserved.insert(name);
    }
  }

  std::string write() {
    header();
    line("struct " + joint_.name + " {");
    metadata();
    parameters();
    block(kernel_.rows, 1);
    defaults();
    for (const KernelBlock& coordinate : kernel_.coordinates) {
      line("");
      const Coordinate& c = *std::find_if(joint_.coordinates.begin(), joint_.coordinates.end(),
                                          [&](const Coordinate& x) { return x.name == coordinate.name; });
      comment(1, fmt::format("Coordinate {} [{}] = {}", c.name, derive::text(c.unit), c.text));
      nested(coordinate, 1);
    }
    immovables(kernel_.rows, 1);
    tuple("Coordinates", kernel_.coordinates, 1);
    line("};");
    line("");
    line("}  // namespace cdot::planar");
    return std::move(out_);
  }

 private:
  // A reference to one body's entry of an argument: `const Pose<T>& a = q[0];`
  struct Borrowed {
    std::string name, array, declaration;
  };

  void line(const std::string& s, int depth = 0) {
    if (!s.empty()) out_ += std::string(2 * static_cast<std::size_t>(depth), ' ') + s;
    out_ += '\n';
  }

  void comment(int depth, const std::string& s) {
    const std::string indent(2 * static_cast<std::size_t>(depth), ' ');
    for (std::string& part : wrapped(indent + "// " + s)) {
      const std::size_t text_at = part.find_first_not_of(' ');
      if (part.compare(text_at, 2, "//") != 0) part = indent + "//     " + part.substr(text_at);
      out_ += part + '\n';
    }
  }

  void header() {
    line("// Generated by `cdot derive` from specs/planar/" + joint_.name + ".joint. Do not edit: change the spec.");
    line("//");
    for (const std::string& s : describe(kernel_)) line(s.empty() ? "//" : "// " + s);
    line("#pragma once");
    line("");
    line("#include \"runtime/kernel.hpp\"");
    line("");
    line("namespace cdot::planar {");
    line("");
  }

  void metadata() {
    line("static_assert(kernel_contract == 1);", 1);
    line("static constexpr std::string_view name = " + quoted(joint_.name) + ";", 1);
    for (const std::string& s : wrapped("  static constexpr std::string_view title = " + quoted(joint_.title) + ";")) {
      line(s);
    }
    std::string names;
    for (const std::string& body : joint_.bodies) names += (names.empty() ? "" : ", ") + quoted(body);
    line(fmt::format("static constexpr std::array<std::string_view, {}> body_names = {{{}}};",
                     joint_.bodies.size(), names), 1);
  }

  void parameters() {
    const std::size_t n = joint_.parameters.size();
    line("");
    line("template <class T>", 1);
    line("struct Parameters {", 1);
    for (const Parameter& p : joint_.parameters) {
      std::string members;
      if (p.kind == ParameterKind::scalar) members = p.name;
      else members = field_name(p, 0) + ", " + field_name(p, 1);
      const std::string where = p.body < 0 ? "the world" : joint_.bodies[static_cast<std::size_t>(p.body)];
      line(fmt::format("T {};  // {}", members, p.kind == ParameterKind::scalar
               ? fmt::format("[{}]", derive::text(p.unit))
               : fmt::format("{} fixed in {}{}", text(p.kind), where,
                             p.kind == ParameterKind::unit || p.kind == ParameterKind::frame
                                 ? "" : " [" + derive::text(p.unit) + "]")), 2);
    }
    line("};", 1);
    line(fmt::format("static constexpr std::array<ParameterInfo, {}> parameters = {{{{", n), 1);
    int offset = 0;
    for (const Parameter& p : joint_.parameters) {
      line(fmt::format("{{{}, ParameterKind::{}, {}, {}, {}, {}, {}}},", quoted(p.name), text(p.kind), p.body,
                       quoted(derive::text(p.unit)), offset, size_of(p), p.default_value ? "true" : "false"), 3);
      offset += size_of(p);
    }
    line("}};", 1);
  }

  // Members that every row block has.
  void block(const KernelBlock& b, int depth) {
    const std::size_t rows = b.block.rows.size();
    line("");
    line(fmt::format("static constexpr int bodies = {}, rows = {};", joint_.bodies.size(), rows), depth);
    if (b.block.immovable >= 0) {
      line(fmt::format("static constexpr int immovable_body = {};", b.block.immovable), depth);
    }
    line(fmt::format("static constexpr bool explicit_time = {};", depends_on_time(b.block)), depth);
    std::string names, kinds;
    for (const ScalarRow& row : b.block.rows) {
      names += (names.empty() ? "" : ", ") + quoted(row.name);
      kinds += (kinds.empty() ? "" : ", ") + std::string("RowKind::") + text(row.kind);
    }
    for (const std::string& s : wrapped(fmt::format("{}static constexpr std::array<std::string_view, {}> row_names = {{{}}};",
                                                    std::string(2 * static_cast<std::size_t>(depth), ' '), rows, names))) {
      line(s);
    }
    for (const std::string& s : wrapped(fmt::format("{}static constexpr std::array<RowKind, {}> row_kinds = {{{}}};",
                                                    std::string(2 * static_cast<std::size_t>(depth), ' '), rows, kinds))) {
      line(s);
    }
    jacobian_struct(b, depth);
    for (const KernelFunction& f : b.functions) function(b, f, depth);
  }

  static bool depends_on_time(const Block& block) {
    return std::any_of(block.rows.begin(), block.rows.end(), [](const ScalarRow& row) {
      const Expr roots[] = {row.C, row.Cdot};
      const std::vector<Expr> all = topological(roots);
      return std::any_of(all.begin(), all.end(), [](Expr e) {
        return e->kind == Kind::symbol && e->role == Role::time;
      });
    });
  }

  void jacobian_struct(const KernelBlock& b, int depth) {
    line("");
    if (b.fields.empty()) {
      line("template <class T>", depth);
      line("struct Jacobian {};  // J is constant", depth);
      return;
    }
    line("template <class T>", depth);
    line("struct Jacobian {", depth);
    std::string names;
    for (const Field& f : b.fields) names += (names.empty() ? "" : ", ") + f.name;
    for (const std::string& s :
         wrapped(std::string(2 * static_cast<std::size_t>(depth + 1), ' ') + "T " + names + ";")) {
      line(s);
    }
    line("};", depth);
  }

  std::string sized(std::string s, std::size_t rows) const {
    s = replaced(s, "[N]", fmt::format("[{}]", joint_.bodies.size()));
    s = replaced(s, "[TRI]", fmt::format("[{}]", rows * (rows + 1) / 2));
    s = replaced(s, "[COLUMNS]", fmt::format("[{}]", 3 * joint_.bodies.size()));
    return replaced(s, "[R]", fmt::format("[{}]", rows));
  }

  // "const T (&b)[1]" without its name, for an argument that is not read.
  static std::string unnamed(const std::string& declaration, const std::string& name) {
    const std::string in_array = "(&" + name + ")";
    if (declaration.find(in_array) != std::string::npos) return replaced(declaration, in_array, "(&)");
    return declaration.substr(0, declaration.size() - name.size() - (declaration[declaration.size() - name.size() - 1] == ' ' ? 1 : 0));
  }

  static bool mentions(const std::set<std::string>& read, const std::string& name) {
    return std::any_of(read.begin(), read.end(), [&](const std::string& r) {
      return r == name || r.rfind(name + ".", 0) == 0 || r.rfind(name + "[", 0) == 0;
    });
  }

  void function(const KernelBlock& b, const KernelFunction& f, int depth) {
    const Signature& signature = *std::find_if(signatures().begin(), signatures().end(),
                                               [&](const Signature& s) { return f.name == s.function; });
    line("");
    line(fmt::format("// {}: {}", f.summary, derive::text(count(f.program))), depth);
    const bool forward = b.block.immovable >= 0 && (f.name == "position" || f.name == "time_derivative");
    write_function(f.name, signature.inputs, signature.output, f.program, b.block.rows.size(), depth, forward);
  }

  void write_function(const std::string& name, const std::vector<const char*>& inputs, const std::string& output,
                      const Program& program, std::size_t rows, int depth, bool) {
    std::set<std::string> read = inputs_read(program, printing_);
    std::vector<std::string> body = preamble(program, read, name == "apply", depth + 1);
    Printing printing = printing_;
    printing.indent = std::string(2 * static_cast<std::size_t>(depth + 1), ' ');
    const std::vector<std::string> statements = print_statements(program, printing);
    body.insert(body.end(), statements.begin(), statements.end());
    std::string arguments;
    for (const char* input : inputs) {
      bool used = mentions(read, input);
      for (const Borrowed& body_reference : bodies_) {
        used = used || (body_reference.array == input && mentions(read, body_reference.name));
      }
      const std::string& declaration = input_types().at(input);
      arguments += (used ? declaration : unnamed(declaration, input)) + ", ";
    }
    arguments += program.outputs.empty() ? "" : output;
    line("template <class T>", depth);
    const std::string head = std::string(2 * static_cast<std::size_t>(depth), ' ') + "static void " + name + "(" +
                             sized(arguments, rows) + ") {";
    for (const std::string& s : wrapped(head)) line(s);
    for (const std::string& s : body) line(s);
    line("}", depth);
  }

  // using std::sqrt; and the references to the bodies that are read.
  std::vector<std::string> preamble(const Program& program, const std::set<std::string>& read, bool in_place, int depth) const {
    const std::string indent(2 * static_cast<std::size_t>(depth), ' ');
    std::vector<std::string> lines;
    std::set<std::string> functions;
    for (const Operation& op : program.ops) {
      if (op.kind != OpKind::function) continue;
      if (op.fn == Fn::sqrt || op.fn == Fn::sin || op.fn == Fn::cos || op.fn == Fn::tan || op.fn == Fn::exp ||
          op.fn == Fn::log || op.fn == Fn::atan2) {
        functions.insert(std::string(name_of(op.fn)));
      }
    }
    for (const std::string& f : functions) lines.push_back(indent + "using std::" + f + ";");
    for (const Borrowed& body : bodies_) {
      if (!mentions(read, body.name)) continue;
      // The velocities are read and written by `apply`.
      const bool written = in_place && body.array == "v";
      lines.push_back(indent + (written ? replaced(body.declaration, "const Velocity<T>&", "const Velocity<T>") : body.declaration));
    }
    return lines;
  }

  void nested(const KernelBlock& b, int depth) {
    line("struct " + b.name + " {", depth);
    if (b.block.immovable < 0) line("static constexpr std::string_view name = " + quoted(b.name) + ";", depth + 1);
    block(b, depth + 1);
    if (b.block.immovable < 0) immovables(b, depth + 1);
    line("};", depth);
  }

  void immovables(const KernelBlock& b, int depth) {
    for (const KernelBlock& variant : b.variants) {
      line("");
      comment(depth, fmt::format("With {} immovable: its velocity and inverse mass are zero and gone.",
                                 joint_.bodies[static_cast<std::size_t>(variant.block.immovable)]));
      nested(variant, depth);
    }
    tuple("Immovable", b.variants, depth);
  }

  void tuple(const std::string& name, const std::vector<KernelBlock>& blocks, int depth) {
    std::string list;
    for (const KernelBlock& b : blocks) list += (list.empty() ? "" : ", ") + b.name;
    line("");
    line("using " + name + " = std::tuple<" + list + ">;", depth);
  }

  void defaults() {
    line("");
    line("// The default of parameter `index`, from the initial pose and the parameters before it.", 1);
    line("template <class T>", 1);
    std::set<std::string> read;
    for (const DefaultValue& d : kernel_.defaults) read.merge(inputs_read(d.program, printing_));
    bool poses = false;
    for (const Borrowed& body : bodies_) poses = poses || (body.array == "q" && mentions(read, body.name));
    const std::string q = input_types().at("q"), time = input_types().at("time");
    const std::string arguments = fmt::format(
        "{}, {}, {}, {}", kernel_.defaults.empty() ? "int" : "int index", poses ? q : unnamed(q, "q"),
        kernel_.defaults.empty() ? "Parameters<T>&" : "Parameters<T>& p",
        mentions(read, "time") ? time : unnamed(time, "time"));
    for (const std::string& s : wrapped("  static void default_value(" + sized(arguments, 0) + ") {")) line(s);
    if (!kernel_.defaults.empty()) {
      line("switch (index) {", 2);
      for (const DefaultValue& d : kernel_.defaults) default_case(d);
      line("default: break;", 3);
      line("}", 2);
    }
    line("}", 1);
  }

  void default_case(const DefaultValue& d) {
    const Parameter& p = joint_.parameters[static_cast<std::size_t>(d.parameter)];
    line(fmt::format("case {}: {{  // {} = {}", d.parameter, p.name, derive::text(p.default_value)), 3);
    for (const std::string& s : preamble(d.program, inputs_read(d.program, printing_), false, 4)) line(s);
    Printing printing = printing_;
    printing.indent = std::string(8, ' ');
    for (const std::string& s : print_statements(d.program, printing)) line(s);
    line("break;", 4);
    line("}", 3);
  }

  const Kernel& kernel_;
  const Joint& joint_;
  std::vector<Borrowed> bodies_;
  Printing printing_;
  std::string out_;
};

}  // namespace

std::string emit_kernel(const Kernel& kernel) { return KernelWriter(kernel).write(); }

std::string emit_registry(const std::vector<std::string>& joints) {
  std::string s =
      "// Generated by `cdot derive`. Do not edit. Every joint that a runtime can be asked for by name.\n"
      "#pragma once\n\n";
  for (const std::string& joint : joints) s += "#include \"generated/planar/" + joint + ".hpp\"\n";
  s += "\nnamespace cdot::planar {\n\nusing Joints = std::tuple<\n";
  for (std::size_t i = 0; i < joints.size(); ++i) {
    s += "    " + joints[i] + (i + 1 < joints.size() ? ",\n" : ">;\n");
  }
  return s + "\n}  // namespace cdot::planar\n";
}

}  // namespace cdot::derive
