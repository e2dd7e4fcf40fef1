#include "runtime/tool/import/mjcf_elements.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace cdot {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

MjcfElements::MjcfElements() : angle_(std::acos(-1.0) / 180) {}

std::vector<std::reference_wrapper<XmlReader::Element>> MjcfElements::children(Element& of, const char* name) {
  std::vector<std::reference_wrapper<Element>> all;
  for (Element* e = of.FirstChildElement(name); e; e = e->NextSiblingElement(name)) all.push_back(*e);
  return all;
}

void MjcfElements::read_compiler(const Element& e) {
  const auto is = [&](const char* key, std::string_view value) {
    return e.Attribute(key) && e.Attribute(key) == value;
  };
  if (is("coordinate", "global"))
    fail(e.GetLineNum(), "global coordinates are not read, and no MuJoCo since 2.3.4 has them");
  if (is("angle", "radian")) angle_ = 1;
  if (is("autolimits", "false")) auto_limits_ = false;
  if (const char* order = e.Attribute("eulerseq")) euler_ = order;
  if (const char* from = e.Attribute("inertiafromgeom")) from_geoms_ = from;
  for (const char* key : {"boundmass", "boundinertia", "settotalmass", "balanceinertia"})
    if (e.Attribute(key)) ++left_out_[fmt::format("`{}` of the compiler", key)];
}

// A class has the defaults of those around it.
void MjcfElements::read_defaults(Element& e, const std::string& around) {
  const char* const name = e.Attribute("class");
  const std::string own = name ? name : around.empty() ? "main" : "";
  if (own.empty()) fail(e.GetLineNum(), "a <default> within another needs the attribute `class`");
  if (around.empty()) main_ = own;
  defaults_[own] = {&e, around};
  for (Element& inner : children(e, "default")) read_defaults(inner, own);
}

// The attributes that the class of an element gives it, and which it does not have itself.
void MjcfElements::inherit(Element& e, const std::string& of_body) const {
  const char* const named = e.Attribute("class");
  std::string name = named ? named : !of_body.empty() ? of_body : main_;
  if (named && !defaults_.contains(name)) fail(e.GetLineNum(), fmt::format("there is no class \"{}\"", name));
  while (defaults_.contains(name)) {
    const auto& [element, around] = defaults_.at(name);
    if (const Element* const given = element->FirstChildElement(e.Name()))
      for (const tinyxml2::XMLAttribute* a = given->FirstAttribute(); a; a = a->Next())
        if (!e.Attribute(a->Name()) && !says_otherwise(e, a->Name())) e.SetAttribute(a->Name(), a->Value());
    name = around;
  }
}
// One of several ways to say the same.
bool MjcfElements::says_otherwise(const Element& e, std::string_view key) {
  if (key == "density") return e.Attribute("mass");
  if (key == "mass") return e.Attribute("density");
  return false;
}

Isometry3d MjcfElements::pose_of(const Element& e) const {
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = vector(e, "pos", Vector3d::Zero());
  pose.linear() = orientation_of(e);
  return pose;
}

Matrix3d MjcfElements::orientation_of(const Element& e) const {
  if (const std::vector<double> q = numbers(e, "quat", 4); !q.empty()) {
    const Eigen::Quaterniond turned(q[0], q[1], q[2], q[3]);
    if (!(turned.norm() > 1e-9)) fail(e.GetLineNum(), fmt::format("`quat` of <{}> has the length 0", e.Name()));
    return turned.normalized().toRotationMatrix();
  }
  if (const std::vector<double> a = numbers(e, "axisangle", 4); !a.empty()) {
    const Vector3d axis(a[0], a[1], a[2]);
    if (!(axis.norm() > 1e-9))
      fail(e.GetLineNum(), fmt::format("`axisangle` of <{}> has an axis of length 0", e.Name()));
    return AngleAxisd(angle_ * a[3], axis.normalized()).toRotationMatrix();
  }
  if (const std::vector<double> v = numbers(e, "xyaxes", 6); !v.empty()) {
    const Vector3d x = Vector3d(v[0], v[1], v[2]).normalized(), along(v[3], v[4], v[5]), y = along - x.dot(along) * x;
    if (!(y.norm() > 1e-9)) fail(e.GetLineNum(), fmt::format("`xyaxes` of <{}> are parallel", e.Name()));
    Matrix3d axes;
    axes << x, y.normalized(), x.cross(y.normalized());
    return axes;
  }
  if (e.Attribute("zaxis")) return turned_up(direction(e, "zaxis", Vector3d::UnitZ()));
  if (e.Attribute("euler")) return by_euler_angles(angle_ * vector(e, "euler", Vector3d::Zero()));
  return Matrix3d::Identity();
}
Matrix3d MjcfElements::turned_up(const Vector3d& z) {
  return Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), z).toRotationMatrix();
}
// Small letters turn about the axes that turn along, capitals about those that stand still.
Matrix3d MjcfElements::by_euler_angles(const Vector3d& angles) const {
  Matrix3d R = Matrix3d::Identity();
  for (std::size_t k = 0; k < 3; ++k) {
    const char letter = k < euler_.size() ? euler_[k] : 'x';
    const Vector3d axis = Vector3d::Unit(std::clamp((letter | 32) - 'x', 0, 2));
    const Matrix3d turn = AngleAxisd(angles[static_cast<Eigen::Index>(k)], axis).toRotationMatrix();
    R = letter >= 'x' ? Matrix3d(R * turn) : Matrix3d(turn * R);
  }
  return R;
}

}  // namespace cdot
