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
  double ax = 0, ay = 0, aw = 0;             // of constant forces and torques [m/s^2], [rad/s^2]
  double linear_drag = 0, angular_drag = 0;  // [1/s]
};

struct Joint {
  std::string name, type;
  std::vector<int> bodies;         // indices into Mechanism::bodies
  std::vector<double> parameters;  // laid out as Parameters<T> of the kernel
};

// A force along each row of a spec, or along one of its coordinates; a row with bounds on a coordinate.
struct Effect {
  std::string name;                // "hinge.angle.servo"
  std::string type;                // the spec that has the rows
  std::string coordinate;          // of that spec; empty: its own rows
  std::vector<int> bodies;         // of that spec
  std::vector<double> parameters;  // of that spec
  enum Law {
    of_spec,  // that of a spec; `numbers` are its Parameters<T>
    spring,   // -k C - d dC/dt; numbers: 1 by frequency, frequency or k, damping ratio or d, rest
    load,     // numbers: F
    // Rows with bounds:
    limited,  // of_spec, a force within limits
    bound,    // of_spec, its bounded row number `row`
    motor,    // numbers: rate, largest force
    limit,    // numbers: lower, upper end
    lock      // numbers: the value held
  } law = of_spec;
  std::string law_type;  // of_spec, limited, bound
  std::size_t row = 0;
  std::vector<double> numbers;
};

enum class Method { euler, rk4, dop853 };

struct Mechanism {
  std::string file, title, method_name;
  Method method = Method::rk4;
  double step = 0;                      // [s]
  double tolerance = 0;                 // of C [m], [rad]
  double gravity_x = 0, gravity_y = 0;  // [m/s^2]
  std::vector<std::string> inputs;      // numbers that a run may change, as a header names them
  std::vector<Body> bodies;             // the last one is the world
  std::vector<Joint> joints;
  std::vector<Effect> effects;  // by forces
  std::vector<Effect> bounded;  // rows with bounds
};

// Choices of the command line in place of the scene's; empty and 0: as the scene has it.
struct Wishes {
  std::string integrator;
  double step = 0;
  std::vector<std::string> inputs;  // "hinge.angle.servo.target"
};

// Throws SceneError for a scene that has mistakes, or that has parts which cannot be compiled.
Mechanism read_mechanism(const std::string& file, const Wishes& wishes);

}  // namespace cdot::compile
