// A model as robot descriptions have it: links, and the joints that hold them in a tree.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace cdot {

struct ModelLink {
  std::string name;
  int line = 0;  // in the file
  double mass = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();          // of mass, in the link's frame [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();         // about the centre, along the link's axes [kg m^2]
  std::string shape;                                         // as a scene has it; empty: none
  Eigen::Matrix3d shape_axes = Eigen::Matrix3d::Identity();  // in the link's frame
};

enum class ModelJointType { fixed, hinge, slider, plane, ball, universal, free };

// A coordinate of a joint: its ends, and what acts on it.
struct ModelCoordinate {
  struct Range {
    double lower = 0, upper = 0;
  };
  std::optional<Range> range;              // [rad] or [m]
  double damping = 0, friction = 0;        // [N m s/rad, N m] or [N s/m, N]
  double stiffness = 0, rest = 0;          // of a spring, which is at rest there [N m/rad, rad] or [N/m, m]
  double servo = 0, target = 0, most = 0;  // stiffness, target and largest force of a servo; no servo if 0
  double start() const { return range ? std::clamp(0.0, range->lower, range->upper) : 0; }  // 0 if it may be there
};

struct ModelJoint {
  std::string name;
  int line = 0;
  ModelJointType type = ModelJointType::fixed;
  int parent = -1, child = -1;                               // links
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();  // of the child's frame in that of the parent, at 0
  Eigen::Vector3d point = Eigen::Vector3d::Zero();           // where it is, in the child's frame
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();           // in the child's frame; of a universal joint the first
  Eigen::Vector3d second = Eigen::Vector3d::UnitY();         // the second one, perpendicular to it
  ModelCoordinate coordinate;                                // of a hinge, a slider, the angle of a plane
  ModelCoordinate about_second;                              // of a universal joint
};

// Two links that a loop holds together, where they are at the start.
struct ModelLoop {
  std::string name;
  int line = 0;
  bool fixed = false;                               // else a ball
  int a = -1, b = -1;                               // links
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // in the frame of a
};

// A hinge or slider whose coordinate is a polynomial of that of another one: joints by number, -1: none.
struct ModelCoupling {
  std::string name;
  int first = -1, second = -1;
  std::vector<double> coefficients;  // from the constant on
};

// A spec beside the scene: the name of its file, and its text.
struct ModelSpec {
  std::string file, text;
};

struct Model {
  std::string name, file;
  std::vector<ModelLink> links;
  std::vector<ModelJoint> joints;
  std::vector<ModelLoop> loops;
  std::vector<ModelCoupling> couplings;
  std::optional<Eigen::Vector3d> gravity;  // [m/s^2]
  bool grounded = false;                   // the root is the world, whatever the options say
  std::string word = "link";               // of the format, for a link
  std::vector<std::string> left_out;       // for a person: one thing each
  std::vector<std::string> changed;        // likewise, by scene_text()
  std::vector<ModelSpec> specs;            // by scene_text(): its joints without a type of the catalogue
};

// A cylinder along z as a shape of a scene: a rod, which lies along x, or a disc.
void draw_cylinder(ModelLink& link, double radius, double length);
// "collisions (3 times)"
void add_counted(const std::map<std::string, int>& counted, std::vector<std::string>& to);
// About another point, r away.
inline Eigen::Matrix3d inertia_of_point(double mass, const Eigen::Vector3d& r) {
  return mass * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
}

// The text of a URDF or an MJCF file, or of either. Throws cdot::Error with file and line.
Model read_urdf(const std::string& text, const std::string& file);
Model read_mjcf(const std::string& text, const std::string& file);
Model read_model(const std::string& text, const std::string& file);

struct ImportOptions {
  bool floating = false;  // the root moves; without this it is the world, unless the model is a single body
  bool balance = false;   // an inertia that no rigid body has becomes the mean of its principal moments about all axes
                          // (MuJoCo, `balanceinertia`)
  std::string stem = "model";  // of the names of specs beside the scene
};

// The text of a scene: links that fixed joints hold become one body. Adds to model.changed and model.specs. Throws
// cdot::Error with file and line.
std::string scene_text(Model& model, const ImportOptions& options);

}  // namespace cdot
