// Coordinates at the start of joints -> poses and velocities of the bodies, by projection from the written ones.
#include "runtime/tool/scene/start.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <queue>

#include "runtime/tool/scene/extent.hpp"

namespace cdot {
namespace {

constexpr double turn_per_step = 0.15;  // [rad] on the way from the written value to the start
constexpr double share_per_step = 0.1;  // of the mechanism's size, likewise
constexpr double shortest_step = 1e-5;  // share of the way
constexpr double reached = 1e-10;       // [m], [rad], times the farthest body's distance from the origin
constexpr double dependent = 1e-10;     // share of a coordinate's mobility that counts as none

using Numbers = std::vector<double>;  // [bodies * freedom]

double dot(const Numbers& a, const Numbers& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

void add(Numbers& to, double factor, const Numbers& of) {
  for (std::size_t k = 0; k < to.size(); ++k) to[k] += factor * of[k];
}

// A coordinate on its way from the written value to its start.
struct Aim {
  const SceneJoint* source;
  const CoordinateStart* start;
  std::string_view unit;
  int joint = -1;    // in the World of the starts
  int lock = -1;     // its number among the effects of the joint; -1: only a rate is given
  double from = 0;   // the written value
  double where = 0;  // as far as the joints let it
};

std::string in_unit(double value, std::string_view unit, const char* per = "") {
  if (unit == "rad") return fmt::format("{:.5g} deg{}", value * 180 / std::numbers::pi, per);
  return fmt::format("{:.5g}{}{}{}", value, unit.empty() ? "" : " ", unit, per);
}

// True for each joint that is connected to one with a start. Soft joints and static bodies do not connect.
std::vector<bool> connected(const Scene& scene) {
  std::vector<std::vector<std::size_t>> joints_of(scene.bodies.size());
  const auto movable = [&](int body) {
    return body != world_body && !scene.bodies[static_cast<std::size_t>(body)].is_static;
  };
  std::queue<std::size_t> next;
  std::vector<bool> found(scene.joints.size());
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    if (!scene.joints[j].starts.empty()) found[j] = true, next.push(j);
    if (scene.joints[j].definition.soft) continue;
    for (const int body : scene.joints[j].definition.bodies)
      if (movable(body)) joints_of[static_cast<std::size_t>(body)].push_back(j);
  }
  for (; !next.empty(); next.pop()) {
    for (const int body : scene.joints[next.front()].definition.bodies) {
      if (!movable(body)) continue;
      for (const std::size_t j : joints_of[static_cast<std::size_t>(body)])
        if (!found[j]) found[j] = true, next.push(j);
    }
  }
  return found;
}

const CoordinateStart* start_of(const SceneJoint& joint, const std::string& coordinate) {
  const auto at = std::ranges::find(joint.starts, coordinate, &CoordinateStart::coordinate);
  return at == joint.starts.end() ? nullptr : &*at;
}

// The joints that the starts must satisfy, and the limits of coordinates without a start. `numbers` takes the number
// of each joint of the scene there, -1 for absent ones.
Scene with_joints_alone(const Scene& scene, std::vector<int>& numbers) {
  Scene held;
  held.file = scene.file, held.dimension = scene.dimension, held.source = scene.source, held.bodies = scene.bodies;
  const std::vector<bool> wanted = connected(scene);
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const SceneJoint& joint = scene.joints[j];
    numbers.push_back(wanted[j] ? static_cast<int>(held.joints.size()) : -1);
    if (!wanted[j]) continue;
    held.joints.push_back({joint.name, joint.definition, {}, {}, joint.where, {}});
    for (const CoordinateEffects& effects : joint.effects)
      if (const CoordinateStart* start = start_of(joint, effects.coordinate); effects.limit && !(start && start->value))
        held.joints.back().effects.push_back({.coordinate = effects.coordinate, .limit = effects.limit});
  }
  return held;
}

template <class S>
class Starts {
 public:
  Starts(Scene& scene, Mistakes& mistakes)
      : scene_(scene), mistakes_(mistakes), world_(build_world_in<S>(with_joints_alone(scene, numbers_))) {
    const std::vector<double> extents = extents_of(scene).of_body;
    size_ = extents.empty() ? 1 : *std::ranges::max_element(extents);
  }

