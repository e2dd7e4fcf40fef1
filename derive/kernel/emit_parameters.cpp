#include "derive/kernel/emit_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "derive/kernel/plan.hpp"

namespace cdot::derive {
namespace {

constexpr const char* parameter_kinds[] = {"point", "vector", "unit", "frame",
                                           "scalar"};  // in the order of ParameterKind
const char* name_of_kind(ParameterKind kind) { return parameter_kinds[static_cast<int>(kind)]; }

// ", 0, infinity"; empty for a parameter without bounds.
std::string range_of(const Parameter& p) {
  if (p.range.empty()) return "";
  const auto bound = [](double value) {
    return std::isinf(value) ? std::string(value < 0 ? "-unbounded" : "unbounded") : fmt::format("{}", value);
  };
  return fmt::format(", {}, {}", bound(p.above), bound(p.below));
}

// ", true, false": whether the range has its lower end, and whether the number may be infinite.
std::string further(const Parameter& p) {
  const bool unlimited = may_be_unlimited(p);
  if (!p.from && !unlimited) return "";
  return fmt::format("{}, {}, {}", p.range.empty() ? ", -unbounded, unbounded" : "", p.from, unlimited);
}

std::string where(const Joint& joint, const Parameter& p) {
  if (p.kind == ParameterKind::scalar)
    return fmt::format("[{}]{}{}", text(p.unit), p.range.empty() ? "" : " ", p.range);
  const bool direction = p.kind == ParameterKind::unit || p.kind == ParameterKind::frame;
  return fmt::format("{} fixed in {}{}", name_of_kind(p.kind),
                     p.body < 0 ? "the world" : joint.bodies[static_cast<std::size_t>(p.body)],
                     direction ? "" : " [" + text(p.unit) + "]");
}

std::vector<std::string> structure(const Joint& joint) {
  std::vector<std::string> lines = {"template <class T>", "struct Parameters {"};
  for (const Parameter& p : joint.parameters) {
    std::string members;
    for (const std::string& field : fields_of(joint, p)) members += (members.empty() ? "" : ", ") + field;
    lines.push_back(fmt::format("  T {};  // {}", members, where(joint, p)));
  }
  lines.push_back("};");
  return lines;
}

}  // namespace

bool may_be_unlimited(const Parameter& p) {
  const auto infinite = [](Expr leaf) { return leaf->role == Role::constant && leaf->symbol == "unlimited"; };
  const Expr e = p.default_value;
  return e && std::ranges::any_of(leaves_of({&e, 1}), infinite);
}

std::string literal(const std::string& s) {
  std::string out = "\"";
  for (const char c : s) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

std::vector<std::string> parameters_described(const Joint& joint) {
  std::vector<std::string> lines = structure(joint);
  lines.push_back(
      fmt::format("static constexpr std::array<ParameterInfo, {}> parameters = {{{{", joint.parameters.size()));
  int offset = 0;
  for (const Parameter& p : joint.parameters) {
    const int size = static_cast<int>(fields_of(joint, p).size());
    lines.push_back(fmt::format("    {{{}, ParameterKind::{}, {}, {}, {}, {}, {}{}{}}},", literal(p.name),
                                name_of_kind(p.kind), p.body, literal(text(p.unit)), offset, size,
                                p.default_value ? "true" : "false", range_of(p), further(p)));
    offset += size;
  }
  lines.push_back("}};");
  return lines;
}

std::vector<std::string> parameters_alone(const Joint& joint) {
  std::vector<std::string> lines = structure(joint);
  std::string names;
  for (const Parameter& p : joint.parameters) names += "index_of_" + p.name + ", ";
  lines.push_back(fmt::format("enum Index {{ {}index_end }};  // of default_value()", names));
  std::vector<std::string> moves;
  for (const Parameter& p : joint.parameters) {
    if (p.kind != ParameterKind::point || p.body < 0) continue;
    const std::vector<std::string> fields = fields_of(joint, p);
    std::string move = fmt::format("  if (body == {})", p.body);
    for (std::size_t k = 0; k < fields.size(); ++k)
      move += fmt::format("{} p.{} -= r[{}]", k == 0 ? "" : ",", fields[k], k);
    moves.push_back(move + ";");
  }
  lines.insert(lines.end(),
               {"", "// The same points of a body after its origin moved by `r`.", "template <class T>",
                fmt::format("static void move_origin({0}Parameters<T>& p, {0}int body, {0}const T (&r)[{1}]) {{",
                            moves.empty() ? "[[maybe_unused]] " : "", joint.dimension)});
  lines.insert(lines.end(), moves.begin(), moves.end());
  lines.push_back("}");
  return lines;
}

}  // namespace cdot::derive
