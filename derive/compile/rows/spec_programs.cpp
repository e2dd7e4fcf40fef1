#include "derive/compile/rows/spec_programs.hpp"

#include <algorithm>
#include <stdexcept>
#include <tuple>

#include "derive/kernel/factor.hpp"
#include "derive/kernel/plan.hpp"

namespace cdot::compile {
namespace {

constexpr std::string_view needed[] = {"position", "jacobian",        "effective_mass", "velocity", "apply",  "dense",
                                       "gamma",    "time_derivative", "energy",         "force",    "limits", "slopes"};

bool is_needed(const derive::KernelFunction& f, bool stiffness) {
  return std::ranges::find(needed, f.name) != std::end(needed) || (stiffness && f.name == "stiffness");
}

bool is_zero(const derive::Program& program) {
  return std::ranges::all_of(program.outputs, [&](const derive::Output& o) {
    const derive::Operation& op = program.at(o.op);
    return op.kind == derive::OpKind::number && op.value.is_zero();
  });
}

void keep_needed(derive::KernelBlock& block, bool stiffness) {
  std::erase_if(block.functions,
                [=](const derive::KernelFunction& f) { return f.isotropic || !is_needed(f, stiffness); });
  block.variants.clear();
}

RowPrograms rows_of(derive::KernelBlock& block) {
  RowPrograms rows;
  for (const derive::ScalarRow& row : block.block->rows) rows.names.push_back(row.name);
  for (const derive::Field& field : block.fields) rows.fields.push_back(field.name);
  for (derive::KernelFunction& f : block.functions) rows.functions[f.name] = std::move(f.program);
  rows.has_rates = rows.count() > 0 && !is_zero(rows.function("time_derivative"));
  return rows;
}

std::map<std::string, std::string> leaves_of_law(const derive::Joint& joint) {
  std::map<std::string, std::string> leaves;
  std::size_t row = 0;
  const auto name = [&](const derive::LawInput& input, const std::string& axis) {
    if (input.value) leaves[input.value->symbol + axis] = derive::element("C", row);
    leaves[input.rate->symbol + axis] = derive::element("rate", row++);
  };
  for (const derive::LawInput& input : joint.law->inputs) {
    if (!input.rate->vector) name(input, "");
    for (int k = 0; k < joint.dimension && input.rate->vector; ++k) name(input, std::string("_") + "xyz"[k]);
  }
  leaves[derive::bounded_value] = "C[0]";
  leaves[derive::bounded_rate] = "rate[0]";
  return leaves;
}

SpecPrograms derived(const derive::ReadResult& read, const std::set<std::string>& coordinates, bool stiffness) {
  if (!read.joint) throw std::runtime_error(render(*read.file, read.diagnostics));
  const derive::Derivation derivation = derive::derive(*read.joint);
  derive::Kernel kernel = derive::plan(derivation);
  keep_needed(kernel.rows, stiffness);
  const auto has_bounds = [&](const std::string& coordinate) {
    return std::ranges::any_of(kernel.bounded, [&](const auto& bound) { return bound.row->coordinate == coordinate; });
  };
  std::erase_if(kernel.coordinates,
                [&](const derive::KernelBlock& c) { return !coordinates.contains(c.name) && !has_bounds(c.name); });
  for (derive::KernelBlock& coordinate : kernel.coordinates) keep_needed(coordinate, stiffness);
  kernel.defaults.clear();
  kernel = derive::simplified(std::move(kernel));
  SpecPrograms programs;
  programs.bodies = derivation.joint.bodies;
  for (const derive::Parameter& parameter : derivation.joint.parameters)
    for (const std::string& field : derive::fields_of(derivation.joint, parameter))
      programs.parameters.push_back(parameter.kind == derive::ParameterKind::scalar ? field : "p." + field);
  programs.rows = rows_of(kernel.rows);
  for (derive::KernelBlock& coordinate : kernel.coordinates)
    programs.coordinates[coordinate.name] = rows_of(coordinate);
  if (derivation.joint.law) programs.leaves = leaves_of_law(derivation.joint);
  for (derive::KernelBound& bound : kernel.bounded) {
    programs.bounded.push_back(
        {bound.row->coordinate, bound.row->of_rate, std::move(bound.function.program), {}, {}, {}, {}});
    for (derive::KernelFunction& other : bound.others) {
      if (other.name == "by_load") programs.bounded.back().by_load = std::move(other.program);
      if (other.name == "after") programs.bounded.back().after = std::move(other.program);
      if (other.name == "breaks") programs.bounded.back().breaks = std::move(other.program);
      if (other.name == "until") programs.bounded.back().until = std::move(other.program);
    }
  }
  return programs;
}

}  // namespace

SpecPrograms programs_of(const derive::SpecsFolder& specs, const std::string& spec,
                         const std::set<std::string>& coordinates, bool stiffness) {
  static std::map<std::tuple<std::filesystem::path, std::set<std::string>, bool>, SpecPrograms> known;
  const std::tuple key(specs.find(spec), coordinates, stiffness);
  const auto found = known.find(key);
  return found != known.end()
             ? found->second
             : known.emplace(key, derived(specs.read(std::get<0>(key)), coordinates, stiffness)).first->second;
}

}  // namespace cdot::compile
