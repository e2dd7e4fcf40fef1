#include "derive/expression/symbols.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace cdot::derive {
namespace {

constexpr std::array<std::string_view, 7> stems = {"x_", "v_", "w_", "theta_", "inv_m_", "inv_I_", "axis_"};

std::string named(std::string_view stem, int body) { return std::string(stem) + body_name(body); }

}  // namespace

std::string body_name(int body) { return body < 0 ? "world" : std::string(1, static_cast<char>('a' + body)); }

int body_of_letter(std::string_view word) {
  const bool letter = word.size() == 1 && word[0] >= 'a' && word[0] < 'a' + most_bodies;
  return letter ? word[0] - 'a' : -1;
}

Expr body_position(Pool& pool, int body) { return pool.vector_symbol(named("x_", body), Role::position, body); }
Expr body_velocity(Pool& pool, int body) { return pool.vector_symbol(named("v_", body), Role::velocity, body); }
Expr body_angle(Pool& pool, int body) { return pool.symbol(named("theta_", body), Role::angle, body); }
Expr body_spin(Pool& pool, int body) {
  if (pool.dimension() == 3) return pool.vector_symbol(named("w_", body), Role::spin, body);
  return pool.symbol(named("w_", body), Role::spin, body);
}
std::vector<Expr> body_axes(Pool& pool, int body) {
  if (body < 0) return world_axes(pool);
  if (pool.dimension() == 3) {
    const Triad axes = pool.triad(named("axis_", body), Role::body_vector, body);
    return {axes.begin(), axes.end()};
  }
  const Expr x = pool.vector_symbol(named("axis_", body), Role::body_vector, body, true);
  return {x, perp(x)};
}
Expr inverse_mass(Pool& pool, int body) { return pool.symbol(named("inv_m_", body), Role::inverse_mass, body); }
Expr inverse_inertia(Pool& pool, int body) { return pool.symbol(named("inv_I_", body), Role::inverse_inertia, body); }
std::vector<Expr> body_euler_parameters(Pool& pool, int body) {
  std::vector<Expr> e;
  for (const char* k : {"0", "1", "2", "3"}) {
    e.push_back(pool.symbol(body_name(body) + ".e" + k, Role::given, body));
  }
  return e;
}
Expr time_symbol(Pool& pool) { return pool.symbol("time", Role::time); }
Expr pi_symbol(Pool& pool) { return pool.symbol("pi", Role::constant); }
Expr unlimited_symbol(Pool& pool) { return pool.symbol("unlimited", Role::constant); }

std::optional<double> constant_value(Expr e) {
  if (e->kind == Kind::number) return e->value.value();
  if (e->kind == Kind::symbol && e->role == Role::constant)
    return e->symbol == "pi" ? std::numbers::pi : std::numeric_limits<double>::infinity();
  if (e->kind != Kind::sum && e->kind != Kind::product) return {};
  double result = e->kind == Kind::sum ? 0 : 1;
  for (std::size_t i = 0; i < e->args.size(); ++i) {
    const std::optional<double> part = constant_value(e->args[i]);
    if (!part) return {};
    if (e->kind == Kind::sum) result += e->coefs[i].value() * *part;
    else result *= std::pow(*part, e->exponents[i]);
  }
  return result;
}

bool is_symbol_of_tool(std::string_view name) {
  if (name == "time" || name == "pi" || name == "unlimited") return true;
  for (const std::string_view stem : stems)
    if (name.starts_with(stem) && body_of_letter(name.substr(stem.size())) >= 0) return true;
  return false;
}

bool is_word_of_cpp(std::string_view name) {
  static constexpr auto words = std::to_array<std::string_view>(
      {"alignas",   "alignof",   "and",      "asm",      "auto",      "bool",      "break",     "case",     "catch",
       "char",      "class",     "concept",  "const",    "consteval", "constexpr", "constinit", "continue", "decltype",
       "default",   "delete",    "do",       "double",   "else",      "enum",      "explicit",  "export",   "extern",
       "false",     "float",     "for",      "friend",   "goto",      "if",        "inline",    "int",      "long",
       "mutable",   "namespace", "new",      "noexcept", "not",       "nullptr",   "operator",  "or",       "private",
       "protected", "public",    "register", "requires", "return",    "short",     "signed",    "sizeof",   "static",
       "struct",    "switch",    "template", "this",     "throw",     "true",      "try",       "typedef",  "typeid",
       "typename",  "union",     "unsigned", "using",    "virtual",   "void",      "volatile",  "while",    "xor"});
  return std::find(words.begin(), words.end(), name) != words.end();
}

bool is_member_of_kernels(std::string_view name) {
  static constexpr auto members = std::to_array<std::string_view>({"Bounded",
                                                                   "Coordinates",
                                                                   "Immovable",
                                                                   "Jacobian",
                                                                   "Parameters",
                                                                   "acts",
                                                                   "apply",
                                                                   "bodies",
                                                                   "body_names",
                                                                   "dense",
                                                                   "energy",
                                                                   "default_value",
                                                                   "force",
                                                                   "factor",
                                                                   "effective_mass",
                                                                   "explicit_time",
                                                                   "gamma",
                                                                   "jacobian",
                                                                   "inverse_mass_jacobian",
                                                                   "name",
                                                                   "immovable_body",
                                                                   "parameters",
                                                                   "position",
                                                                   "row_kinds",
                                                                   "row_names",
                                                                   "rows",
                                                                   "slopes",
                                                                   "solve",
                                                                   "stiffness",
                                                                   "title",
                                                                   "time_derivative",
                                                                   "unit",
                                                                   "unstored",
                                                                   "velocity"});
  return std::find(members.begin(), members.end(), name) != members.end();
}

std::string arm_name(std::string_view prefix, std::string_view point) {
  const bool short_form = point.size() > 1 && point[0] == 'p';
  return std::string(prefix) + (short_form ? "r" + std::string(point.substr(1)) : "r_" + std::string(point));
}

}  // namespace cdot::derive
