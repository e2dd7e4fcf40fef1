// The numbers of a pose, for people.
#include <fmt/format.h>

#include "derive/picture/picture.hpp"

namespace cdot::derive {
namespace {

std::string number(double x) { return fmt::format("{:.9g}", x == 0 ? 0.0 : x); }

template <class Numbers>
std::string tuple(const Numbers& numbers, std::size_t size) {
  std::string out;
  for (std::size_t k = 0; k < size; ++k) out += (k == 0 ? "(" : ", ") + number(numbers[k]);
  return out + ")";
}

std::string value_of(const Joint& joint, const Parameter& p, const Sample& pose) {
  const std::size_t dimension = static_cast<std::size_t>(joint.dimension);
  if (p.kind == ParameterKind::scalar) return number(pose.scalars.at(p.symbol->symbol));
  if (p.axes.empty()) return tuple(pose.local.at(p.symbol->symbol), dimension);
  return tuple(pose.triads.at(joint.pool->axis_of(p.axes[0]).triad), 4);
}

}  // namespace

std::vector<std::string> numbers_of(const Joint& joint, const Sample& pose) {
  const bool space = joint.dimension == 3;
  std::vector<std::string> lines;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const Sample::Body& body = pose.bodies[b];
    const std::string& name = joint.bodies[b];
    lines.push_back(fmt::format("x({}) = {}", name, tuple(body.x, space ? 3 : 2)));
    lines.push_back(space ? fmt::format("Euler parameters of {} = {}", name, tuple(body.e, 4))
                          : fmt::format("angle({}) = {}", name, number(body.theta)));
  }
  for (const Parameter& p : joint.parameters) {
    const std::string frame =
        p.kind == ParameterKind::scalar || p.body < 0 ? "" : " in " + joint.bodies[static_cast<std::size_t>(p.body)];
    const std::string what = p.kind == ParameterKind::point && p.body >= 0 ? "arm of " + p.name
                             : !p.axes.empty()                             ? "Euler parameters of " + p.name
                             : p.kind == ParameterKind::frame              ? p.name + ".x"
                                                                           : p.name;
    lines.push_back(what + frame + " = " + value_of(joint, p, pose));
  }
  if (joint.uses_time) lines.push_back("time = " + number(pose.scalars.at("time")));
  return lines;
}

}  // namespace cdot::derive
