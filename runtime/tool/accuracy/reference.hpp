// What the errors are measured against: a trajectory that two different methods agree on, or one that was given.
#pragma once

#include <string>
#include <vector>

#include "runtime/tool/accuracy/refine.hpp"

namespace cdot {

inline constexpr int sample_count = 16;
inline constexpr double wanted_agreement = 1e-12;  // [m, rad], of a reference that is made here

// How far a change of the start takes the motion, at its worst sample.
struct Sensitivity {
  double condition = 0;   // the growth of a change by 1e-9 of the largest place, speed and spin, and 1e-9 rad
  double round_off = 0;   // [m, rad] what one by `slight` of them comes to, on the way through round-off
  double slight = 1e-15;  // in extended precision less
  bool known() const { return condition > 0; }
};

// What is to blame for it that methods disagree by so much.
std::string verdict_on(double disagreement, const Sensitivity& sensitivity, bool finer_would_help);

struct ReferenceRun {
  std::vector<double> times;
  std::vector<Frame> frames;
  std::string made_by;  // "dop853 and composed rattle", "four_bar.csv"
  std::string settled;  // by how much each of the two still changed
  // At each time, by how much the two methods do, and by how much each changes that no finer step mends [m, rad]; empty
  // if it was given.
  std::vector<double> disagree;
  Sensitivity sensitivity;  // where they disagree by more than is wanted,
  std::string verdict;      // and what is to blame for it, in words
  // Errors below this are not told apart: ten times what the methods disagree by, 0 if it was given.
  double resolution() const;
  double disagreement() const;  // the largest
  // The last time at which the two agreed to within `bound`; 0 if never.
  double agreed_until(double bound) const;
};

// Made by two methods, each refined until it changes no more or has used up its effort; in extended precision where
// doubles do not agree as wanted.
ReferenceRun make_reference_run(const Scene& scene, const Effort& effort = {}, const Stop& stop = {});

// As `cdot-run simulate -o` writes it; its last row ends the comparison. Throws cdot::Error.
ReferenceRun read_reference_run(const std::string& path, const Scene& scene);

struct Errors {
  double position = 0, angle = 0;  // from the reference [m], [rad]
  double C = 0, Cdot = 0;          // the largest of any joint, as far as the trajectory was watched
  double energy = 0;               // from the reference [J]; where that keeps its energy, whenever it was watched
  double trajectory() const { return position > angle ? position : angle; }
  bool operator==(const Errors&) const = default;
};
Errors errors_of(const Trajectory& trajectory, const ReferenceRun& reference, const Scene& scene);

// How large the motion is [m]: an error beyond it says nothing any more. At least 1.
double size_of(const ReferenceRun& reference);

}  // namespace cdot
