// A Model -> the text of a scene, at the pose where every joint is at 0, or at its limit nearest to it.
#include <algorithm>
#include <fmt/format.h>

#include <cdot/settings.hpp>

#include "runtime/text/json.hpp"
#include "runtime/tool/import/model.hpp"

namespace cdot {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int world = -1;

// Links that fixed joints hold together.
struct Part {
  std::string name;
  double mass = 0;
  Vector3d centre = Vector3d::Zero();   // in the world
  Matrix3d inertia = Matrix3d::Zero();  // about the centre, along the world's axes
  std::string shape;
  Matrix3d axes = Matrix3d::Identity();  // of the body, in the world
  int line = 0;
};

// JSON's strings are TOML's.
std::string quoted(const std::string& name) { return text::Json(name).dump(); }

// A name may hold line ends.
std::string comment(std::string line) {
  std::ranges::replace_if(
      line, [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  return "# " + line + "\n";
}

// Numbers of a pose come from products of sines and cosines, whose round-off would hide zeros.
constexpr double round_off = 1e-14;
std::string number(double value) { return fmt::format("{:.12g}", std::abs(value) < round_off ? 0.0 : value); }
std::string list(const Vector3d& v) { return fmt::format("[{}, {}, {}]", number(v.x()), number(v.y()), number(v.z())); }

// With all digits: a plate's largest moment is the sum of the other two, and may not exceed it.
std::string tensor(const Matrix3d& I) {
  const auto entry = [&](int r, int c) {
    return fmt::format("{}", std::abs(I(r, c)) < round_off * I.trace() ? 0.0 : I(r, c));
  };
  const auto row = [&](int r) { return fmt::format("[{}, {}, {}]", entry(r, 0), entry(r, 1), entry(r, 2)); };
  return fmt::format("[{}, {}, {}]", row(0), row(1), row(2));
}

Matrix3d inertia_of_point(double mass, const Vector3d& r) {
  return mass * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
}

const char* mistake_of(const Matrix3d& I) { return mistake_in({I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)}); }

class Writer {
 public:
  Writer(Model& model, const ImportOptions& options) : model_(model) {
    place_links();
    // An object of its own is not the world; a floor is.
    const bool alone =
        std::ranges::all_of(model_.joints, [](const ModelJoint& joint) { return joint.type == ModelJointType::fixed; });
    const bool heavy = std::ranges::any_of(model_.links, [](const ModelLink& link) { return link.mass > 0; });
    if (alone && !heavy) fail(link(root_).line, "no link moves, and none has a mass: the scene would be empty");
    gather_parts(options.floating || alone);
    for (Part& part : parts_) check(part, options.balance);
  }

  std::string text() const {
    std::string text = comment(fmt::format("Of the robot {} in {}, with every joint at 0 or at its nearest limit.",
                                           quoted(model_.name), model_.file));
    for (const std::string& thing : model_.left_out) text += comment("Left out: " + thing + ".");
    for (const std::string& thing : model_.changed) text += comment("Changed: " + thing + ".");
    text += fmt::format("title     = {}\ndimension = 3\n", quoted(model_.name));
    for (const Part& part : parts_) text += text_of(part);
    for (const ModelJoint& joint : model_.joints)
      if (joint.type != ModelJointType::fixed && joint.type != ModelJointType::free) text += text_of(joint);
    return text;
  }

 private:
  [[noreturn]] void fail(int line, const std::string& what) const {
    throw Error(fmt::format("{}:{}: {}", model_.file, line, what));
  }
  const ModelLink& link(int k) const { return model_.links[static_cast<std::size_t>(k)]; }

  // The joint above each link, and the poses of their frames; links that do not hang from one root are a mistake.
  void place_links() {
    const std::size_t count = model_.links.size();
    above_.assign(count, nullptr);
    for (const ModelJoint& joint : model_.joints) {
      const ModelJoint*& above = above_[static_cast<std::size_t>(joint.child)];
      if (above)
        fail(joint.line, fmt::format("link \"{}\" has two joints above it, \"{}\" and \"{}\"; a URDF is a tree",
                                     link(joint.child).name, above->name, joint.name));
      above = &joint;
    }
    poses_.assign(count, Isometry3d::Identity());
    std::vector<char> placed(count, 0);
    for (std::size_t k = 0; k < count; ++k) {
      std::vector<std::size_t> way;  // from the link up to one that is placed
      for (std::size_t at = k; !placed[at]; at = static_cast<std::size_t>(above_[at]->parent)) {
        if (way.size() > count)
          fail(link(static_cast<int>(k)).line, fmt::format("link \"{}\" hangs from itself", model_.links[k].name));
        way.push_back(at);
        if (!above_[at]) break;
      }
      for (; !way.empty(); way.pop_back()) {
        const std::size_t at = way.back();
        placed[at] = 1;
        if (const ModelJoint* joint = above_[at])
          poses_[at] = poses_[static_cast<std::size_t>(joint->parent)] * joint->origin * start_of(*joint);
        else if (root_ >= 0)
          fail(model_.links[at].line, fmt::format("no joint holds link \"{}\", nor \"{}\": a URDF has one root",
                                                  model_.links[at].name, link(root_).name));
        else root_ = static_cast<int>(at);
        order_.push_back(static_cast<int>(at));
      }
    }
  }

  // A coordinate is measured from the pose in which the scene starts, and its limits with it.
  Isometry3d start_of(const ModelJoint& joint) {
    Isometry3d moved = Isometry3d::Identity();
    const double start = joint.start();
    if (start == 0) return moved;
    if (joint.type == ModelJointType::slider) moved.translation() = start * joint.axis;
    else moved.linear() = Eigen::AngleAxisd(start, joint.axis).toRotationMatrix();
    model_.changed.push_back(fmt::format("joint {} starts at {}, its limit, and its coordinate counts from there",
                                         quoted(joint.name), number(start)));
    return moved;
  }

  void gather_parts(bool floating) {
    part_of_.assign(model_.links.size(), world);
    for (const int k : order_) {  // parents first
      const ModelJoint* above = above_[static_cast<std::size_t>(k)];
      int& part = part_of_[static_cast<std::size_t>(k)];
      const bool begins = above ? above->type != ModelJointType::fixed : floating;
      if (begins) {
        part = static_cast<int>(parts_.size());
        Part& begun = parts_.emplace_back();
        begun.name = link(k).name, begun.line = link(k).line;
        begun.axes = poses_[static_cast<std::size_t>(k)].linear();
      } else if (above) {
        part = part_of_[static_cast<std::size_t>(above->parent)];
      }
      if (part != world) add(link(k), poses_[static_cast<std::size_t>(k)], parts_[static_cast<std::size_t>(part)]);
    }
  }

  void check(Part& part, bool balance) {
    Matrix3d& I = part.inertia;
    if (!(part.mass > 0))
      fail(part.line, fmt::format("link {} moves and has no mass. Likely fix: an <inertial>, or a fixed joint above it",
                                  quoted(part.name)));
    if (I.isZero(0))
      fail(part.line, fmt::format("link {} turns and has no inertia. Likely fix: an <inertia> in its <inertial>",
                                  quoted(part.name)));
    const char* mistake = mistake_of(I);
    if (mistake && !balance)
      fail(part.line,
           fmt::format("link {}: {}. Likely fix: its <inertia>, or --balance-inertias", quoted(part.name), mistake));
    if (!mistake) return;
    const double mean = I.trace() / 3;
    if (!(mean > 0)) fail(part.line, fmt::format("link {}: {}", quoted(part.name), mistake));
    I = mean * Matrix3d::Identity();
    model_.changed.push_back(fmt::format("the inertia of link {}, which no rigid body has: it is {} about all axes",
                                         quoted(part.name), number(mean)));
  }

  // In a scene "world" never moves.
  static std::string name_of_body(const Part& part) { return part.name == "world" ? "world_link" : part.name; }

  void add(const ModelLink& link, const Isometry3d& pose, Part& part) const {
    const Vector3d centre = pose * link.centre;
    const double mass = part.mass + link.mass;
    if (mass > 0) {
      const Vector3d common = (part.mass * part.centre + link.mass * centre) / mass;
      part.inertia += inertia_of_point(part.mass, part.centre - common) + inertia_of_point(link.mass, centre - common) +
                      pose.linear() * link.inertia * pose.linear().transpose();
      part.centre = common, part.mass = mass;
    }
    if (!part.shape.empty() || link.shape.empty()) return;
    part.shape = link.shape;
    part.axes = pose.linear() * link.shape_axes;
  }

  std::string text_of(const Part& part) const {
    const Eigen::Quaterniond q(part.axes);
    const Matrix3d turned = part.axes.transpose() * part.inertia * part.axes, I = (turned + turned.transpose()) / 2;
    std::string text =
        fmt::format("\n[[body]]\nname        = {}\nmass        = {}\n", quoted(name_of_body(part)), part.mass);
    text += fmt::format("inertia     = {}\n", tensor(I));
    if (!part.shape.empty()) text += fmt::format("shape       = {}\n", part.shape);
    text += fmt::format("position    = {}\n", list(part.centre));
    text += fmt::format("orientation = [{}, {}, {}, {}]\n", number(q.w()), number(q.x()), number(q.y()), number(q.z()));
    return text;
  }

  std::string body_of(int link) const {
    const int part = part_of_[static_cast<std::size_t>(link)];
    return part == world ? "world" : name_of_body(parts_[static_cast<std::size_t>(part)]);
  }

  std::string text_of(const ModelJoint& joint) const {
    const Isometry3d& pose = poses_[static_cast<std::size_t>(joint.child)];
    std::string text = fmt::format("\n[[joint]]\nname   = {}\ntype   = \"{}\"\n", quoted(joint.name), type_of(joint));
    text += fmt::format("bodies = [{}, {}]\n", quoted(body_of(joint.parent)), quoted(body_of(joint.child)));
    text += fmt::format("at     = {}\n", list(pose.translation()));
    if (joint.type != ModelJointType::ball)
      text += fmt::format("fa     = {{ world = {} }}\n", list(pose.linear() * joint.axis));
    if (joint.type == ModelJointType::hinge) text += effects_of(joint, "angle");
    if (joint.type == ModelJointType::slider) text += effects_of(joint, "slide");
    return text;
  }

  static const char* type_of(const ModelJoint& joint) {
    switch (joint.type) {
      case ModelJointType::hinge: return "hinge";
      case ModelJointType::slider: return "slider";
      case ModelJointType::plane: return "planar_joint";
      default: return "spherical";
    }
  }

  static std::string effects_of(const ModelJoint& joint, const char* coordinate) {
    std::string text;
    if (joint.range)
      text += fmt::format("{}.limit = {{ lower = {}, upper = {} }}\n", coordinate,
                          number(joint.range->lower - joint.start()), number(joint.range->upper - joint.start()));
    if (joint.friction > 0) text += fmt::format("{}.friction = {}\n", coordinate, joint.friction);
    if (joint.damping > 0)
      text += fmt::format("{}.spring = {{ stiffness = 0, damping = {} }}\n", coordinate, joint.damping);
    return text;
  }

  Model& model_;
  int root_ = -1;
  std::vector<const ModelJoint*> above_;  // by link; none above the root
  std::vector<Isometry3d> poses_;         // of the links' frames, in the world
  std::vector<int> order_;                // links, parents first
  std::vector<int> part_of_;              // by link
  std::vector<Part> parts_;
};

}  // namespace

std::string scene_text(Model& model, const ImportOptions& options) { return Writer(model, options).text(); }

}  // namespace cdot
