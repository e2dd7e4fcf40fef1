// The method for fixed steps of a World: the cheapest that holds what its islands are.
//
//   const cdot::Recommendation found = cdot::recommended(world, 1.0 / 60);
//   world.use(found.settings);
#pragma once

#include <functional>
#include <string>

#include <cdot/world.hpp>

namespace cdot {

struct Recommendation {
  // Those of the World with the direct solver, the projection and the chosen integrator; with more substeps where a
  // body that pivots beside its centre rotates by more than 2 rad per substep.
  Settings settings;
  int island = -1;     // that decided; -1: there is none
  double radians = 0;  // of its stiffest oscillation per substep
  std::string reason;  // "the tension of the joints can make body 3 oscillate by 9.9 rad per substep"
};

// For steps of `step` [s]. Looks at the World as it stands before its first step, and as it may come to hang: with
// three times its weight from every side, as at the lowest point of a swing. Costs some hundred steps, and leaves the
// state as it is. `name_of_body` names bodies in the reason. Throws cdot::Error after the first step.
template <class S>
Recommendation recommended(BasicWorld<S>& world, double step, const std::function<std::string(int)>& name_of_body = {});

// For steps of `step` that may take `budget` [s] of this machine's time: the recommended method with as many substeps
// as that allows, at most 64. If it does not allow one, the iterative solver with as many iterations as it allows.
// Measures some steps of each and takes them back, so that other machines may answer otherwise.
template <class S>
Recommendation recommended_within(BasicWorld<S>& world, double step, double budget,
                                  const std::function<std::string(int)>& name_of_body = {});

}  // namespace cdot
