// The table of engines, and the header that a joint becomes for one of them.
#include "derive/engines/engines.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "derive/engines/texts.hpp"
#include "derive/kernel/emit.hpp"

namespace cdot::derive {
namespace {

const Adapter plain = {"PLAIN", adapter_plain}, rows = {"ROWS", adapter_rows};
const std::vector<std::string_view> in_rows = {"position", "jacobian", "effective_mass", "factor",
                                               "solve",    "velocity", "dense",          "time_derivative"};
const std::vector<std::string_view> in_impulses = {"position", "jacobian", "effective_mass", "factor",
                                                   "solve",    "velocity", "apply",          "time_derivative"};
const std::vector<std::string_view> in_accelerations = {"position", "jacobian", "velocity",
                                                        "dense",    "gamma",    "time_derivative"};

// clang-format off
const std::vector<Engine> table = {
    {"plain",  "no engine: impulses for a loop of your own, in any number type", "plain::Joint<T, BLOCKS>", "template <class T>\n", 0, 0, {plain}, {}},
    {"bullet", "Bullet 3: a btTypedConstraint",                                  "bullet::Constraint<BLOCKS>", "", 3, 2, {plain, rows, {"BULLET", adapter_bullet}}, in_rows},
    {"box2d",  "Box2D 2.4: a b2Joint",                                           "box2d::Joint<BLOCKS>", "", 2, 2, {plain, {"BOX2D", adapter_box2d}}, in_impulses},
    {"jolt",   "Jolt 5: a TwoBodyConstraint; built and compared with 5.5, not in every test run", "jolt::Constraint<BLOCKS>", "", 3, 2, {plain, {"JOLT", adapter_jolt}}, in_impulses},
    {"simbody", "Simbody 3: a Constraint::Custom, for joints without C >= 0",    "simbody::Constraint<BLOCKS>", "", 3, 0, {plain, {"SIMBODY", adapter_simbody}}, in_accelerations, false, false},
    {"dart",    "DART 6: a ConstraintBase",                                      "dart::Constraint<BLOCKS>", "", 3, 0, {plain, rows, {"DART", adapter_dart}}, in_rows},
    {"ode",     "ODE 0.16: a dJointID",                                          "ode::Joint<BLOCKS>", "", 3, 2, {plain, rows, {"ODE", adapter_ode}}, in_rows},
};
// clang-format on

constexpr std::string_view licence =
    "// SPDX-License-Identifier: MIT\n"
    "// Copyright (c) 2026 The Cdot authors. Keep these two lines.\n";

// The part of a text from `first` to just before `last`.
std::string_view part(std::string_view text, std::string_view first, std::string_view last) {
  const std::size_t from = text.find(first), to = text.find(last, from);
  if (from == std::string_view::npos || to == std::string_view::npos)
    throw std::logic_error(fmt::format("kernel.hpp has no part from \"{}\" to \"{}\"", first, last));
  return text.substr(from, to - from);
}

std::string replaced(std::string text, std::string_view what, std::string_view by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

// Every line that begins so goes; the others stay.
std::string without_lines(std::string_view text, std::span<const std::string_view> beginnings) {
  std::string rest;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n') + 1);
    text.remove_prefix(line.size());
    const bool goes = std::ranges::any_of(beginnings, [&](std::string_view b) { return line.starts_with(b); });
    if (!goes) rest += line;
  }
  return rest;
}

// The part of the contract that kernels need: the numbers of <limits> by a table of its own, since <cmath> is the only
// include.
std::string contract() {
  std::string numbers(part(contract_text, "inline float abs(float x)", "// The bounds of a bounded row"));
  numbers = replaced(std::move(numbers), "std::numeric_limits", "Limits");
  return fmt::format(
      "#include <cmath>\n\n"
      "namespace cdot {{\ninline namespace emitted {{\n\n{}}};\n\n"
      "// As <limits> has them.\n"
      "template <class T>\nstruct Limits;\n"
      "template <>\nstruct Limits<float> {{\n"
      "  static constexpr float min() {{ return 0x1p-126f; }}\n"
      "  static constexpr float epsilon() {{ return 0x1p-23f; }}\n}};\n"
      "template <>\nstruct Limits<double> {{\n"
      "  static constexpr double min() {{ return 0x1p-1022; }}\n"
      "  static constexpr double epsilon() {{ return 0x1p-52; }}\n}};\n\n"
      "{}{}}}  // namespace spatial\n\n}}  // namespace emitted\n}}  // namespace cdot\n",
      part(contract_text, "enum class RowKind", "};"), numbers,
      part(contract_text, "namespace planar {", "}  // namespace spatial"));
}

std::string guarded(std::string_view name, const std::string& text) {
  return fmt::format("#ifndef CDOT_EMITTED_{0}\n#define CDOT_EMITTED_{0}\n\n{1}\n#endif  // CDOT_EMITTED_{0}\n", name,
                     text);
}

std::string common_of(const Engine& engine) {
  constexpr std::string_view gone[] = {"#pragma once", "#include <cdot/", "#include \"runtime/"};
  std::string text = guarded("CONTRACT", contract());
  for (const Adapter& adapter : engine.adapters)
    text += '\n' + guarded(adapter.name, without_lines(adapter.text, gone));
  return text;
}

std::string command(const Engine& engine, const Joint& joint) {
  return fmt::format("`cdot emit {} --for {}`", joint.name, engine.name);
}

// The class by which a program makes the joint: its kernel, and a name for the drive of each coordinate.
std::string class_of(const Engine& engine, const Kernel& kernel) {
  const Joint& joint = kernel.derivation->joint;
  const std::string rows = fmt::format("{}::{}", name_of_space(joint), joint.name);
  std::string blocks = rows, drives;
  for (std::size_t i = 0; i < joint.coordinates.size(); ++i) {
    const Coordinate& c = joint.coordinates[i];
    blocks += fmt::format(", {}::{}::{}", name_of_space(joint), joint.name, c.name);
    if (!engine.drives) continue;
    drives += fmt::format("\n  // A motor and limits on {} [{}] = {}.\n  auto& {}() {{ return this->drives[{}]; }}\n",
                          c.name, derive::text(c.unit), c.text, c.name, i);
  }
  const std::string base = replaced(std::string(engine.base), "BLOCKS", blocks);
  const std::string name = base.substr(base.find("::") + 2, base.find('<') - base.find("::") - 2);
  return fmt::format(
      "namespace cdot::{} {{\n\n// {}\n{}class {}_joint : public {} {{\n public:\n  using {}::{};\n{}}};\n\n"
      "}}  // namespace cdot::{}\n",
      engine.name, joint.title, engine.parameters, joint.name, base, base, name, drives, engine.name);
}

std::string joint_of(const Engine& engine, const Kernel& kernel) {
  const std::string space = name_of_space(kernel.derivation->joint);
  return fmt::format(
      "namespace cdot {{\ninline namespace emitted {{\nnamespace {0} {{\n\n{1}\n}}  // namespace {0}\n"
      "}}  // namespace emitted\n}}  // namespace cdot\n\n{2}",
      space, emit_kernel_alone(kernel, engine.functions), class_of(engine, kernel));
}

// Why the engine cannot have the joint; empty if it can.
std::string objection(const Engine& engine, const Joint& joint) {
  if (joint.law)
    return "it is an effect, and adapters are for joints. Likely fix: use its formulas in a force of the engine";
  if (joint.rows.empty()) return "it has no rows. Likely fix: emit a joint that constrains something";
  if (engine.dimension != 0 && engine.dimension != joint.dimension)
    return fmt::format("it is {}, and the bodies of the engine are not. Likely fix: --for plain", name_of_space(joint));
  if (engine.most_bodies > 0 && int(joint.bodies.size()) > engine.most_bodies)
    return fmt::format("it joins {} bodies, and a constraint of the engine at most {}. Likely fix: --for plain",
                       joint.bodies.size(), engine.most_bodies);
  if (!engine.bounds && std::ranges::any_of(joint.rows, [](const Row& r) { return r.kind == RowKind::inequality; }))
    return "it has a row C >= 0, and the engine's constraints are equations. Likely fix: --for plain";
  return "";
}

void refuse_unfit(const Engine& engine, const Joint& joint) {
  const std::string why = objection(engine, joint);
  if (!why.empty()) throw CannotEmit(fmt::format("{} cannot be emitted for {}: {}", joint.name, engine.name, why));
}

}  // namespace

std::span<const Engine> engines() { return table; }

const Engine& engine_named(std::string_view name) {
  const auto found = std::ranges::find(table, name, &Engine::name);
  if (found == table.end()) throw std::out_of_range(std::string(name));
  return *found;
}

EmittedJoint emit_for(const Engine& engine, const Kernel& kernel) {
  const Joint& joint = kernel.derivation->joint;
  refuse_unfit(engine, joint);
  EmittedJoint made;
  made.common_name = fmt::format("cdot_{}.hpp", engine.name);
  made.common = fmt::format("// The part that all joints of Cdot share, for {}.\n{}#pragma once\n\n{}", engine.title,
                            licence, common_of(engine));
  made.joint =
      fmt::format("// The joint {} for {}. Emitted by {}.\n{}#pragma once\n\n#include \"{}\"\n\n{}", joint.name,
                  engine.title, command(engine, joint), licence, made.common_name, joint_of(engine, kernel));
  return made;
}

std::string single_header(const Engine& engine, const Kernel& kernel) {
  const Joint& joint = kernel.derivation->joint;
  refuse_unfit(engine, joint);
  return fmt::format("// The joint {} for {}. Emitted by {}.\n{}#pragma once\n\n{}\n{}", joint.name, engine.title,
                     command(engine, joint), licence, common_of(engine), joint_of(engine, kernel));
}

}  // namespace cdot::derive
