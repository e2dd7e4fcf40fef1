// A URDF file -> a Model (wiki.ros.org/urdf/XML): links, joints, inertias, limits, damping, friction, simple shapes.
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <map>
#include <string_view>

#include <cdot/settings.hpp>

#include "runtime/text/spelling.hpp"
#include "runtime/tool/import/model.hpp"
#include "runtime/tool/import/xml.hpp"

namespace cdot {
namespace {

using Eigen::Vector3d;
using tinyxml2::XMLElement;

class UrdfReader : XmlReader {
 public:
  explicit UrdfReader(const std::string& file) { model_.file = file_ = file; }

  Model read(const std::string& text) {
    const XMLElement* robot = &parse(text);
    check_root(*robot);
    model_.name = attribute(*robot, "name");
    for (const XMLElement* e = robot->FirstChildElement(); e; e = e->NextSiblingElement()) {
      const std::string_view name = e->Name();
      if (name == "link") read_link(*e);
      if (name.starts_with("xacro:"))
        fail(e->GetLineNum(), "this is a macro of xacro. Likely fix: write the URDF by `xacro FILE -o model.urdf`");
    }
    for (const XMLElement* e = robot->FirstChildElement(); e; e = e->NextSiblingElement()) {
      const std::string_view name = e->Name();
      if (name == "joint") read_joint(*e);
      else if (name != "link" && name != "material") ++left_out_[fmt::format("<{}>", name)];
    }
    if (model_.links.empty()) fail(robot->GetLineNum(), "the robot has no <link>");
    add_counted(left_out_, model_.left_out);
    return std::move(model_);
  }

 private:
  void check_root(const XMLElement& root) const {
    const std::string_view name = root.Name();
    if (name == "sdf") fail(root.GetLineNum(), "this is SDF, which is not read. Likely fix: a URDF of the same model");
    if (name != "robot")
      fail(root.GetLineNum(),
           fmt::format("a URDF begins with <robot>, an MJCF file with <mujoco>, not with <{}>", name));
  }

  // <origin>: fixed axes x, y, z by roll, pitch, yaw.
  Eigen::Isometry3d origin_of(const XMLElement& e) const {
    Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
    if (const XMLElement* o = e.FirstChildElement("origin")) {
      const Vector3d rpy = vector(*o, "rpy", Vector3d::Zero());
      origin.translation() = vector(*o, "xyz", Vector3d::Zero());
      origin.linear() = (Eigen::AngleAxisd(rpy.z(), Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vector3d::UnitY()) *
                         Eigen::AngleAxisd(rpy.x(), Vector3d::UnitX()))
                            .toRotationMatrix();
    }
    return origin;
  }

  void read_link(const XMLElement& e) {
    ModelLink link;
    link.name = attribute(e, "name"), link.line = e.GetLineNum();
    if (find_link(link.name) >= 0) fail(link.line, fmt::format("a second link has the name \"{}\"", link.name));
    if (const XMLElement* inertial = e.FirstChildElement("inertial")) read_inertial(*inertial, link);
    bool drawn = false;
    for (const XMLElement* part = e.FirstChildElement(); part; part = part->NextSiblingElement()) {
      const std::string_view name = part->Name();
      if (name == "visual" && !drawn) drawn = read_visual(*part, link);
      else if (name == "visual") ++left_out_["more than one <visual> of a link"];
      else if (name != "inertial") ++left_out_[fmt::format("<{}> of links", name)];
    }
    links_.emplace(link.name, static_cast<int>(model_.links.size()));
    model_.links.push_back(link);
  }

  void read_inertial(const XMLElement& e, ModelLink& link) {
    const XMLElement *mass = e.FirstChildElement("mass"), *inertia = e.FirstChildElement("inertia");
    if (!mass) fail(e.GetLineNum(), fmt::format("<inertial> of link \"{}\" needs a <mass>", link.name));
    link.mass = not_negative(*mass, "value", 0);
    const Eigen::Isometry3d at = origin_of(e);
    link.centre = at.translation();
    if (!inertia) return;
    const auto I = [&](const char* key) { return number(*inertia, key, 0); };
    Eigen::Matrix3d tensor;
    tensor << I("ixx"), I("ixy"), I("ixz"), I("ixy"), I("iyy"), I("iyz"), I("ixz"), I("iyz"), I("izz");
    link.inertia = at.linear() * tensor * at.linear().transpose();
  }

