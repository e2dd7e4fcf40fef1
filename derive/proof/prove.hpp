// The laws that every derivation has to obey, proved by GiNaC and exactly, independently of our own
// derivative.
#pragma once

#include <string>
#include <vector>

#include "derive/derivation/derivation.hpp"
#include "derive/numbers/modular.hpp"

namespace cdot::derive {

enum class Verdict {
  holds,
  shown,  // too much for algebra; true at `exact_points` random points modulo a prime
  fails,
  undecided,      // algebra does not decide; numbers agree to 60 digits at several poses
  does_not_apply  // no C at velocity level, a joint with the world, ...
};

enum class LawId {
  rate,       // Cdot is GiNaC's time derivative of C, by the chain rule over names
  linear,     // Cdot is linear in v
  jacobian,   // J v + dC/dt = Cdot
  raw,        // J is what GiNaC derives from C in raw coordinates x, y, theta
  mass,       // K is symmetric and J M^-1 J^T
  gamma,      // gamma = -Jdot v - d/dt dC/dt
  stiffness,  // the geometric stiffness is the Hessian of lambda . C in raw coordinates
  forms,      // in space: J by body-local spins and by Euler parameters is the derivative of C along them
  momentum,   // a joint without the world is not felt by a common motion of all bodies
  rank        // as many independent rows as are written
};
inline constexpr int number_of_laws = 10;

struct Law {
  LawId id = LawId::rate;
  Verdict verdict = Verdict::holds;
  std::string text;          // what fails, and where it can be seen; empty if the law holds
  std::string fix;           // what the author may do about it; empty if it is no matter of the spec
  const Row* row = nullptr;  // that breaks it, if it is a row's doing
  std::vector<Span> parts;   // the terms of the row that break it
};

// One entry per law, in the order of LawId.
struct Proof {
  std::vector<Law> laws;
  bool holds() const;  // no law fails or is undecided
  const Law& of(LawId id) const { return laws[static_cast<std::size_t>(id)]; }
};

std::string_view name_of(LawId id);   // "J v + dC/dt = Cdot"
std::string_view name_of(Verdict v);  // "holds"

// `block` is what derive_rows or derive_coordinate made of the joint.
Proof prove(const Joint& joint, const Block& block);

}  // namespace cdot::derive
