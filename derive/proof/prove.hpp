// The laws of every derivation, proved by GiNaC or by exact arithmetic, independently of our own derivative.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "derive/derivation/derivation.hpp"
#include "derive/numbers/modular.hpp"

namespace cdot::derive {

enum class Verdict {
  holds,
  shown,  // true at `exact_points` random points modulo a prime; too expensive for algebra
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
  momentum,   // a common motion of all bodies does not change a joint without the world
  rank,       // no row is redundant
  // Of blocks specialised from one that obeys these:
  immovable,  // each variant is the block with that body's velocity and inverse mass zero
  isotropic,  // in space: K for numbers as inertias is K for tensors that are such a number times E
  // Of the law of an effect:
  force,    // F is -dE/dC and what the spec adds
  slopes,   // k = -dF/dC, d = -dF/d(rate)
  opposite  // the forces of all rows together leave momentum and angular momentum as they are
};
inline constexpr int number_of_laws = 10;  // of a block by itself

struct Law {
  LawId id = LawId::rate;
  Verdict verdict = Verdict::holds;
  std::string text;          // the failure, with an example; empty if the law holds
  std::string fix;           // advice to the author; empty if the spec is not the cause
  const Row* row = nullptr;  // the row that breaks it, if one does
  std::vector<Span> parts;   // the terms of the row that break it
};

bool is_broken(const Law& law);  // it fails, or is undecided

// One entry per law that was judged.
struct Proof {
  std::vector<Law> laws;
  bool holds() const;  // no law is broken
  const Law& of(LawId id) const { return *std::ranges::find(laws, id, &Law::id); }
};

std::string_view word_of(LawId id);  // "jacobian"
std::optional<LawId> law_of(std::string_view word);
std::string_view name_of(LawId id);   // "J v + dC/dt = Cdot"
std::string_view name_of(Verdict v);  // "holds"

// Operands of sums and products that GiNaC's derivatives of one block may have; the catalogue needs 80,000. Beyond, the
// derivatives have values at random points only, and laws are shown, not proved.
inline constexpr std::int64_t most_slopes = 150000;

// Judges the laws of a block by itself; `block` is the result of derive_rows or derive_coordinate.
Proof prove(const Joint& joint, const Block& block, std::int64_t slopes = most_slopes);

struct Proved {
  std::string name;  // of a coordinate; empty for the rows of the joint
  Span where;        // the coordinate stands
  Proof proof;
};
// The rows and the coordinates, each by itself; with the rows of an effect its law.
std::vector<Proved> prove_blocks(const Derivation& derivation);
// Everything that kernels contain: these blocks and, by the last laws, their variants and K of isotropic bodies.
std::vector<Proved> prove(const Derivation& derivation);

}  // namespace cdot::derive
