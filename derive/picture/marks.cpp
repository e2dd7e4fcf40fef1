#include "derive/picture/marks.hpp"

#include <algorithm>
#include <cmath>

#include "derive/expression/symbols.hpp"

namespace cdot::derive {
namespace {

constexpr double negligible_length = 1e-4;  // [m] of lengths of about a metre: Newton's method stops near double zeros

double length_of(const Triple<double>& u) { return std::hypot(u[0], u[1], u[2]); }
Triple<double> minus(const Triple<double>& u, const Triple<double>& v) {
  return {u[0] - v[0], u[1] - v[1], u[2] - v[2]};
}
bool coincide(const Triple<double>& u, const Triple<double>& v) { return length_of(minus(u, v)) < negligible_length; }

class MarksAt {
 public:
  MarksAt(const Joint& joint, const Sample& pose) : joint_(joint), pose_(pose), numbers_(pose) {}

  Marks all() {
    for (std::size_t b = 0; b < joint_.bodies.size(); ++b) add_body(b);
    for (const Parameter& p : joint_.parameters)
      if (p.kind == ParameterKind::point) add_point(p.name, p.body, numbers_.vector(p.value));
    for (const Parameter& p : joint_.parameters) add_arrows(p);
    for (const Let& let : joint_.lets)
      if (let.value->vector) add_let(let);
    return std::move(marks_);
  }

 private:
  void add_body(std::size_t b) {
    const Sample::Body& body = pose_.bodies[b];
    const EulerParameters<double> about_z{std::cos(body.theta / 2), 0, 0, std::sin(body.theta / 2)};
    const auto axes = axes_of(joint_.dimension == 2 ? about_z : body.e);
    marks_.bodies.push_back({joint_.bodies[b], body.x, {axes.begin(), axes.begin() + joint_.dimension}, {body.x}});
  }

  void add_point(const std::string& name, int body, const Triple<double>& at) {
    if (body >= 0) marks_.bodies[static_cast<std::size_t>(body)].corners.push_back(at);
    const auto same = std::ranges::find_if(marks_.points, [&](const PointMark& p) { return coincide(p.at, at); });
    if (same == marks_.points.end()) marks_.points.push_back({name, body, at});
    else same->name += ", " + name;
    places_.push_back({body, at});
  }

  // Of what is fixed in a body, but nowhere in particular: its first point.
  Triple<double> origin_of(int body) const {
    const auto first = std::ranges::find(places_, body, &Place::body);
    if (first != places_.end()) return first->at;
    if (body >= 0) return marks_.bodies[static_cast<std::size_t>(body)].centre;
    return places_.empty() ? marks_.bodies[0].centre : places_[0].at;
  }

  void add_arrows(const Parameter& p) {
    if (p.kind == ParameterKind::point || p.kind == ParameterKind::scalar) return;
    const Triple<double> from = origin_of(p.body);
    if (p.kind != ParameterKind::frame) return add_arrow(p.name, p.body, from, numbers_.vector(p.value), p.unit);
    const std::vector<Expr> axes = joint_.dimension == 3 ? p.axes : std::vector<Expr>{p.symbol, perp(p.symbol)};
    for (std::size_t k = 0; k < axes.size(); ++k)
      add_arrow(p.name + "." + "xyz"[k], p.body, from, numbers_.vector(axes[k]), p.unit);
  }

  void add_arrow(const std::string& name, int body, const Triple<double>& from, Triple<double> along, Unit unit) {
    const bool direction = unit != Unit{.m = 1};
    const double length = length_of(along);
    if (direction && length > negligible_length)
      for (double& component : along) component /= length;
    const auto same = std::ranges::find_if(marks_.arrows, [&](const ArrowMark& a) {
      return a.direction == direction && coincide(a.from, from) && coincide(a.along, along) && !a.is_zero();
    });
    if (same != marks_.arrows.end()) same->name += ", " + name;
    else marks_.arrows.push_back({name, body, from, along, direction});
  }

  // pa - pb leads from pb to pa; any other vector begins at a body that it depends on.
  void add_let(const Let& let) {
    const Triple<double> value = numbers_.vector(let.value);
    for (const auto& [to, at] : ends())
      for (const auto& [from, start] : ends())
        if (to != from && to - from == let.value) return add_arrow(let.name, of_no_body, start, value, let.unit);
    if (is_point(let.value, value)) return add_point(let.name, of_no_body, value);
    int body = -1;
    for (const Expr leaf : leaves_of(std::span(&let.value, 1))) body = body < 0 ? leaf->body : body;
    add_arrow(let.name, of_no_body, origin_of(body), value, let.unit);
  }

  // A point moves with all bodies and the points of the world, a vector does not.
  bool is_point(Expr e, const Triple<double>& value) const {
    Sample moved = pose_;
    for (Sample::Body& body : moved.bodies) body.x[0] += 1;
    for (const Parameter& p : joint_.parameters)
      if (p.kind == ParameterKind::point && p.body < 0) moved.local.at(p.symbol->symbol)[0] += 1;
    return coincide(Numbers(moved).vector(e), {value[0] + 1, value[1], value[2]});
  }

  struct End {
    Expr e;
    Triple<double> at;
  };
  const std::vector<End>& ends() {
    if (!ends_.empty()) return ends_;
    for (const Parameter& p : joint_.parameters)
      if (p.kind == ParameterKind::point) ends_.push_back({p.value, numbers_.vector(p.value)});
    for (std::size_t b = 0; b < joint_.bodies.size(); ++b)
      ends_.push_back({body_position(*joint_.pool, static_cast<int>(b)), pose_.bodies[b].x});
    return ends_;
  }

  struct Place {
    int body;
    Triple<double> at;
  };
  const Joint& joint_;
  const Sample& pose_;
  Numbers numbers_;
  Marks marks_;
  std::vector<Place> places_;
  std::vector<End> ends_;
};

}  // namespace

bool ArrowMark::is_zero() const { return length_of(along) < negligible_length; }

Marks marks_of(const Joint& joint, const Sample& pose) { return MarksAt(joint, pose).all(); }

}  // namespace cdot::derive