  void find() {
    add_aims();
    if (!closes() || !follow()) return;
    const Snapshot at_start = world_.snapshot();
    const bool rates_agree = find_velocities(at_start);
    world_.restore(at_start);
    if (rates_agree) hand_out();
  }

 private:
  void add_aims() {
    for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
      const SceneJoint& source = scene_.joints[j];
      for (const CoordinateStart& start : source.starts) {
        const auto& coordinates = find_joint_type(scene_.dimension, source.definition.type)->coordinates;
        Aim aim{&source, &start, std::ranges::find(coordinates, start.coordinate, &CoordinateInfo::name)->unit};
        aim.joint = numbers_[j];
        aim.from = aim.where = world_.coordinate(aim.joint, start.coordinate);
        if (start.value) aim.lock = add_limit(world_, aim.joint, start.coordinate, Limit{aim.from, aim.from});
        aims_.push_back(aim);
      }
    }
    for (int body = 0; body < std::ssize(scene_.bodies); ++body)
      for (const double x : position_of(scene_.bodies[static_cast<std::size_t>(body)], scene_.dimension))
        far_ = std::max(far_, std::abs(x));
  }

  // --- poses

  // Projects the poses onto C = 0 with every started coordinate at this share of its way.
  bool reach(double share) {
    for (int body = 0; body < std::ssize(scene_.bodies); ++body)
      if (!world_.is_static(body)) world_.set_velocity(body, {});
    for (const Aim& aim : aims_)
      if (aim.lock >= 0) set_limit(world_, aim.joint, aim.lock, Limit{at(aim, share), at(aim, share)});
    // One projection ends as soon as its error stops to shrink below 1e-6.
    double left = 0;
    for (int round = 0; round < 4; ++round) {
      world_.project(reached);
      left = world_.worst_position_error().value;
      for (const Aim& aim : aims_)
        if (aim.lock >= 0)
          left = std::max(left, std::abs(world_.coordinate(aim.joint, aim.start->coordinate) - at(aim, share)));
      if (left <= 1e-5 * slack()) return true;
    }
    return left <= slack();
  }
  double slack() const { return reached * far_; }
  static double at(const Aim& aim, double share) {
    return share == 1 ? *aim.start->value : aim.from + share * (*aim.start->value - aim.from);
  }

  bool closes() {
    if (reach(0)) return true;
    const WorstError worst = world_.worst_position_error();
    mistakes_.add(
        aims_.front().start->where,
        fmt::format("the written poses violate the joints, and the projection leaves {:.3g} m or rad", worst.value),
        "write poses that satisfy C = 0 nearly; the start moves on from there");
    return false;
  }

  // Newton finds the near solution: the way there is short steps.
  bool follow() {
    double steps = 1;
    for (const Aim& aim : aims_)
      if (aim.lock >= 0)
        steps = std::max(steps, std::abs(*aim.start->value - aim.from) /
                                    (aim.unit == "rad" ? turn_per_step : share_per_step * std::max(size_, 1e-9)));
    const double usual = 1 / std::ceil(steps);
    double done = 0, step = usual;
    Snapshot last = world_.snapshot();
    while (done < 1) {
      const double next = done + step > 1 - 0.01 * step ? 1 : done + step;
      if (reach(next)) {
        done = next;
        step = std::min(2 * step, usual);
        world_.snapshot_into(last);
        for (Aim& aim : aims_) aim.where = world_.coordinate(aim.joint, aim.start->coordinate);
        continue;
      }
      world_.restore(last);
      step /= 2;
      if (step < shortest_step) return out_of_reach(done);
    }
    return true;
  }

  bool out_of_reach(double done) {
    const auto locked = std::ranges::count_if(aims_, [](const Aim& aim) { return aim.lock >= 0; });
    for (const Aim& aim : aims_) {
      if (aim.lock < 0 || std::abs(*aim.start->value - aim.where) <= slack()) continue;
      const std::string left = in_unit(std::abs(*aim.start->value - aim.where), aim.unit);
      mistakes_.add(
          aim.start->where,
          fmt::format("`{}` of joint \"{}\" cannot start at {}: from the written {} the joints let it come to {}; {} "
                      "are left",
                      aim.start->coordinate, aim.source->name, in_unit(*aim.start->value, aim.unit),
                      in_unit(aim.from, aim.unit), in_unit(aim.where, aim.unit), left),
          locked > 1  ? "starts that agree with each other: closed loops leave fewer coordinates free"
          : done == 0 ? "a value at which the loop closes, or written poses a little off this dead centre"
                      : "a value at which the loop closes");
    }
    return false;
  }

