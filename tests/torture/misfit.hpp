// Nearly misfitting loops: a mechanism at rest with one joint that is a little off. Nothing may come of it.
#pragma once

#include <cstdint>

#include "tests/torture/draw/generate.hpp"
#include "tests/torture/invariants.hpp"

namespace cdot::torture {

// A mechanism of generate() at rest, without forces, springs and effects. A point of one joint, or of its copy, is off
// by 1e-5 to 1e-3 of the mechanism's size. The direct solver with projection runs it.
Mechanism nearly_misfitting(std::uint64_t seed, Wish wish);

// held: the joints fit after all, or the World tells that they contradict each other and no body moves on; limited: a
// step fails aloud; broken: it is not told, a body creeps, or energy rises.
Verdict judge_misfit(const Scene& scene);

}  // namespace cdot::torture
