// The equations of a mechanism as programs, a function of the header each.
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "derive/compile/algebra.hpp"
#include "derive/compile/joint_programs.hpp"
#include "derive/compile/mechanism.hpp"

namespace cdot::compile {

// Rows of all joints, numbered from joint to joint.
struct RowOf {
  std::string name;  // "hinge_pin_x"
  std::size_t joint = 0, row = 0;
};

struct Equations {
  std::vector<RowOf> rows;
  std::vector<std::string> stored;  // the numbers of J and of its factor that `evaluate` writes
  std::set<std::string> turning;    // bodies whose c and s are read
  Constants constants;
  bool driven = false;  // dC/dt at fixed q is not 0
  Program evaluate;     // q, time -> J: Jacobian, factor of K = J M^-1 J^T
  Program errors;       // q, time -> C
  Program rates;        // J, v -> J v + dC/dt
  Program gamma;        // q, v, time -> -Jdot v - d/dt(dC/dt)
  Program solve;        // J, b -> lambda with K lambda = b, d = M^-1 J^T lambda
};

// `names` are those of bodies and joints in C++; "" for bodies that do not move.
struct Names {
  std::vector<std::string> bodies, joints;
};

Equations equations_of(const Mechanism& mechanism, const Names& names, const derive::SpecsFolder& specs);

}  // namespace cdot::compile
