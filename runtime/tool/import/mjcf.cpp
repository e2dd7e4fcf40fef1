// An MJCF file -> a Model (mujoco.readthedocs.io, XML reference): bodies, joints, masses by geoms or inertials,
// defaults, loops by equality constraints, and the actuators that hold a position or a velocity.
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <set>
#include <string_view>

#include <cdot/settings.hpp>

#include "runtime/text/spelling.hpp"
#include "runtime/tool/import/joined.hpp"
#include "runtime/tool/import/mjcf_elements.hpp"
#include "runtime/tool/import/model.hpp"
#include "runtime/tool/import/solids.hpp"

namespace cdot {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double usual_density = 1000;  // [kg/m^3]
constexpr double light = 1e-6;          // mass between two joints of one body, as a share of that body's

class MjcfReader : MjcfElements {
 public:
  explicit MjcfReader(const std::string& file) {
    model_.file = file_ = file;
    model_.word = "body", model_.grounded = true;
  }

  Model read(const std::string& text) {
    Element& root = parse(text);
    include_files(root, std::filesystem::path(file_).parent_path());
    const char* const name = root.Attribute("model");
    model_.name = name ? name : "MuJoCo model";
    for (Element& e : children(root)) {
      if (e.Name() == std::string_view("compiler")) read_compiler(e);
      if (e.Name() == std::string_view("default")) read_defaults(e);
    }
    model_.gravity = Vector3d(0, 0, -9.81);
    model_.links.push_back({"world", root.GetLineNum(), 0, {}, {}, "", {}});
    for (Element& e : children(root, "option")) read_option(e);
    for (Element& e : children(root, "worldbody")) read_world(e);
    for (Element& e : children(root, "equality"))
      for (Element& loop : children(e)) read_equality(loop);
    for (Element& e : children(root, "actuator"))
      for (Element& actuator : children(e)) read_actuator(actuator);
    for (const Element& e : children(root)) tell_section(e.Name());
    if (model_.links.size() == 1) fail(root.GetLineNum(), "the model has no <body> in its <worldbody>");
    add_counted(left_out_, model_.left_out);
    if (rows_of_joints_ > 0)
      model_.changed.push_back(
          fmt::format("{} several joints: bodies of {} of {} mass stand between these",
                      rows_of_joints_ == 1 ? "a body has" : fmt::format("{} bodies have", rows_of_joints_), light,
                      rows_of_joints_ == 1 ? "its" : "their"));
    return std::move(model_);
  }

 private:
  void tell_section(std::string_view name) {
    static const std::set<std::string_view> read = {"compiler", "option",    "default", "worldbody", "equality",
                                                    "actuator", "statistic", "visual",  "size",      "asset"};
    if (!read.contains(name)) ++left_out_[fmt::format("<{}>", name)];
  }

  // --- bodies ----------------------------------------------------------------------------------

  void read_option(Element& e) {
    model_.gravity = vector(e, "gravity", *model_.gravity);
    for (Element& flag : children(e, "flag"))
      if (flag.Attribute("gravity") && flag.Attribute("gravity") == std::string_view("disable"))
        model_.gravity = Vector3d::Zero();
    for (const char* key : {"density", "viscosity", "wind"})
      if (e.Attribute(key)) ++left_out_[fmt::format("the {} of the air", key)];
  }

  void read_world(Element& e) {
    for (Element& part : children(e)) {
      const std::string_view name = part.Name();
      if (name == "body") read_body(part, 0, "");
      else if (name == "geom") ++left_out_["contacts with the geoms of the world"];
      else tell_part(name);
    }
  }
  void tell_part(std::string_view name) {
    if (name != "light" && name != "camera") ++left_out_[fmt::format("<{}>", name)];
  }

  void read_body(Element& e, int parent, std::string child_class) {
    ModelLink link;
    const char* const name = e.Attribute("name");
    link.name = name ? name : fmt::format("body{}", model_.links.size()), link.line = e.GetLineNum();
    if (link_of(link.name) >= 0) fail(link.line, fmt::format("a second body has the name \"{}\"", link.name));
    if (const char* own = e.Attribute("childclass")) child_class = own;
    read_mass(e, child_class, link);
    const int number = static_cast<int>(model_.links.size());
    model_.links.push_back(link);
    read_joints(e, child_class, parent, number);
    for (Element& part : children(e)) {
      const std::string_view kind = part.Name();
      static constexpr std::array known = {"inertial", "joint", "freejoint", "geom", "body"};
      if (kind == "body") read_body(part, number, child_class);
      else if (std::ranges::find(known, kind) == known.end()) tell_part(kind);
    }
  }

