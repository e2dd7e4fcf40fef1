// A trajectory by extrapolation: every stretch of time is taken with 1, 2, 3, … steps of a simple method, and the ends
// are extrapolated to steps of length 0 (Aitken and Neville; Gragg, Bulirsch and Stoer where the method is symmetric).
// The stretches are as long as the tolerance allows, so that they become tiny around a kink of the motion, where a
// motor reaches its speed or a rope its length. It knows the method only by its World: what comes out owes nothing to
// the formulas of another one.
#pragma once

#include "runtime/accuracy_run.hpp"

namespace cdot {

struct Extrapolation {
  Way way;        // in double
  int power = 1;  // the error of the method has an expansion in powers of h^power: 2 if it is symmetric
  int columns;    // 1, 2, …, columns steps a stretch; the order is power * columns
};

// `stop` is asked after every stretch. The tolerance is for one stretch, relative to numbers greater than 1.
Trajectory extrapolated(const Scene& scene, const Extrapolation& method, double tolerance,
                        const std::vector<double>& times, const Stop& stop = {});

}  // namespace cdot
