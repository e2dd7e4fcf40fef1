// Joints and effects that have no value, no direction or no pose: refused as they are added or changed.
#pragma once

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <string>
#include <vector>

#include "runtime/state/probe.hpp"

namespace cdot {

inline constexpr const char* why_it_jumps =
    "it jumps at the smallest motion of a body, as an angle does between axes that point in opposite directions. "
    "Turn one of the joint's frames round";

// Throws Error if a coordinate for an effect jumps here.
template <class S>
void check_value(const WorldData<S>& world, const JointRecord& record, int coordinate) {
  const JointType& type = joint_types(S::dimension)[record.type];
  Probe<S> probe(world);
  probe.look_at(record, coordinate);
  if (probe.jumping_row() >= 0)
    throw Error(fmt::format("coordinate `{}` of joint `{}` has no value here: {}", type.coordinates[coordinate].name,
                            type.name, why_it_jumps));
}

// " (l = -1, ratio = 0)": the scalars among a joint's parameters.
inline std::string scalars_of(const JointType& type, const std::vector<double>& numbers) {
  std::string text;
  for (const ParameterInfo& info : type.parameters)
    if (info.kind == ParameterKind::scalar)
      text += fmt::format("{}{} = {:.6g}", text.empty() ? "" : ", ", info.name, numbers[info.offset]);
  return text.empty() ? text : " (" + text + ")";
}

// Throws Error if a row has no value here, or if no pose satisfies it. Rows of effects are no constraints.
template <class S>
void check_values(Probe<S>& probe, const JointType& type, const JointRecord& record) {
  for (const ParameterInfo& info : type.parameters)
    if (info.kind == ParameterKind::scalar && probe.jumps_at_zero(info.offset))
      throw Error(fmt::format("joint `{}` has no meaning at {} = 0, by which it divides. Likely fix: {} = 1", type.name,
                              info.name, info.name));
  for (int r = 0; r < probe.rows() && !type.is_effect; ++r) {
    const double C = probe.C(r);
    const bool one_sided = type.row_kinds[r] == RowKind::inequality;
    if (type.row_kinds[r] == RowKind::velocity || std::abs(C) <= 1e-4 || (one_sided && C > 0)) continue;
    if (!probe.can_be_satisfied(r, one_sided))
      throw Error(
          fmt::format("row {} of joint `{}` can hold at no pose: C is {:.3g} here. Likely fix: the sign of a "
                      "length among its parameters{}",
                      r + 1, type.name, C, scalars_of(type, record.parameters)));
    probe.look_at(record);
  }
}

// Throws Error if a bounded row has a bound without a value, or its lower bound above its upper one.
template <class S>
void check_bounds(const WorldData<S>& world, const JointRecord& record) {
  const JointType& type = joint_types(S::dimension)[record.type];
  Probe<S> probe(world);
  const std::vector<typename S::Scalar> numbers(record.parameters.begin(), record.parameters.end());
  for (const BoundedEntry<S>& row : joint_entries<S>()[record.type].bounded) {
    check_value(world, record, row.coordinate);
    probe.look_at(record, row.coordinate);
    RowBounds<typename S::Scalar> B;
    row.bounds(typename S::Scalar(probe.C(0)), numbers.data(), typename S::Scalar(world.time), B);
    if (!(B.lower <= B.upper) || !std::isfinite(B.rate))
      throw Error(
          fmt::format("row `{}` of effect `{}` has bounds from {:.6g} to {:.6g}: the lower one must not lie "
                      "above the upper one{}",
                      row.name, type.name, double(B.lower), double(B.upper), scalars_of(type, record.parameters)));
  }
}

inline Error effect_without_value(const JointType& type, const std::vector<double>& numbers) {
  return Error(
      fmt::format("effect `{}` has no finite force and energy here{}. Likely fix: the sign of a parameter, or "
                  "another place at the start",
                  type.name, scalars_of(type, numbers)));
}

// True if the rows of an effect, or of a coordinate, pull only at what cannot move: J M^-1 J' = 0 though J is not.
template <class S>
bool moves_nothing(const WorldData<S>& world, const JointRecord& record, int coordinate) {
  Probe<S> probe(world);
  probe.look_at(record, coordinate);
  std::vector<ExactNumber<typename S::Scalar>> J(static_cast<size_t>(probe.rows()) * S::freedom * record.bodies.size()),
      weighted(J.size());
  probe.dense(J.data(), weighted.data());
  const auto is_zero = [](const auto& number) { return number == 0; };
  return std::ranges::all_of(weighted, is_zero) && !std::ranges::all_of(J, is_zero);
}

// Throws Error if the law of an effect has no value here, or pushes where its coordinate has a kink, as a spring
// between points that meet. A force there has no direction. One that moves its coordinate by a nanometre in a second
// counts as none: a slack cord pulls by less.
template <class S>
void check_law(Probe<S>& probe, const Law<S>& law, const JointType& type, const JointRecord& record) {
  if (!probe.has_value(law)) throw effect_without_value(type, record.parameters);
  const auto force = probe.forces(law);
  for (int r = 0; r < probe.rows(); ++r) {
    if (type.row_kinds[r] == RowKind::velocity) continue;
    probe.look_at(record);
    if (std::abs(force[r] * probe.mobility(r)) <= 1e-9 || !probe.at_kink(r)) continue;
    throw Error(
        fmt::format("effect `{}` pushes by {:.3g} where its row {} has no direction, as a length between points that "
                    "meet{}. Likely fix: move one of its points",
                    type.name, std::abs(force[r]), r + 1, scalars_of(type, record.parameters)));
  }
}

// Throws Error if a row has no direction here. A row that holds asks for none but at C = 0, a spring elsewhere.
template <class S>
void check_direction(Probe<S>& probe, int row, bool soft, const JointType& type, const JointRecord& record) {
  const double C = probe.C(row);
  if ((std::abs(C) <= 1e-9) == soft || !probe.at_kink(row)) return;
  if (soft)
    throw Error(fmt::format(
        "a spring {:.3g} away from its rest has no direction where its points meet{}. Likely fix: a rest of 0, "
        "or move one of its points",
        std::abs(C), scalars_of(type, record.parameters)));
  throw Error(
      fmt::format("row {} of joint `{}` has no direction here: C = 0 at its kink, as a distance of length 0. Hold "
                  "the points together with a `{}`",
                  row + 1, type.name, S::dimension == Dimension::planar ? "revolute" : "spherical"));
}

// Throws Error if a row has no value here, jumps here, has no direction here, or holds nowhere. Velocity rows have no
// C.
template <class S>
void check_rows(const WorldData<S>& world, const JointRecord& record, bool soft) {
  const JointType& type = joint_types(S::dimension)[record.type];
  Probe<S> probe(world);
  probe.look_at(record);
  check_values(probe, type, record);
  check_bounds(world, record);
  probe.look_at(record);
  const Law<S>* law = joint_entries<S>()[record.type].law;
  if (law) check_law(probe, *law, type, record);
  if (const int row = probe.jumping_row(); row >= 0)
    throw Error(fmt::format("row {} of joint `{}` has no value here: {}", row + 1, type.name, why_it_jumps));
  if (law) return;
  for (size_t r = 0; r < type.row_kinds.size(); ++r) {
    if (type.row_kinds[r] == RowKind::velocity) continue;
    probe.look_at(record);
    check_direction(probe, static_cast<int>(r), soft, type, record);
  }
}

}  // namespace cdot
