// Contradicting joints: no pose satisfies C = 0. The bodies come to rest and stay there.
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::incompatible_triangle {
namespace {

void settle(Trial& t) {
  t.start();
  t.run(1);
  const double energy = t.energy(), gap = t.gap();
  const Watch w = t.run(1);
  t.at_most("energy after 1 s [J]", energy, 1e-6);
  t.at_most("its growth after that [J]", w.rise, 1e-12);
  t.at_most("gap moves by [m]", std::abs(t.gap() - gap), 1e-6);
  if (t.way.solver == Solver::direct)  // the least sum of squares: all three joints share the error
    t.near("gap off 0.02 / 3 [m]", w.gap, 0.02 / 3, 1e-9, 1e-6);
  else t.at_most("gap [m]", w.gap, 0.02);
}

const Register planar({"incompatible_triangle", "planar", all_ways(), settle});
const Register spatial({"incompatible_triangle", "spatial", all_ways(), settle});

}  // namespace
}  // namespace cdot::hard::incompatible_triangle
