// A model as robot descriptions have it: links, and the joints that hold them in a tree.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
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

enum class ModelJointType { fixed, hinge, slider, plane, ball, free };

struct ModelJoint {
  std::string name;
  int line = 0;
  ModelJointType type = ModelJointType::fixed;
  int parent = -1, child = -1;                               // links
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();  // of the child's frame in that of the parent, at 0
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();           // in the child's frame
  struct Range {
    double lower = 0, upper = 0;
  };
  double start() const { return range ? std::clamp(0.0, range->lower, range->upper) : 0; }  // 0 if it may be there
  std::optional<Range> range;                                                               // [rad] or [m]
  double damping = 0, friction = 0;  // [N m s/rad, N m] or [N s/m, N]
};

struct Model {
  std::string name, file;
  std::vector<ModelLink> links;
  std::vector<ModelJoint> joints;
  std::vector<std::string> left_out;  // for a person: one thing each
  std::vector<std::string> changed;   // likewise, by scene_text()
};

// The text of a URDF file. Throws cdot::Error with file and line.
Model read_urdf(const std::string& text, const std::string& file);

struct ImportOptions {
  bool floating = false;  // the root moves; without this it is the world, unless the model is a single body
  bool balance = false;   // an inertia that no rigid body has becomes the mean of its principal moments about all axes
                          // (MuJoCo, `balanceinertia`)
};

// The text of a scene: links that fixed joints hold become one body. Adds to model.changed. Throws cdot::Error with
// file and line.
std::string scene_text(Model& model, const ImportOptions& options);

}  // namespace cdot
