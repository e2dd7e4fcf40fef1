// Isolates the velocities: multiplies Cdot out until each term has one v or w, and names the identity that turns the
// term into "something times that velocity".
#pragma once

#include "derive/explain/explain.hpp"

namespace cdot::derive {

struct VelocityTerm {
  bool minus = false;
  Formula written;       // as it stands in Cdot: t · (w_a × ra)
  int body = -1;         // whose velocity it contains; -1: none, the term belongs to dC/dt
  bool spin = false;     // w, else v
  Expr coefficient;      // with the sign: the factor of the velocity; 0 if the term vanishes
  std::string identity;  // why; empty if the term shows it already
};

// A scalar Cdot as a sum of such terms.
std::vector<VelocityTerm> isolate(const Formula& Cdot, const Joint& joint);

// One body's part of J for a vector row: the factors of v and of w. In the plane E and S(r), in space E and -S(r).
struct VelocityBlocks {
  Formula v, w;  // 0 where the velocity does not occur
};
// J of a vector equation, block by block; nothing if some velocity enters otherwise than by products.
std::optional<std::vector<VelocityBlocks>> isolate_vector(Expr Cdot, const Joint& joint, const Notation& notation);

// coefficient velocity, as a term is written: t · v_a, (ra × t) w_a.
Formula multiplied(Expr coefficient, int body, bool spin, const Joint& joint, const Notation& notation);

}  // namespace cdot::derive