  // By its geoms, or by its <inertial>, which stands for them.
  void read_mass(Element& e, const std::string& child_class, ModelLink& link) {
    Element* const inertial = e.FirstChildElement("inertial");
    const bool by_geoms = from_geoms_ == "true" || (!inertial && from_geoms_ != "false");
    for (Element& geom : children(e, "geom")) {
      inherit(geom, child_class);
      read_geom(geom, by_geoms, link);
      ++left_out_["contacts of geoms"];
    }
    if (inertial && !by_geoms) read_inertial(*inertial, link);
  }

  void read_inertial(const Element& e, ModelLink& link) const {
    attribute(e, "mass"), attribute(e, "pos");
    Matrix3d I = Matrix3d::Zero();
    if (const std::vector<double> full = numbers(e, "fullinertia", 6); !full.empty())
      I << full[0], full[3], full[4], full[3], full[1], full[5], full[4], full[5], full[2];
    else I = vector(e, "diaginertia", Vector3d::Zero()).asDiagonal();
    add_mass(link, not_negative(e, "mass", 0), pose_of(e), I);
  }

  void read_geom(const Element& e, bool weighs, ModelLink& link) {
    const std::string type = e.Attribute("type") ? e.Attribute("type") : e.Attribute("mesh") ? "mesh" : "sphere";
    std::vector<double> size = list(e, "size");
    Isometry3d at = pose_of(e);
    if (const std::vector<double> ends = numbers(e, "fromto", 6); !ends.empty()) {
      const Vector3d a(ends[0], ends[1], ends[2]), b(ends[3], ends[4], ends[5]);
      if (!((b - a).norm() > 1e-9)) fail(e.GetLineNum(), "`fromto` of <geom> has the length 0");
      at.translation() = (a + b) / 2, at.linear() = turned_up((a - b).normalized());
      const double half = (b - a).norm() / 2;
      size.resize(1);
      if (type == "box" || type == "ellipsoid") size.push_back(size[0]);
      size.push_back(half);
    }
    const std::optional<Solid> solid = solid_of(type, size);
    if (!solid) {
      const bool plain =
          type == "sphere" || type == "capsule" || type == "cylinder" || type == "box" || type == "ellipsoid";
      if (plain) fail(e.GetLineNum(), fmt::format("a {} needs a positive `size` in each of its directions", type));
      ++left_out_[fmt::format("the {} of a geom{}", type, weighs ? ", and its mass" : "")];
      return;
    }
    if (weighs) {
      const double mass =
          e.Attribute("mass") ? not_negative(e, "mass", 0) : solid->volume * not_negative(e, "density", usual_density);
      add_mass(link, mass, at, mass * Matrix3d(solid->inertia.asDiagonal()));
    }
    if (!link.shape.empty()) return;
    link.shape_axes = at.linear();
    draw_solid(link, type, size);
    if (link.shape.empty()) link.shape_axes.setIdentity();
  }

  int link_of(const std::string& name) const {
    const auto found = std::ranges::find(model_.links, name, &ModelLink::name);
    return found == model_.links.end() ? -1 : static_cast<int>(found - model_.links.begin());
  }

  // --- joints ----------------------------------------------------------------------------------

