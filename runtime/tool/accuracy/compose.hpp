// A trajectory of order 10 from a symmetric method alone, as RATTLE is: 35 of its steps, of chosen lengths and some of
// them backwards, make one in which the errors of lower order cancel. It knows the method only by its World, and what
// comes out owes nothing to accelerations. Nothing is taken apart and weighted, as extrapolation would: round-off stays
// that of the steps.
#pragma once

#include "runtime/tool/run/trajectory.hpp"

namespace cdot {

// Whether the motion goes back the same way when velocities turn round, and nothing stops it: no dampers, friction,
// motors or limits, nothing driven in time, nothing that breaks. Only then is it of that order.
bool reversible(const Scene& scene);

// `steps` such steps from one of the times to the next, in doubles or in extended precision. Counts::evaluations are
// the method's steps.
Trajectory composed(Integrator symmetric, const Scene& scene, int steps, const std::vector<double>& times,
                    const Stop& stop = {}, bool extended = false);

}  // namespace cdot