  // --- velocities

  Numbers velocities() const {
    Numbers v(scene_.bodies.size() * S::freedom);
    for (int body = 0; body < std::ssize(scene_.bodies); ++body) S::write(world_.velocity(body), &v[first(body)]);
    return v;
  }
  void set(const Numbers& v) {
    for (int body = 0; body < std::ssize(scene_.bodies); ++body)
      if (!world_.is_static(body)) world_.set_velocity(body, S::read_velocity(&v[first(body)]));
  }
  static std::size_t first(int body) { return static_cast<std::size_t>(body) * S::freedom; }

  // The velocities with Cdot = 0 that lie nearest to v in the metric of the masses.
  Numbers projected(const Numbers& v, const Snapshot& poses) {
    world_.restore(poses);
    set(v);
    world_.project(reached);
    return velocities();
  }

  // The gradient c of a coordinate: its rate is c v, and more where it depends on time.
  Numbers gradient(const Aim& aim) {
    Numbers c(scene_.bodies.size() * S::freedom), v(c.size());
    for (const int body : world_.joint_bodies(aim.joint)) {
      if (world_.is_static(body)) continue;
      for (std::size_t k = first(body); k < first(body) + S::freedom; ++k) {
        v[k] = 1, set(v);
        c[k] = world_.coordinate_rate(aim.joint, aim.start->coordinate);
        v[k] = -1, set(v);
        c[k] = 0.5 * (c[k] - world_.coordinate_rate(aim.joint, aim.start->coordinate));
        v[k] = 0;
      }
    }
    return c;
  }

  Numbers over_masses(const Numbers& c) {
    Numbers v(c.size());
    for (int body = 0; body < std::ssize(scene_.bodies); ++body)
      S::write(S::weighted(world_.inverse_mass(body), S::read_velocity(&c[first(body)])), &v[first(body)]);
    return v;
  }

  // v = the written velocities, projected, plus sum of (wanted rate - rate) / (c u) u over the coordinates with a rate.
  // u is the part of M^-1 c' that violates no joint and changes no rate given before (Gram-Schmidt).
  bool find_velocities(const Snapshot& poses) {
    struct Direction {
      Numbers c, u;
      double mobility;
    };
    std::vector<Direction> taken;
    Numbers written(scene_.bodies.size() * S::freedom);
    for (int body = 0; body < std::ssize(scene_.bodies); ++body)
      S::write(S::velocity_of(definition(body)), &written[first(body)]);
    const Numbers driven = projected(Numbers(written.size()), poses);
    velocities_ = projected(written, poses);
    bool agree = true;
    for (const Aim& aim : aims_) {
      if (!aim.start->rate) continue;
      const Numbers c = gradient(aim), free = over_masses(c);
      Numbers u = projected(free, poses);
      add(u, -1, driven);
      for (const Direction& other : taken) add(u, -dot(other.c, u) / other.mobility, other.u);
      set(velocities_);
      const double left = *aim.start->rate - world_.coordinate_rate(aim.joint, aim.start->coordinate);
      const double mobility = dot(c, u);
      if (mobility > dependent * dot(c, free)) {
        add(velocities_, left / mobility, u);
        taken.push_back({c, u, mobility});
      } else if (std::abs(left) > 1e-9 * (1 + std::abs(*aim.start->rate))) {
        agree = refuse_rate(aim, left);
      }
    }
    return agree;
  }

  bool refuse_rate(const Aim& aim, double left) {
    mistakes_.add(aim.start->where,
                  fmt::format("the rate of `{}` of joint \"{}\" cannot be {}: the joints, the drives and the rates "
                              "given before fix it {} away from that",
                              aim.start->coordinate, aim.source->name, in_unit(*aim.start->rate, aim.unit, "/s"),
                              in_unit(std::abs(left), aim.unit, "/s")),
                  "leave this rate out; it follows");
    return false;
  }

  // --- the result

  auto& definition(int body) {
    if constexpr (S::dimension == Dimension::planar) return scene_.bodies[static_cast<std::size_t>(body)].definition;
    else return scene_.bodies[static_cast<std::size_t>(body)].spatial;
  }

