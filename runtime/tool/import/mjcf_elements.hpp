// Elements of an MJCF file with the settings that hold for all of them: units, orders of angles, defaults by class.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "runtime/tool/import/xml.hpp"

namespace cdot {

class MjcfElements : protected XmlReader {
 protected:
  static std::vector<std::reference_wrapper<Element>> children(Element& of, const char* name = nullptr);

  void read_compiler(const Element& e);
  void read_defaults(Element& e, const std::string& around = "");
  // Gives an element the attributes of its class, or that of its body, which it does not have itself.
  void inherit(Element& e, const std::string& of_body) const;
  Eigen::Isometry3d pose_of(const Element& e) const;
  // With its third axis along z.
  static Eigen::Matrix3d turned_up(const Eigen::Vector3d& z);

  double angle_;                         // [rad] of a unit of the file
  bool auto_limits_ = true;              // a range alone is a limit
  std::string from_geoms_ = "auto";      // masses: "true", "false", or where there is no <inertial>
  std::map<std::string, int> left_out_;  // and how often

  MjcfElements();

 private:
  static bool says_otherwise(const Element& e, std::string_view key);
  Eigen::Matrix3d orientation_of(const Element& e) const;
  Eigen::Matrix3d by_euler_angles(const Eigen::Vector3d& angles) const;

  std::string euler_ = "xyz", main_;
  std::map<std::string, std::pair<Element*, std::string>> defaults_;  // by class: where, and the class around it
};

}  // namespace cdot
