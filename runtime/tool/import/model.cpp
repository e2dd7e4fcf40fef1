#include "runtime/tool/import/model.hpp"

#include <cmath>
#include <fmt/format.h>
#include <tinyxml2.h>

namespace cdot {

void draw_cylinder(ModelLink& link, double radius, double length) {
  if (!(radius > 0 && length > 0)) return;
  const bool is_rod = length > 2 * radius;
  if (is_rod) link.shape_axes = link.shape_axes * Eigen::AngleAxisd(-std::acos(0.0), Eigen::Vector3d::UnitY());
  link.shape = is_rod ? fmt::format("{{ rod = {}, width = {} }}", length, 2 * radius)
                      : fmt::format("{{ disc = {}, width = {} }}", radius, length);
}

void add_counted(const std::map<std::string, int>& counted, std::vector<std::string>& to) {
  for (const auto& [thing, count] : counted)
    to.push_back(count == 1 ? thing : fmt::format("{} ({} times)", thing, count));
}

// By the name of the first element; what is no XML is told as a mistake of a URDF file.
Model read_model(const std::string& text, const std::string& file) {
  tinyxml2::XMLDocument document;
  document.Parse(text.c_str(), text.size());
  const tinyxml2::XMLElement* const root = document.RootElement();
  return root && std::string(root->Name()) == "mujoco" ? read_mjcf(text, file) : read_urdf(text, file);
}

}  // namespace cdot
