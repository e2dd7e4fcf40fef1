#include "runtime/tool/import/solids.hpp"

#include <cmath>
#include <fmt/format.h>

namespace cdot {
namespace {

using Eigen::Vector3d;

const double pi = std::acos(-1.0);

// A box and an ellipsoid of half axes a, b, c: I_xx = share (b^2 + c^2) of 1 kg.
Vector3d about_axes(const Vector3d& half, double share) {
  const Vector3d squares = half.cwiseAbs2();
  return share * Vector3d(squares.y() + squares.z(), squares.z() + squares.x(), squares.x() + squares.y());
}

// A cylinder of half length h, and two half balls of radius r, whose centres of mass lie 3r/8 beyond its ends:
// I_zz = r^2/2 and 2r^2/5, I_xx = r^2/4 + h^2/3 and 2r^2/5 + h^2 + 3rh/4 of 1 kg each.
Solid round(double r, double h, bool capsule) {
  const double of_cylinder = 2 * pi * r * r * h, of_balls = capsule ? 4 * pi / 3 * r * r * r : 0;
  const double volume = of_cylinder + of_balls, c = of_cylinder / volume, b = of_balls / volume;
  const double across = c * (r * r / 4 + h * h / 3) + b * (2 * r * r / 5 + h * h + 3 * r * h / 4);
  return {volume, {across, across, c * r * r / 2 + b * 2 * r * r / 5}};
}

}  // namespace

std::optional<Solid> solid_of(const std::string& type, const std::vector<double>& size) {
  const auto has = [&](std::size_t count) {
    if (size.size() < count) return false;
    return std::all_of(size.begin(), size.begin() + static_cast<std::ptrdiff_t>(count), [](double s) { return s > 0; });
  };
  if (type == "sphere" && has(1)) {
    const double r = size[0];
    return Solid{4 * pi / 3 * r * r * r, Vector3d::Constant(2 * r * r / 5)};
  }
  if ((type == "capsule" || type == "cylinder") && has(2)) return round(size[0], size[1], type == "capsule");
  if ((type != "box" && type != "ellipsoid") || !has(3)) return {};
  const Vector3d half(size[0], size[1], size[2]);
  if (type == "box") return Solid{8 * half.prod(), about_axes(half, 1.0 / 3)};
  return Solid{4 * pi / 3 * half.prod(), about_axes(half, 1.0 / 5)};
}

void draw_solid(ModelLink& link, const std::string& type, const std::vector<double>& size) {
  if (type == "sphere") link.shape = fmt::format("{{ ball = {} }}", size[0]);
  if (type == "capsule" || type == "cylinder")
    draw_cylinder(link, size[0], 2 * size[1] + (type == "capsule" ? 2 * size[0] : 0));
  if (type == "box") link.shape = fmt::format("{{ box = [{}, {}, {}] }}", 2 * size[0], 2 * size[1], 2 * size[2]);
}

void add_mass(ModelLink& link, double mass, const Eigen::Isometry3d& at, const Eigen::Matrix3d& inertia) {
  const double common = link.mass + mass;
  if (!(common > 0)) return;
  const Vector3d centre = (link.mass * link.centre + mass * at.translation()) / common;
  link.inertia += inertia_of_point(link.mass, link.centre - centre) +
                  inertia_of_point(mass, at.translation() - centre) + at.linear() * inertia * at.linear().transpose();
  link.centre = centre, link.mass = common;
}

}  // namespace cdot
