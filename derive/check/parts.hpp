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
};
Subject subject_of(const Derivation& derivation);

// The rows of J at a sample.
std::vector<std::vector<double>> jacobian_at(const Block& block, const Sample& sample);

// The place of a coordinate in the spec.
Span place_of(const Block& coordinate, const Joint& joint);

void check_rows(const Subject& subject,
                Findings& findings);                               // vanishing, dependent, without bodies
void check_undefined(const Subject& subject, Findings& findings);  // 1/0, roots, directions, angles
void check_defaults(const Subject& subject, Findings& findings);   // defaults with C != 0
void check_mass(const Subject& subject, Findings& findings);       // where K is singular

}  // namespace cdot::derive
