// The parts of a check, one question each.
#pragma once

#include "derive/check/check.hpp"
#include "derive/numbers/numeric.hpp"

namespace cdot::derive {

// The input of every part: the joint, its derivation, and random poses, some of them with C = 0.
struct Subject {
  const Joint& joint;
  const Block& block;
  const std::vector<Block>& coordinates;
  std::vector<Sample> anywhere, on_constraint;
  std::size_t by_defaults = 0;  // so many of the poses on the constraint, the first, began with the spec's defaults
  Sample usual;                 // the spec's defaults, bodies side by side; with C = 0 if that is reached
};
Subject subject_of(const Derivation& derivation);

// A sample, with the values of another one for leaves that it lacks.
Sample completed(Sample sample, Sample other);

// The rows of J at a sample.
std::vector<std::vector<double>> jacobian_at(const Block& block, const Sample& sample);
double length(const std::vector<double>& row);

// The place of a coordinate in the spec.
Span place_of(const Block& coordinate, const Joint& joint);

void check_rows(const Subject& subject,
                Findings& findings);  // vanishing, dependent, without bodies
// 1/0, roots, directions, angles; with poses to draw if a place for them is given.
void check_undefined(const Subject& subject, Findings& findings, std::vector<PoseToDraw>* poses = nullptr);
void check_defaults(const Subject& subject, Findings& findings);  // defaults with C != 0
// The law of an effect: forces that are not opposite, and the power of what has no energy.
void check_law(const Derivation& derivation, const Proof& proof, Findings& findings);
// The poses of check_mass, if nothing but the laws was found wrong.
std::vector<PoseToDraw> poses_to_draw(const Derivation& derivation);
// Where K is singular, with poses to draw if a place for them is given. Silent if the joint has errors: they are the
// cause, and come first.
void check_mass(const Subject& subject, Findings& findings, std::vector<PoseToDraw>* poses = nullptr);

}  // namespace cdot::derive
