// A Model -> the text of a scene, at the pose where every joint is at 0, or at its limit nearest to it.
#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <set>

#include <cdot/settings.hpp>

#include "runtime/text/json.hpp"
#include "runtime/tool/import/coupling.hpp"
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
std::string in_quotes(const std::string& name) { return text::Json(name).dump(); }

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

const char* mistake_of(const Matrix3d& I) { return mistake_in({I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)}); }

class Writer {
 public:
  Writer(Model& model, const ImportOptions& options) : model_(model), stem_(options.stem) {
    give_valid_names(model_.links);
    give_valid_names(model_.joints);
    give_valid_names(model_.loops);
    give_valid_names(model_.couplings);
    place_links();
    // An object of its own is not the world; a floor is.
    const bool still =
        std::ranges::all_of(model_.joints, [](const ModelJoint& joint) { return joint.type == ModelJointType::fixed; });
    const bool alone = still && !model_.grounded;
    const bool heavy = std::ranges::any_of(model_.links, [](const ModelLink& link) { return link.mass > 0; });
    if (still && model_.grounded) fail(link(root_).line, "no body moves: the scene would be empty");
    if (alone && !heavy) fail(link(root_).line, "no link moves, and none has a mass: the scene would be empty");
    gather_parts(!model_.grounded && (options.floating || alone));
    for (Part& part : parts_) check(part, options.balance);
  }

  std::string text() {
    std::string couplings;
    for (const ModelCoupling& coupling : model_.couplings) couplings += text_of(coupling);
    std::string text = comment(fmt::format("Of the robot {} in {}, with every joint at 0 or at its nearest limit.",
                                           in_quotes(model_.name), model_.file));
    for (const std::string& thing : model_.left_out) text += comment("Left out: " + thing + ".");
    for (const std::string& thing : model_.changed) text += comment("Changed: " + thing + ".");
    text += fmt::format("title     = {}\ndimension = 3\n", in_quotes(model_.name));
    if (model_.gravity) text += fmt::format("gravity   = {}\n", list(*model_.gravity));
    if (!model_.couplings.empty())
      text += "project   = true\n";  // a coordinate at its limit may not be where another wants
    for (const Part& part : parts_) text += text_of(part);
    for (const ModelJoint& joint : model_.joints)
      if (joint.type != ModelJointType::fixed && joint.type != ModelJointType::free) text += text_of(joint);
    for (const ModelLoop& loop : model_.loops) text += text_of(loop);
    return text + couplings;
  }

