// Solids of constant density, by the names that MJCF gives them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/tool/import/model.hpp"

namespace cdot {

struct Solid {
  double volume = 0;                                  // [m^3]
  Eigen::Vector3d inertia = Eigen::Vector3d::Zero();  // about the centre, along the axes, of 1 kg [m^2]
};

// "sphere", "capsule", "cylinder", "box", "ellipsoid" with half sizes: radius; radius and half the length along z; half
// the edges; the half axes. None for other types, or for too few sizes.
std::optional<Solid> solid_of(const std::string& type, const std::vector<double>& size);
// The link gets its shape, if a scene has one like it.
void draw_solid(ModelLink& link, const std::string& type, const std::vector<double>& size);
// The mass of a solid at a place in the link's frame.
void add_mass(ModelLink& link, double mass, const Eigen::Isometry3d& at, const Eigen::Matrix3d& inertia);

}  // namespace cdot
