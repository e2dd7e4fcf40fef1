// A scene and what a run of it did -> its work, the measure of all bounds on runs: it is the same on every machine.
#pragma once

#include "runtime/tool/run/simulate.hpp"

namespace cdot {

// Work counts evaluations of accelerations by bodies, of which each island has `overhead` more. Measured over all
// scenes, a unit takes a tenth to half a microsecond.
inline constexpr double overhead = 4;
// An evaluation of StepCounts, which is that of one island: of the mean body's, since the largest take most of them.
double work_of_evaluation(const Scene& scene);
// Of each island once, in units of that.
double evaluations_of_all(const Scene& scene);
// Methods with fixed steps pay by step, in evaluations.
constexpr double price_of_step(const IntegratorRow& row) { return row.stiffens ? 4 : row.projects ? 3 : 2; }
// Collocation pays by step for two differences of accelerations by components of velocity, in evaluations.
double price_of_derivatives(const Scene& scene);

// Of a run by the scene's own method, known before it: 0 for methods on accelerations, which may take any number.
double work_of_steps(const Scene& scene);
// Of a run that was, with the search for its method.
double work_of(const Scene& scene, const RunResult& result);

}  // namespace cdot