 private:
  [[noreturn]] void fail(int line, const std::string& what) const {
    if (line == 0) throw Error(fmt::format("{}, in a file that it includes: {}", model_.file, what));
    throw Error(fmt::format("{}:{}: {}", model_.file, line, what));
  }
  // A scene's names have letters, digits, _ and -; each once.
  template <class Named>
  void give_valid_names(std::vector<Named>& all) {
    std::set<std::string> taken;
    for (Named& one : all) {
      std::string name = one.name;
      std::ranges::replace_if(
          name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-'; }, '_');
      const std::string base = name.empty() ? "unnamed" : name;
      name = base;
      for (int k = 2; !taken.insert(name).second; ++k) name = fmt::format("{}_{}", base, k);
      if (name != one.name) model_.changed.push_back(fmt::format("the name {} is {}", in_quotes(one.name), name));
      one.name = name;
    }
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
    const auto turn = [&](const ModelCoordinate& c, const Vector3d& axis) {
      moved = moved * Eigen::Translation3d(joint.point) * Eigen::AngleAxisd(c.start(), axis) *
              Eigen::Translation3d(-joint.point);
      tell_start(joint, c);
    };
    if (joint.type == ModelJointType::slider) {
      moved.translation() = joint.coordinate.start() * joint.axis;
      tell_start(joint, joint.coordinate);
    } else if (joint.type == ModelJointType::hinge || joint.type == ModelJointType::universal) {
      turn(joint.coordinate, joint.axis);
      if (joint.type == ModelJointType::universal) turn(joint.about_second, joint.second);
    }
    return moved;
  }
  void tell_start(const ModelJoint& joint, const ModelCoordinate& c) {
    if (c.start() == 0) return;
    model_.changed.push_back(fmt::format("joint {} starts at {}, its limit, and its coordinate counts from there",
                                         in_quotes(joint.name), number(c.start())));
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
      fail(part.line,
           fmt::format("{} {} moves and has no mass. Likely fix: an <inertial>{}", model_.word, in_quotes(part.name),
                       model_.grounded ? ", or a simple geom" : ", or a fixed joint above it"));
    if (I.isZero(0))
      fail(part.line, fmt::format("{} {} turns and has no inertia. Likely fix: an <inertia> in its <inertial>",
                                  model_.word, in_quotes(part.name)));
    const char* mistake = mistake_of(I);
    if (mistake && !balance)
      fail(part.line, fmt::format("{} {}: {}. Likely fix: its <inertia>, or --balance-inertias", model_.word,
                                  in_quotes(part.name), mistake));
    if (!mistake) return;
    const double mean = I.trace() / 3;
    if (!(mean > 0)) fail(part.line, fmt::format("{} {}: {}", model_.word, in_quotes(part.name), mistake));
    I = mean * Matrix3d::Identity();
    model_.changed.push_back(fmt::format("the inertia of {} {}, which no rigid body has: it is {} about all axes",
                                         model_.word, in_quotes(part.name), number(mean)));
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
        fmt::format("\n[[body]]\nname        = {}\nmass        = {}\n", in_quotes(name_of_body(part)), part.mass);
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
    std::string text = head_of(joint.name, type_of(joint), joint.parent, joint.child, pose * joint.point);
    const Vector3d axis = pose.linear() * joint.axis;
    switch (joint.type) {
      case ModelJointType::ball: return text;
      case ModelJointType::universal: return text + about_two_axes(joint, pose);
      case ModelJointType::slider:
        return text + fmt::format("fa     = {{ world = {} }}\n", list(axis)) + effects_of(joint.coordinate, "slide");
      default:
        return text + fmt::format("fa     = {{ world = {} }}\n", list(axis)) + effects_of(joint.coordinate, "angle");
    }
  }
  std::string head_of(const std::string& name, const char* type, int a, int b, const Vector3d& at) const {
    return fmt::format("\n[[joint]]\nname   = {}\ntype   = \"{}\"\nbodies = [{}, {}]\nat     = {}\n", in_quotes(name),
                       type, in_quotes(body_of(a)), in_quotes(body_of(b)), list(at));
  }

  // fa.y is the first axis, fixed in the parent, and fb.z the second one, fixed in the child; both frames coincide
  // where the joint is at 0, from which its coordinates count.
  std::string about_two_axes(const ModelJoint& joint, const Isometry3d& child) const {
    const Matrix3d parent = child.linear() * Eigen::AngleAxisd(-joint.about_second.start(), joint.second) *
                            Eigen::AngleAxisd(-joint.coordinate.start(), joint.axis).toRotationMatrix();
    const auto frame = [&](const char* name, int link, const Matrix3d& of) {
      const Matrix3d body = axes_of_body(link).transpose() * of;
      return fmt::format("{}     = [{}, {}]\n", name, list(body * joint.axis.cross(joint.second)),
                         list(body * joint.axis));
    };
    return frame("fa", joint.parent, parent) + frame("fb", joint.child, child.linear()) +
           effects_of(joint.coordinate, "bend_a", 0) + effects_of(joint.about_second, "bend_b", 0);
  }
  Matrix3d axes_of_body(int link) const {
    const int part = part_of_[static_cast<std::size_t>(link)];
    return part == world ? Matrix3d(Matrix3d::Identity()) : parts_[static_cast<std::size_t>(part)].axes;
  }

  std::string text_of(const ModelLoop& loop) const {
    const Isometry3d& pose = poses_[static_cast<std::size_t>(loop.a)];
    std::string text = head_of(loop.name, loop.fixed ? "fixed" : "spherical", loop.a, loop.b, pose * loop.point);
    if (loop.fixed) text += fmt::format("fa     = {{ world = {} }}\n", list(Vector3d::UnitX()));
    return text;
  }

  // A joint of one's own, whose spec lies beside the scene.
  std::string text_of(const ModelCoupling& coupling) {
    std::vector<std::string> bodies;
    std::string parameters;
    const auto letter = [&](int link) {
      const std::string body = body_of(link);
      const auto known = std::ranges::find(bodies, body);
      const auto place = known - bodies.begin();
      if (known == bodies.end()) bodies.push_back(body);
      return static_cast<char>('a' + place);
    };
    const auto coordinate = [&](int number, int k) {
      const ModelJoint& joint = model_.joints[static_cast<std::size_t>(number)];
      const Isometry3d& pose = poses_[static_cast<std::size_t>(joint.child)];
      const bool turns = joint.type == ModelJointType::hinge;
      const std::string axis = list(pose.linear() * joint.axis), at = list(pose * joint.point);
      parameters += turns ? fmt::format("f{}     = {{ world = {} }}\n", k, axis)
                          : fmt::format(
                                "u{0}     = {{ world = {1} }}\np{0}     = {{ world = {2} }}\ns{0}     = {{ world = "
                                "{2} }}\n",
                                k, axis, at);
      const char above = letter(joint.parent), below = letter(joint.child);
      return CoupledCoordinate{above, below, turns, joint.coordinate.start()};
    };
    const CoupledCoordinate first = coordinate(coupling.first, 1);
    std::optional<CoupledCoordinate> second;
    if (coupling.second >= 0) second = coordinate(coupling.second, 2);
    const std::string type = stem_ + "_" + coupling.name;
    model_.specs.push_back({type + ".joint", coupling_spec(type, first, second, coupling.coefficients)});
    std::string names;
    for (const std::string& body : bodies) names += (names.empty() ? "" : ", ") + in_quotes(body);
    return fmt::format("\n[[joint]]\nname   = {}\ntype   = {}\nbodies = [{}]\n{}", in_quotes(coupling.name),
                       in_quotes(type), names, parameters);
  }

  static const char* type_of(const ModelJoint& joint) {
    switch (joint.type) {
      case ModelJointType::hinge: return "hinge";
      case ModelJointType::slider: return "slider";
      case ModelJointType::plane: return "planar_joint";
      case ModelJointType::universal: return "universal";
      default: return "spherical";
    }
  }

  // `from`: where the scene's coordinate is 0.
  static std::string effects_of(const ModelCoordinate& c, const char* coordinate) {
    return effects_of(c, coordinate, c.start());
  }
  static std::string effects_of(const ModelCoordinate& c, const char* coordinate, double from) {
    std::string text;
    if (c.range)
      text += fmt::format("{}.limit = {{ lower = {}, upper = {} }}\n", coordinate, number(c.range->lower - from),
                          number(c.range->upper - from));
    if (c.friction > 0) text += fmt::format("{}.friction = {}\n", coordinate, c.friction);
    if (c.damping > 0 || c.stiffness > 0)
      text += fmt::format("{}.spring = {{ stiffness = {}, damping = {}{} }}\n", coordinate, c.stiffness, c.damping,
                          c.stiffness > 0 ? ", rest = " + number(c.rest - from) : "");
    if (c.servo > 0)
      text += fmt::format("{}.servo = {{ target = {}, k = {}, most = {} }}\n", coordinate, number(c.target - from),
                          c.servo, c.most);
    return text;
  }

  Model& model_;
  const std::string stem_;
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
