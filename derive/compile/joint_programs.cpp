#include "derive/compile/joint_programs.hpp"

#include <algorithm>
#include <stdexcept>

#include "derive/kernel/plan.hpp"

namespace cdot::compile {
namespace {

constexpr std::string_view needed[] = {"position", "jacobian", "effective_mass", "velocity",
                                       "apply",    "dense",    "gamma",          "time_derivative"};

bool is_needed(const derive::KernelFunction& f) { return std::ranges::find(needed, f.name) != std::end(needed); }

bool is_zero(const derive::Program& program) {
  return std::ranges::all_of(program.outputs, [&](const derive::Output& o) {
    const derive::Operation& op = program.at(o.op);
    return op.kind == derive::OpKind::number && op.value.is_zero();
  });
}

}  // namespace

JointPrograms programs_of(const derive::SpecsFolder& specs, const std::string& joint) {
  const derive::ReadResult read = specs.read(specs.find("planar/" + joint));
  if (!read.joint) throw std::runtime_error(render(*read.file, read.diagnostics));
  const derive::Derivation derivation = derive::derive(*read.joint);
  derive::Kernel kernel = derive::plan(derivation);
  std::erase_if(kernel.rows.functions, [](const derive::KernelFunction& f) { return !is_needed(f); });
  kernel.rows.variants.clear();
  kernel.coordinates.clear();
  kernel.defaults.clear();
  kernel = derive::simplified(std::move(kernel));
  JointPrograms programs;
  programs.bodies = derivation.joint.bodies;
  for (const derive::Parameter& parameter : derivation.joint.parameters)
    for (const std::string& field : derive::fields_of(derivation.joint, parameter))
      programs.parameters.push_back(parameter.kind == derive::ParameterKind::scalar ? field : "p." + field);
  for (const derive::ScalarRow& row : derivation.rows.rows) programs.row_names.push_back(row.name);
  for (const derive::Field& field : kernel.rows.fields) programs.fields.push_back(field.name);
  for (derive::KernelFunction& f : kernel.rows.functions) programs.functions[f.name] = std::move(f.program);
  programs.has_rates = !is_zero(programs.function("time_derivative"));
  return programs;
}

}  // namespace cdot::compile
