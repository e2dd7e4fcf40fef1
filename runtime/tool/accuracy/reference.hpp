// The reference for errors: a trajectory on which two different methods agree, or one from a file.
#pragma once

#include <string>
#include <vector>

#include "runtime/tool/accuracy/refine.hpp"

namespace cdot {

inline constexpr int sample_count = 16;
inline constexpr double wanted_agreement = 1e-12;  // [m, rad], of a computed reference

// The growth of a change of the start, at the worst sample.
struct Sensitivity {
  double condition = 0;   // factor of growth of a change by 1e-9 of the largest place, speed and spin, and 1e-9 rad
  double round_off = 0;   // [m, rad] the same of a change by `slight`, with round-off on the way
  double slight = 1e-15;  // smaller in extended precision
  bool known() const { return condition > 0; }
};

// The cause of a disagreement.
std::string verdict_on(double disagreement, const Sensitivity& sensitivity, bool finer_would_help);

struct ReferenceRun {
  std::vector<double> times;
  std::vector<Frame> frames;
  std::string made_by;  // "dop853 and composed rattle", "four_bar.csv"
  std::string settled;  // how much each of the two still changed
  // At each time, the disagreement of the two methods, or the change that finer steps do not reduce [m, rad]. Empty if
  // the reference is from a file.
  std::vector<double> disagree;
  Sensitivity sensitivity;  // where they disagree by more than wanted_agreement
  std::string verdict;      // the cause, then
  // Errors below this count as equal: ten times the disagreement; 0 if the reference is from a file.
  double resolution() const;
  double disagreement() const;  // the largest
  // The last time up to which the two agree to within `bound`; 0 if never.
  double agreed_until(double bound) const;
};

// Computes a reference by two methods. Each is refined until it changes no more or has spent its effort. Where doubles
// do not agree to wanted_agreement, both run in extended precision.
ReferenceRun make_reference_run(const Scene& scene, const Effort& effort = {}, const Stop& stop = {});

// Reads a file of `cdot-run simulate -o`; its last row ends the comparison. Throws cdot::Error.
ReferenceRun read_reference_run(const std::string& path, const Scene& scene);

struct Errors {
  double position = 0, angle = 0;  // from the reference [m], [rad]
  double C = 0, Cdot = 0;          // the largest of any joint, at the times checked
  double energy = 0;               // from the reference [J]; between its samples too, if its energy is constant
  double trajectory() const { return position > angle ? position : angle; }
  bool operator==(const Errors&) const = default;
};
Errors errors_of(const Trajectory& trajectory, const ReferenceRun& reference, const Scene& scene);

// The extent of the motion [m], at least 1. Larger errors mean failure.
double size_of(const ReferenceRun& reference);

}  // namespace cdot