  MjcfAxis read_axis(Element& e, const std::string& child_class, const std::string& body) {
    inherit(e, child_class);
    const bool turns = !e.Attribute("type") || e.Attribute("type") == std::string_view("hinge");
    MjcfAxis a{e.Attribute("name") ? e.Attribute("name") : "joint_of_" + body,
               e.Attribute("type") ? e.Attribute("type") : "hinge",
               vector(e, "pos", Vector3d::Zero()),
               direction(e, "axis", Vector3d::UnitZ()),
               {}};
    static constexpr std::array types = {"hinge", "slide", "ball", "free"};
    if (std::ranges::find(types, a.type) == types.end())
      fail(e.GetLineNum(), fmt::format("a joint has no type \"{}\"; one of hinge, slide, ball, free", a.type));
    if (a.type == "ball" || a.type == "free") {
      for (const char* key : {"range", "stiffness", "damping"})
        if (e.Attribute(key) && last_number(e, key) != 0) ++left_out_[fmt::format("the {} of {} joints", key, a.type)];
      return a;
    }
    const double unit = turns ? angle_ : 1, zero = unit * number(e, "ref", 0);
    ModelCoordinate& c = a.coordinate;
    c.damping = not_negative(e, "damping", 0), c.friction = not_negative(e, "frictionloss", 0);
    c.stiffness = not_negative(e, "stiffness", 0), c.rest = unit * number(e, "springref", 0) - zero;
    if (number(e, "armature", 0) != 0) ++left_out_["the armature of joints"];
    const std::string limited = e.Attribute("limited") ? e.Attribute("limited") : "auto";
    const std::vector<double> range = numbers(e, "range", 2);
    if (!range.empty() && (limited == "true" || (limited == "auto" && auto_limits_))) {
      if (!(range[0] <= range[1]))
        fail(e.GetLineNum(), fmt::format("`range` of <joint> runs from {} to {}", range[0], range[1]));
      c.range = {unit * range[0] - zero, unit * range[1] - zero};
    }
    zeros_[a.name] = zero;
    return a;
  }
  double last_number(const Element& e, const char* key) const { return list(e, key).back(); }

  void read_joints(Element& e, const std::string& child_class, int parent, int child) {
    std::vector<MjcfAxis> axes;
    const std::string& body = model_.links[static_cast<std::size_t>(child)].name;
    for (Element& part : children(e))
      if (part.Name() == std::string_view("joint")) axes.push_back(read_axis(part, child_class, body));
      else if (part.Name() == std::string_view("freejoint"))
        axes.push_back({"free_joint_of_" + body, "free", {}, {}, {}});
    const std::optional<ModelJoint> one = joined(axes);
    if (one) add_joint(*one, axes, e, parent, child);
    else add_row_of_joints(axes, e, parent, child);
  }

  void add_joint(ModelJoint joint, const std::vector<MjcfAxis>& axes, const Element& body, int parent, int child) {
    joint.line = body.GetLineNum(), joint.parent = parent, joint.child = child, joint.origin = pose_of(body);
    if (axes.empty()) joint.name = fmt::format("joint_of_{}", model_.links[static_cast<std::size_t>(child)].name);
    place_coordinates(joint, axes);
    model_.joints.push_back(joint);
  }
  // Where actuators find them.
  void place_coordinates(const ModelJoint& joint, const std::vector<MjcfAxis>& axes) {
    const std::size_t number = model_.joints.size();
    if (joint.type == ModelJointType::hinge || joint.type == ModelJointType::slider ||
        joint.type == ModelJointType::universal)
      coordinates_[axes[0].name] = {number, &ModelJoint::coordinate};
    if (joint.type == ModelJointType::universal) coordinates_[axes[1].name] = {number, &ModelJoint::about_second};
  }

  // Each joint with a body of its own, as MuJoCo's documentation explains joints of one body: in their order, each
  // turns the axes of those behind it.
  void add_row_of_joints(const std::vector<MjcfAxis>& axes, const Element& e, int parent, int child) {
    const ModelLink body = model_.links[static_cast<std::size_t>(child)];
    if (std::ranges::any_of(axes, [](const MjcfAxis& a) { return a.type == "free"; }))
      fail(body.line,
           fmt::format("body \"{}\" is free and has other joints too. Likely fix: leave these out", body.name));
    for (std::size_t k = 0; k < axes.size(); ++k) {
      ModelJoint joint = *joined({axes[k]});
      const bool last = k + 1 == axes.size();
      const int next = last ? child : static_cast<int>(model_.links.size());
      if (!last) model_.links.push_back(light_link(body, fmt::format("{}_{}", body.name, k + 1), axes[k].point));
      add_joint(joint, {axes[k]}, e, parent, next);
      if (k > 0) model_.joints.back().origin.setIdentity();
      parent = next;
    }
    ++rows_of_joints_;
  }
  static ModelLink light_link(const ModelLink& body, const std::string& name, const Vector3d& at) {
    ModelLink link;
    link.name = name, link.line = body.line, link.centre = at;
    const double mass = body.mass > 0 ? body.mass : 1;  // [kg]: then it is that of bodies fixed to it
    link.mass = light * mass;
    link.inertia = light * std::max(body.inertia.trace() / 3, 1e-4 * mass) * Matrix3d::Identity();
    return link;
  }

  // --- loops and actuators ---------------------------------------------------------------------

