// Inputs of the measurement: random ones, and ill-conditioned ones.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "tests/kernels/sample.hpp"

namespace cdot::ulp {

enum class Family {
  random,         // anywhere within 2 m
  satisfied,      // C nearly 0, all bodies moving nearly as one: the typical state of a simulation
  far,            // the same far from the origin
  singular,       // bodies nearly in one place, with relative rotations of nearly 0, 90 or 180 degrees
  equal_anchors,  // long arms whose ends nearly meet
  masses,         // masses and inertias that differ by up to twelve powers of ten
  number
};
inline constexpr auto families = static_cast<std::size_t>(Family::number);
inline constexpr std::array<std::string_view, families> family_names = {"random",   "satisfied",     "far",
                                                                        "singular", "equal anchors", "masses"};

// `digits`: decimal digits of the scalar, which scale "nearly" and "far".
Inputs inputs_of(Family family, const AnyBlock& block, void (*set_defaults)(Inputs&), int digits, std::uint32_t seed);

}  // namespace cdot::ulp
