// What the errors are measured against: a trajectory that two different methods agree on, or one that was given.
#pragma once

#include <string>
#include <vector>

#include "runtime/accuracy_run.hpp"

namespace cdot {

inline constexpr int sample_count = 16;
inline constexpr double wanted_agreement = 1e-12;  // [m, rad], of a reference that is made here

struct ReferenceRun {
  std::vector<double> times;
  std::vector<Frame> frames;
  std::string made_by;           // "dop853 and extrapolated rattle", "four_bar.csv"
  std::string settled;           // by how much each of the two still changed
  std::vector<double> disagree;  // by how much the two methods do, at each time [m, rad]; empty if it was given
  // Errors below this are not told apart: ten times what the methods disagree by, 0 if it was given.
  double resolution() const;
  double disagreement() const;  // the largest
  // The last time at which the two agreed to within `bound`; 0 if never.
  double agreed_until(double bound) const;
};

// Made by two methods, each refined until it changes no more, or until it has used so much CPU time [s].
ReferenceRun make_reference_run(const Scene& scene, double cpu_limit, const Stop& stop = {});

// As `cdot-run simulate -o` writes it; its last row ends the comparison. Throws cdot::Error.
ReferenceRun read_reference_run(const std::string& path, const Scene& scene);

struct Errors {
  double position = 0, angle = 0;  // from the reference [m], [rad]
  double C = 0, Cdot = 0;          // the largest of any joint at the samples
  double energy = 0;               // from the reference [J]
  double trajectory() const { return position > angle ? position : angle; }
  bool operator==(const Errors&) const = default;
};
Errors errors_of(const Trajectory& trajectory, const ReferenceRun& reference, Dimension dimension);

// How large the motion is [m]: an error beyond it says nothing any more. At least 1.
double size_of(const ReferenceRun& reference);

}  // namespace cdot