  // Draws the first simple shape. A cylinder stands along z, a rod lies along x.
  bool read_visual(const XMLElement& e, ModelLink& link) {
    const XMLElement* geometry = e.FirstChildElement("geometry");
    const XMLElement* shape = geometry ? geometry->FirstChildElement() : nullptr;
    if (!shape) return false;
    const std::string_view name = shape->Name();
    link.shape_axes = origin_of(e).linear();
    if (name == "box") {
      const Vector3d size = vector(*shape, "size", Vector3d::Zero());
      if (size.minCoeff() > 0) link.shape = fmt::format("{{ box = [{}, {}, {}] }}", size.x(), size.y(), size.z());
    } else if (name == "sphere") {
      const double radius = number(*shape, "radius", 0);
      if (radius > 0) link.shape = fmt::format("{{ ball = {} }}", radius);
    } else if (name == "cylinder") {
      draw_cylinder(link, number(*shape, "radius", 0), number(*shape, "length", 0));
    }
    if (link.shape.empty()) {
      link.shape_axes.setIdentity();
      ++left_out_[fmt::format("the {} of a <visual>", name)];
    }
    return !link.shape.empty();
  }

  int find_link(const std::string& name) const {
    const auto found = links_.find(name);
    return found == links_.end() ? -1 : found->second;
  }
  int link_of(const XMLElement& joint, const char* role) const {
    const XMLElement* e = joint.FirstChildElement(role);
    if (!e) fail(joint.GetLineNum(), fmt::format("joint \"{}\" needs a <{}>", attribute(joint, "name"), role));
    const std::string name = attribute(*e, "link");
    const int link = find_link(name);
    if (link < 0) fail(e->GetLineNum(), fmt::format("there is no link \"{}\"{}", name, meant(name)));
    return link;
  }
  std::string meant(const std::string& name) const {
    std::vector<std::string> names;
    for (const ModelLink& link : model_.links) names.push_back(link.name);
    const std::string near = text::nearest(name, names, 2);
    return near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near);
  }

  ModelJointType type_of(const XMLElement& e) const {
    static const std::map<std::string, ModelJointType> types = {
        {"revolute", ModelJointType::hinge},   {"continuous", ModelJointType::hinge},
        {"prismatic", ModelJointType::slider}, {"fixed", ModelJointType::fixed},
        {"planar", ModelJointType::plane},     {"spherical", ModelJointType::ball},
        {"floating", ModelJointType::free}};
    const std::string name = attribute(e, "type");
    const auto found = types.find(name);
    if (found == types.end())
      fail(e.GetLineNum(),
           fmt::format("a joint has no type \"{}\"; one of revolute, continuous, prismatic, fixed, spherical, planar, "
                       "floating",
                       name));
    return found->second;
  }

  void read_joint(const XMLElement& e) {
    ModelJoint joint;
    joint.name = attribute(e, "name"), joint.line = e.GetLineNum();
    joint.type = type_of(e);
    joint.parent = link_of(e, "parent"), joint.child = link_of(e, "child");
    joint.origin = origin_of(e);
    const bool has_axis = joint.type == ModelJointType::hinge || joint.type == ModelJointType::slider ||
                          joint.type == ModelJointType::plane;
    if (const XMLElement* axis = e.FirstChildElement("axis"); axis && has_axis) {
      joint.axis = direction(*axis, "xyz", Vector3d::UnitX());
    }
    if (const XMLElement* dynamics = e.FirstChildElement("dynamics")) {
      joint.coordinate.damping = not_negative(*dynamics, "damping", 0);
      joint.coordinate.friction = not_negative(*dynamics, "friction", 0);
    }
    read_limit(e, joint);
    for (const XMLElement* part = e.FirstChildElement(); part; part = part->NextSiblingElement()) {
      const std::string_view name = part->Name();
      static constexpr std::array known = {"origin", "parent", "child", "axis", "dynamics", "limit"};
      if (std::ranges::find(known, name) == known.end())
        model_.left_out.push_back(fmt::format("<{}> of joint \"{}\"", name, joint.name));
    }
    model_.joints.push_back(joint);
  }

  // Its ends are 0 if they are not given, by the format; a continuous joint has none.
  void read_limit(const XMLElement& e, ModelJoint& joint) {
    const XMLElement* limit = e.FirstChildElement("limit");
    const bool ends = std::string_view(e.Attribute("type")) != "continuous" &&
                      (joint.type == ModelJointType::hinge || joint.type == ModelJointType::slider);
    if (!limit && ends)
      fail(joint.line,
           fmt::format("joint \"{}\" needs a <limit>. Likely fix: <limit lower=\"-1\" upper=\"1\"/>, or for a "
                       "turn without ends type=\"continuous\"",
                       joint.name));
    if (!limit) return;
    for (const char* key : {"effort", "velocity"})
      if (limit->Attribute(key)) ++left_out_[fmt::format("the largest {} of joints", key)];
    if (!ends) return;
    const ModelCoordinate::Range range = {number(*limit, "lower", 0), number(*limit, "upper", 0)};
    if (range.lower <= range.upper) joint.coordinate.range = range;
    else
      model_.left_out.push_back(
          fmt::format("the limits of joint \"{}\", which run from {} to {}", joint.name, range.lower, range.upper));
  }

  Model model_;
  std::map<std::string, int> links_;     // by name
  std::map<std::string, int> left_out_;  // and how often
};

}  // namespace

Model read_urdf(const std::string& text, const std::string& file) { return UrdfReader(file).read(text); }

}  // namespace cdot
