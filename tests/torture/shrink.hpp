// Shrinks a scene that breaks an invariant while the same invariant still breaks: fewer bodies, joints and effects,
// plain settings, round numbers, fewer steps.
#pragma once

#include <functional>

#include "tests/torture/invariants.hpp"

namespace cdot::torture {

struct Shrunk {
  Scene scene;
  Verdict verdict;
  int tries = 0;
};

using Judge = std::function<Verdict(const Scene&)>;

Shrunk shrink(const Scene& scene, const Verdict& verdict, const Judge& judge, int most_tries = 600);

}  // namespace cdot::torture
