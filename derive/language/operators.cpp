#include "derive/language/operators.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>

#include "derive/expression/components.hpp"
#include "derive/expression/functions.hpp"
#include "derive/expression/symbols.hpp"
#include "derive/syntax/source.hpp"

namespace cdot::derive {
namespace {

using Arguments = std::span<const Value>;

Value build_dot(Pool&, Arguments a) { return scalar(dot(a[0].e, a[1].e)); }
Value build_cross(Pool& pool, Arguments a) {
  const Expr product = cross(a[0].e, a[1].e);
  return pool.dimension() == 2 ? scalar(product) : vector(product);
}
Value build_turn(Pool&, Arguments a) { return vector(cross(a[0].e, a[1].e)); }
Value build_perp(Pool&, Arguments a) { return vector(perp(a[0].e)); }
Value build_norm(Pool&, Arguments a) { return scalar(norm(a[0].e)); }
Value build_unit(Pool&, Arguments a) { return vector(unit(a[0].e)); }

Value build_local(Pool& pool, Arguments a) {
  if (a[1].type == Type::body && a[1].body < 0) return a[0];
  Value v = vector({});
  v.along = a[1].type == Type::frame ? a[1].axes : body_axes(pool, a[1].body);
  v.e = components_along(a[0].e, v.along);
  return v;
}

Value build_angle_of(Pool& pool, Arguments a) {
  return scalar(a[0].body < 0 ? pool.number(0) : body_angle(pool, a[0].body));
}

Value angle_of(Expr sine, Expr cosine) {
  const std::array<Expr, 2> sides = {sine, cosine};
  return scalar(call(Fn::atan2, sides));
}

Value build_angle_between(Pool& pool, Arguments a) {
  const Expr product = cross(a[0].e, a[1].e);
  return angle_of(pool.dimension() == 2 ? product : norm(product), dot(a[0].e, a[1].e));
}

// Of the parts of u and v across n.
Value build_angle_about(Pool&, Arguments a) {
  const Expr u = a[0].e, v = a[1].e, n = a[2].e;
  return angle_of(dot(n, cross(u, v)), dot(u, v) - dot(n, u) * dot(n, v));
}

Triad triad_of(const Value& frame) { return {frame.axes[0], frame.axes[1], frame.axes[2]}; }

Value build_twist(Pool&, Arguments a) { return scalar(twist(triad_of(a[0]), triad_of(a[1]))); }

Value build_swing(Pool&, Arguments a) {
  const Expr u = a[0].axes[0], v = a[1].axes[0];
  return angle_of(norm(cross(u, v)), dot(u, v));
}

// sin(theta) n of the turn by theta about n that takes f to g: half the sum of f_i x g_i.
Value build_relative_orientation(Pool& pool, Arguments a) {
  Expr sum = zero_vector(pool);
  for (std::size_t k = 0; k < 3; ++k) sum = sum + cross(a[0].axes[k], a[1].axes[k]);
  return vector(Rational(1, 2) * sum);
}

Value build_centre(Pool& pool, Arguments a) {
  Value v = vector(body_position(pool, a[0].body));
  v.type = Type::point;
  v.body = a[0].body;
  v.arm = zero_vector(pool);
  v.anchored = true;
  return v;
}

Value build_arm(Pool&, Arguments a) { return vector(a[0].arm); }

Value build_velocity(Pool& pool, Arguments a) {
  if (a[0].body < 0) return vector(zero_vector(pool));
  const Expr centre = body_velocity(pool, a[0].body);
  if (a[0].type == Type::body || is_zero(a[0].arm)) return vector(centre);
  return vector(centre + cross(body_spin(pool, a[0].body), a[0].arm));
}

Value build_spin(Pool& pool, Arguments a) {
  const bool planar = pool.dimension() == 2;
  if (a[0].body < 0) return planar ? scalar(pool.number(0)) : vector(zero_vector(pool));
  const Expr w = body_spin(pool, a[0].body);
  return planar ? scalar(w) : vector(w);
}

using enum Operator::Where;
using Space = Operator::Space;
using Gives = UnitGiven;
constexpr UnitRule products = {UnitNeed::any, Gives::product}, kept = {UnitNeed::any, Gives::same},
                   to_number = {UnitNeed::any, Gives::number}, to_angle = {UnitNeed::any, Gives::radians};

// clang-format off
const std::vector<Operator> of_vectors = {
    {"dot", "dot(u, v)", {vector_, vector_}, products, build_dot, "u_x v_x + u_y v_y"},
    {"cross", "cross(u, v)", {vector_, vector_}, products, build_cross,
     "u x v, a vector; in the plane the number u_x v_y - u_y v_x"},
    {"cross", "cross(w, v)", {number_, vector_}, products, build_turn, "(-w v_y, w v_x)", anywhere, Space::planar},
    {"perp", "perp(u)", {vector_}, kept, build_perp, "(-u_y, u_x), a quarter turn to the left", anywhere,
     Space::planar},
    {"norm", "norm(u)", {vector_}, kept, build_norm, "the length of a vector"},
    {"unit", "unit(u)", {vector_}, to_number, build_unit, "the direction of a vector; the x axis for the zero vector"},
    {"local", "local(u, f)", {vector_, frame_ | body_ | world_}, kept, build_local,
     "the components of u along the axes of a frame or body; .x and .y take one"},
    {"angle", "angle(a)", {body_ | world_}, to_angle, build_angle_of, "the angle of a body, unwrapped", anywhere,
     Space::planar},
    {"angle", "angle(u, v)", {vector_, vector_}, to_angle, build_angle_between,
     "the angle from u to v, in (-pi, pi]; in space the angle between them, in [0, pi]"},
    {"angle", "angle(u, v, n)", {vector_, vector_, vector_}, to_angle, build_angle_about,
     "the angle from u to v about the unit axis n, in (-pi, pi]", anywhere, Space::spatial},
    {"twist", "twist(f, g)", {frame_, frame_}, to_angle, build_twist,
     "the angle by which g is twisted against f about their x axes, in (-pi, pi]", anywhere, Space::spatial},
    {"swing", "swing(f, g)", {frame_, frame_}, to_angle, build_swing,
     "the angle between the x axes of f and g, in [0, pi]", anywhere, Space::spatial},
    {"rotation", "rotation(f, g)", {frame_, frame_}, to_angle, build_relative_orientation,
     "the turn from f to g by theta about n, as the vector sin(theta) n", anywhere, Space::spatial},
    {"x", "x(a)", {body_}, {UnitNeed::any, Gives::metres}, build_centre, "the centre of mass of a body, a point"},
    {"arm", "arm(p)", {point_}, {UnitNeed::any, Gives::metres}, build_arm, "p minus the centre of mass of its body"},
    {"v", "v(p)", {point_ | body_ | world_}, {UnitNeed::any, Gives::speed}, build_velocity,
     "the velocity of a point or of a body's centre of mass", velocity},
    {"w", "w(a)", {body_ | world_}, {UnitNeed::any, Gives::spin}, build_spin, "the angular velocity of a body",
     velocity},
};
// clang-format on

Operator operator_of(const Function& f) {
  const auto arguments = static_cast<std::size_t>(1 + std::ranges::count(f.signature, ','));
  const auto build = [fn = f.fn](Pool&, Arguments a) {
    std::vector<Expr> args;
    for (const Value& v : a) args.push_back(v.e);
    return scalar(call(fn, args));
  };
  return {f.name, f.signature, std::vector<unsigned>(arguments, number_), f.unit, build, f.help};
}

std::vector<Operator> all_operators() {
  std::vector<Operator> all = of_vectors;
  for (const Function& f : functions) {
    if (!f.signature.empty()) all.push_back(operator_of(f));
  }
  for (Operator& o : operators_of_hand_derivations()) all.push_back(std::move(o));
  return all;
}

}  // namespace

const std::vector<Operator>& operators() {
  static const std::vector<Operator> all = all_operators();
  return all;
}

bool is_operator(std::string_view name) { return !operators_named(name).empty(); }

std::vector<const Operator*> operators_named(std::string_view name) {
  std::vector<const Operator*> found;
  for (const Operator& o : operators())
    if (o.name == name) found.push_back(&o);
  return found;
}

std::string suggested_operator(std::string_view word) {
  // clang-format off
  static const std::map<std::string, std::string> other_words = {
      {"length", "norm(u)"}, {"magnitude", "norm(u)"}, {"len", "norm(u)"}, {"distance", "norm(p - q)"},
      {"dist", "norm(p - q)"}, {"normalize", "unit(u)"}, {"normalise", "unit(u)"}, {"normalized", "unit(u)"},
      {"direction", "unit(u)"}, {"position", "x(a)"}, {"center", "x(a)"}, {"centre", "x(a)"}, {"velocity", "v(a)"},
      {"omega", "w(a)"}, {"orientation", "angle(a)"}, {"theta", "angle(a)"}, {"rotation", "angle(a)"},
      {"perpendicular", "perp(u)"}, {"skew", "perp(u)"}, {"inner", "dot(u, v)"}, {"asin", "atan2(y, x)"},
      {"acos", "atan2(y, x)"}, {"atan", "atan2(y, x)"}, {"pow", "s^2"}, {"power", "s^2"}, {"ln", "log(s)"},
      {"fabs", "abs(s)"}};
  // clang-format on
  std::vector<std::string> candidates;
  for (const Operator& o : operators()) candidates.emplace_back(o.name);
  for (const auto& [other, meaning] : other_words) candidates.push_back(other);
  const std::string near = nearest(word, candidates);
  if (near.empty()) return {};
  const auto other = other_words.find(near);
  return "did you mean `" + (other == other_words.end() ? near : other->second) + "`?";
}

std::string operators_help() {
  std::string out;
  for (const Operator& o : operators()) {
    out += "  " + std::string(o.signature);
    out += std::string(16 - std::min<std::size_t>(14, o.signature.size()), ' ') + std::string(o.help);
    if (o.where == velocity) out += "  (in velocity rows and .hand files)";
    if (o.where == hand) out += "  (in .hand files)";
    if (o.space != Operator::Space::both) {
      out += o.space == Operator::Space::planar ? "  (planar)" : "  (spatial)";
    }
    out += "\n";
  }
  return out;
}

}  // namespace cdot::derive
