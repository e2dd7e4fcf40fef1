// The laws that every derivation has to obey, proved by GiNaC and exactly, independently of our own derivative.
#pragma once

#include <optional>
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
  rank,       // as many independent rows as are written
  // Of what is specialised from a block that obeys these:
  immovable,  // each variant is the block with that body's velocity and inverse mass zero
  isotropic   // in space: K for numbers as inertias is K for tensors that are such a number times E
};
inline constexpr int number_of_laws = 10;  // of a block by itself

struct Law {
  LawId id = LawId::rate;
  Verdict verdict = Verdict::holds;
  std::string text;          // what fails, and where it can be seen; empty if the law holds
  std::string fix;           // what the author may do about it; empty if it is no matter of the spec
  const Row* row = nullptr;  // that breaks it, if it is a row's doing
  std::vector<Span> parts;   // the terms of the row that break it
};

bool is_broken(const Law& law);  // it fails, or is undecided

// One entry per law, in the order of LawId.
struct Proof {
  std::vector<Law> laws;
  bool holds() const;  // no law is broken
  const Law& of(LawId id) const { return laws[static_cast<std::size_t>(id)]; }
};

std::string_view word_of(LawId id);  // "jacobian"
std::optional<LawId> law_of(std::string_view word);
std::string_view name_of(LawId id);   // "J v + dC/dt = Cdot"
std::string_view name_of(Verdict v);  // "holds"

// `block` is what derive_rows or derive_coordinate made of the joint; by the laws of a block by itself.
Proof prove(const Joint& joint, const Block& block);

struct Proved {
  std::string name;  // of a coordinate; empty for the rows of the joint
  Span where;        // the coordinate stands
  Proof proof;
};
// The rows and the coordinates, each by itself.
std::vector<Proved> prove_blocks(const Derivation& derivation);
// All that kernels are made of: those, and by the last laws their variants and what isotropic bodies have.
std::vector<Proved> prove(const Derivation& derivation);

}  // namespace cdot::derive