  // To the bodies that hang together with a started joint.
  void hand_out() {
    set(velocities_);
    std::vector<bool> moved(scene_.bodies.size());
    for (int joint = 0; joint < world_.joint_count(); ++joint)
      for (const int body : world_.joint_bodies(joint))
        if (body < std::ssize(scene_.bodies) && !world_.is_static(body)) moved[static_cast<std::size_t>(body)] = true;
    for (int body = 0; body < std::ssize(scene_.bodies); ++body) {
      if (!moved[static_cast<std::size_t>(body)]) continue;
      SceneBody& to = scene_.bodies[static_cast<std::size_t>(body)];
      const typename S::Place p = world_.place(body);
      const typename S::Velocity v = world_.velocity(body);
      to.started = true;
      if constexpr (S::dimension == Dimension::planar) to.planar_start = {p, v};
      else to.spatial_start = {p, v};
    }
  }

  Scene& scene_;
  Mistakes& mistakes_;
  std::vector<int> numbers_;  // of the scene's joints in world_
  BasicWorld<S> world_;       // of the joints alone
  std::vector<Aim> aims_;
  Numbers velocities_;
  double size_ = 1, far_ = 1;
};

// A start beyond the coordinate's own limit; in space an angle starts within half a turn.
bool within_limits(const Scene& scene, Mistakes& mistakes) {
  bool fine = true;
  const auto refuse = [&](const CoordinateStart& start, const std::string& cause, const char* fix) {
    mistakes.add(start.where, cause, fix);
    fine = false;
  };
  for (const SceneJoint& joint : scene.joints) {
    for (const CoordinateStart& start : joint.starts) {
      const auto effects = std::ranges::find(joint.effects, start.coordinate, &CoordinateEffects::coordinate);
      const bool limited = effects != joint.effects.end() && effects->limit;
      const auto& coordinates = find_joint_type(scene.dimension, joint.definition.type)->coordinates;
      const std::string_view unit = std::ranges::find(coordinates, start.coordinate, &CoordinateInfo::name)->unit;
      if (!start.value) continue;
      for (const double side : {-1.0, 1.0}) {
        const std::optional<double> end = !limited   ? std::nullopt
                                          : side < 0 ? effects->limit->lower
                                                     : effects->limit->upper;
        if (end && side * (*start.value - *end) > 0)
          refuse(start,
                 fmt::format("`{}` of joint \"{}\" starts at {}, beyond its limit {}", start.coordinate, joint.name,
                             in_unit(*start.value, unit), in_unit(*end, unit)),
                 "a start within the limit");
      }
      if (scene.dimension == Dimension::spatial && unit == "rad" && std::abs(*start.value) > std::numbers::pi)
        refuse(start,
               fmt::format("`{}` of joint \"{}\" starts at {}: in space an angle starts within half a turn",
                           start.coordinate, joint.name, in_unit(*start.value, unit)),
               "the same angle within -180 deg to 180 deg");
    }
  }
  return fine;
}

}  // namespace

void find_starts(Scene& scene, Mistakes& mistakes) {
  if (std::ranges::all_of(scene.joints, [](const SceneJoint& joint) { return joint.starts.empty(); })) return;
  if (!within_limits(scene, mistakes)) return;
  in_space_of<double>(scene, [&]<class S>(S) { Starts<S>(scene, mistakes).find(); });
}

void read_starts(Entry& joint, const char* key, const JointType& type, SceneJoint& to) {
  const bool rate = std::string_view(key) == start_rate_key;
  std::optional<Entry> table = joint.table(key, rate ? "start_rate = { angle = 2 }" : "start = { angle = \"30 deg\" }");
  if (!table) return;
  if (type.coordinates.empty())
    return joint.error(joint.where(key), fmt::format("`{}` has no coordinate", type.name),
                       "`cdot-run list` shows the coordinates of all joints");
  for (const CoordinateInfo& coordinate : type.coordinates) {
    const std::string name(coordinate.name);
    const std::optional<double> number = table->number(name, {Sign::any, coordinate.unit == "rad"});
    if (!number) continue;
    auto start = std::ranges::find(to.starts, name, &CoordinateStart::coordinate);
    if (start == to.starts.end()) start = to.starts.insert(start, CoordinateStart{name, {}, {}, table->where(name)});
    (rate ? start->rate : start->value) = number;
  }
  table->close();
}

}  // namespace cdot
