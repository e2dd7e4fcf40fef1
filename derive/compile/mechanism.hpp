// A scene as numbers: what the compiler of scenes knows of the runtime. World and scene stay behind mechanism.cpp.
#pragma once

#include <string>
#include <vector>

namespace cdot::compile {

struct Body {
  std::string name;
  bool moves = true;
  double x = 0, y = 0, angle = 0;  // at the start [m], [rad]
  double vx = 0, vy = 0, w = 0;
  double inv_m = 0, inv_I = 0;               // [1/kg], [1/(kg m^2)]
  double ax = 0, ay = 0, aw = 0;             // without joints: gravity and constant forces [m/s^2], [rad/s^2]
  double linear_drag = 0, angular_drag = 0;  // [1/s]
};

struct Joint {
  std::string name, type;
  std::vector<int> bodies;         // indices into Mechanism::bodies
  std::vector<double> parameters;  // laid out as Parameters<T> of the kernel
  bool explicit_time = false;
};

enum class Method { euler, rk4, dop853 };

struct Mechanism {
  std::string file, title, method_name;
  Method method = Method::rk4;
  double step = 0;       // [s]
  double tolerance = 0;  // of C [m], [rad]
  std::vector<Body> bodies;
  std::vector<Joint> joints;
};

// What the command line asks for in place of the scene; empty and 0: as the scene has it.
struct Wishes {
  std::string integrator;
  double step = 0;
};

// Throws SceneError for a scene that has mistakes, or that has parts which cannot be compiled.
Mechanism read_mechanism(const std::string& file, const Wishes& wishes);

}  // namespace cdot::compile