  void read_equality(Element& e) {
    inherit(e, "");
    const std::string kind = e.Name();
    const bool off = e.Attribute("active") && e.Attribute("active") == std::string_view("false");
    if (!off && kind == "joint" && read_coupling(e)) return;
    if (off || (kind != "connect" && kind != "weld") || !e.Attribute("body1")) {
      ++left_out_[fmt::format("<{}> of <equality>{}", kind, off ? ", which is not active" : "")];
      return;
    }
    ModelLoop loop;
    loop.line = e.GetLineNum(), loop.fixed = kind == "weld";
    loop.a = known_body(e, "body1"), loop.b = e.Attribute("body2") ? known_body(e, "body2") : 0;
    loop.name = e.Attribute("name") ? e.Attribute("name") : fmt::format("{}_{}", kind, model_.loops.size() + 1);
    loop.point = vector(e, "anchor", Vector3d::Zero());
    model_.loops.push_back(loop);
  }
  // Of coordinates that stand alone in their joint.
  bool read_coupling(const Element& e) {
    ModelCoupling coupling;
    coupling.first = coupled(e, "joint1");
    coupling.second = coupled(e, "joint2");
    if (coupling.first < 0 || (e.Attribute("joint2") && coupling.second < 0)) return false;
    coupling.name = e.Attribute("name") ? e.Attribute("name") : fmt::format("coupling_{}", model_.couplings.size() + 1);
    coupling.coefficients = list(e, "polycoef");
    if (coupling.coefficients.empty()) coupling.coefficients = {0, 1};
    model_.couplings.push_back(coupling);
    return true;
  }
  int coupled(const Element& e, const char* key) const {
    const auto found = coordinates_.find(e.Attribute(key) ? e.Attribute(key) : "");
    if (found == coordinates_.end()) return -1;
    const std::size_t joint = found->second.first;
    return model_.joints[joint].type == ModelJointType::universal ? -1 : static_cast<int>(joint);
  }
  int known_body(const Element& e, const char* key) const {
    const std::string name = attribute(e, key);
    const int link = link_of(name);
    std::vector<std::string> names;
    for (const ModelLink& one : model_.links) names.push_back(one.name);
    const std::string near = text::nearest(name, names, 2);
    if (link < 0)
      fail(e.GetLineNum(), fmt::format("there is no body \"{}\"{}", name,
                                       near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near)));
    return link;
  }

  // At the control 0, which a program may change: a position is held at 0, a velocity is braked, a motor is off.
  void read_actuator(Element& e) {
    inherit(e, "");
    const std::string kind = e.Name(), name = e.Attribute("joint") ? e.Attribute("joint") : "";
    ModelCoordinate* const c = coordinate_of(name);
    const bool holds = kind == "position" || kind == "velocity";
    if (!c || !holds) {
      ++left_out_[fmt::format("<{}> actuators{}", kind,
                              kind == "motor" ? ", which are off until a program controls them" : "")];
      return;
    }
    const std::vector<double> gears = list(e, "gear");
    const double gear = gears.empty() ? 1 : gears[0];
    if (kind == "velocity") {
      c->damping += gear * gear * not_negative(e, "kv", 1);
      return;
    }
    const double k = gear * gear * not_negative(e, "kp", 1), target = -zeros_[name];
    c->damping += gear * gear * not_negative(e, "kv", 0);
    const std::vector<double> most = numbers(e, "forcerange", 2);
    if (!most.empty() && most[1] > 0) {
      c->servo = k, c->target = target, c->most = std::abs(gear) * most[1];
    } else if (c->stiffness + k > 0) {  // two springs as one
      c->rest = (c->stiffness * c->rest + k * target) / (c->stiffness + k);
      c->stiffness += k;
    }
  }
  ModelCoordinate* coordinate_of(const std::string& name) {
    const auto found = coordinates_.find(name);
    if (found == coordinates_.end()) return nullptr;
    const auto& [joint, member] = found->second;
    return &(model_.joints[joint].*member);
  }

  Model model_;
  int rows_of_joints_ = 0;               // bodies with joints that make no single one
  std::map<std::string, double> zeros_;  // by joint: its coordinate where the scene's is 0
  std::map<std::string, std::pair<std::size_t, ModelCoordinate ModelJoint::*>> coordinates_;  // by joint of the file
};

}  // namespace

Model read_mjcf(const std::string& text, const std::string& file) { return MjcfReader(file).read(text); }

}  // namespace cdot
