#include "derive/compile/rows/row_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "derive/compile/rows/laws.hpp"
#include "derive/interpret/program_in_time.hpp"
#include "derive/kernel/factor.hpp"
#include "derive/program/print.hpp"

namespace cdot::compile {

using derive::element;

std::string constant_name(const RowBlock& block, const std::string& parameter) {
  return block.owner + "_" + (parameter.starts_with("p.") ? parameter.substr(2) : parameter);
}

std::string number_name(const RowBlock& block, const std::string& parameter) {
  return block.name + "_" + (parameter.starts_with("p.") ? parameter.substr(2) : parameter);
}

RowBlocks::RowBlocks(const Mechanism& mechanism, const Names& names, const derive::SpecsFolder& specs)
    : mechanism_(mechanism), names_(names) {
  note_coordinate_laws(specs);
  std::map<std::string, std::set<std::string>> coordinates;
  for (const Joint& joint : mechanism.joints) {
    std::set<std::string>& of_type = coordinates[joint.type];
    if (!joint.coordinate.empty()) of_type.insert(joint.coordinate);
    of_type.insert(joint.coordinates.begin(), joint.coordinates.end());
    for (const CountedTurns& turns : joint.turns) of_type.insert(turns.coordinate);
  }
  for (const std::vector<Effect>* list : {&mechanism.effects, &mechanism.bounded})
    for (const Effect& effect : *list) {
      std::set<std::string>& of_type = coordinates[effect.type];
      if (!effect.coordinate.empty()) of_type.insert(effect.coordinate);
      for (const CountedTurns& turns : effect.turns) of_type.insert(turns.coordinate);
      if (!effect.law_type.empty()) coordinates[law_of(effect)];
    }
  for (const Bond& bond : mechanism.bonds) coordinates[bond_of(bond)];
  const std::string folder = mechanism.spatial() ? "spatial/" : "planar/";
  for (const auto& [type, of_type] : coordinates) {
    const auto own = mechanism.own_specs.find(type.substr(type.find('/') + 1));
    const bool in_folder = type.find('/') == std::string::npos;
    types_[type] = programs_of(specs,
                               own != mechanism.own_specs.end() ? own->second
                               : in_folder                      ? folder + type
                                                                : type,
                               of_type, mechanism.method == Method::implicit);
  }
  for (std::size_t j = 0; j < mechanism.joints.size(); ++j) add_joint(mechanism.joints[j], names.joints[j]);
  for (std::size_t e = 0; e < mechanism.effects.size(); ++e)
    effects_.push_back(block_of(names.effects[e], mechanism.effects[e]));
  for (std::size_t b = 0; b < mechanism.bounded.size(); ++b)
    bounded_.push_back(block_of(names.bounded[b], mechanism.bounded[b]));
}

void RowBlocks::add_joint(const Joint& joint, const std::string& name) {
  const SpecPrograms& spec = types_.at(joint.type);
  joints_.push_back({name, name, &spec, &spec.rows, &joint.bodies, &joint.parameters});
  RowBlock& block = joints_.back();
  block.joint = &joint, block.holds = joint.holds, block.turns = &joint.turns;
  if (!joint.in_time.empty()) block.in_time = &joint.in_time;
  check_time(block, joint.name);
  if (joint.coordinate.empty()) return;
  block.owner = owner_of(name, joint.name);
  block.in_time = functions_of(joint.name);
  block.rows = &spec.coordinates.at(joint.coordinate);
  block.motor = &joint;
}

const SpecPrograms& RowBlocks::law(const Effect& effect) const { return types_.at(law_of(effect)); }

void RowBlocks::note_coordinate_laws(const derive::SpecsFolder& specs) {
  for (const std::filesystem::path& spec : specs.all())
    if (spec.parent_path().filename() == "coordinate") coordinate_laws_.insert(spec.stem().string());
}

// Laws of effects on a coordinate stand with those of any coordinate, or in the plane for both.
std::string RowBlocks::law_of(const Effect& effect) const {
  if (!effect.coordinate.empty() && coordinate_laws_.contains(effect.law_type)) return "coordinate/" + effect.law_type;
  return (mechanism_.spatial() && !effect.coordinate.empty() ? "planar/" : "") + effect.law_type;
}

const RowBlock& RowBlocks::block_of(const Bond& bond) const {
  if (bond.joint >= 0) return joints_[static_cast<std::size_t>(bond.joint)];
  if (bond.effect >= 0) return effects_[static_cast<std::size_t>(bond.effect)];
  return bounded_[static_cast<std::size_t>(bond.bounded)];
}

std::string RowBlocks::bond_of(const Bond& bond) const {
  return (coordinate_laws_.contains(bond.type) ? "coordinate/" : "") + bond.type;
}

const std::map<std::size_t, InTime>* RowBlocks::functions_of(const std::string& effect) const {
  const auto owns = [&](const Joint& joint) { return effect.starts_with(joint.name + ".") && !joint.in_time.empty(); };
  const auto joint = std::ranges::find_if(mechanism_.joints, owns);
  return joint == mechanism_.joints.end() ? nullptr : &joint->in_time;
}

// A derivative by the time at fixed parameters would count twice.
void RowBlocks::check_time(const RowBlock& block, const std::string& name) {
  if (block.in_time && derive::inputs_read(block.rows->function("position"), {}).contains("time"))
    throw std::runtime_error(
        fmt::format("{}: cdot compile knows no joint that reads the time and has numbers that "
                    "follow functions of it. Fix: leave it to cdot-run",
                    name));
}

std::string RowBlocks::owner_of(const std::string& name, const std::string& effect) const {
  const auto owns = [&](const Joint& joint) { return effect.starts_with(joint.name + "."); };
  const auto joint = std::ranges::find_if(mechanism_.joints, owns);
  if (joint == mechanism_.joints.end()) return name;
  return names_.joints[static_cast<std::size_t>(joint - mechanism_.joints.begin())];
}

// A row with bounds of an effect between bodies is on a coordinate of that effect.
RowBlock RowBlocks::block_of(const std::string& name, const Effect& effect) const {
  const SpecPrograms& spec = types_.at(effect.type);
  const bool own = effect.coordinate.empty() && effect.law == Effect::bound;
  const std::string& coordinate = own ? spec.bounded[effect.row].coordinate : effect.coordinate;
  RowBlock block{name,           effect.coordinate.empty() ? name : owner_of(name, effect.name),
                 &spec,          coordinate.empty() ? &spec.rows : &spec.coordinates.at(coordinate),
                 &effect.bodies, &effect.parameters};
  block.holds = effect.holds, block.turns = &effect.turns;
  if (!effect.coordinate.empty()) block.in_time = functions_of(effect.name);
  else if (move_in_time(effect, block)) block.in_time = &effect.in_time;
  if (!effect.parameters_in_time.empty()) block.in_time = &effect.parameters_in_time;
  check_time(block, effect.name);
  return block;
}

// True if C of an effect between bodies reads numbers that follow functions of time, as a place.
bool RowBlocks::move_in_time(const Effect& effect, const RowBlock& block) {
  const std::set<std::string> read = derive::inputs_read(block.rows->function("position"), {});
  return std::ranges::any_of(effect.in_time,
                             [&](const auto& one) { return read.contains(block.spec->parameters[one.first]); });
}

int RowBlocks::number(Algebra& algebra, const Effect& effect, std::size_t k, const std::string& name) const {
  const auto function = effect.in_time.find(k);
  if (function != effect.in_time.end()) return in_time(algebra, function->second, "value", name);
  return algebra.value(std::clamp(effect.numbers[k], -boundless, boundless), name);
}

int RowBlocks::in_time(Algebra& algebra, const InTime& function, const std::string& derivative,
                       const std::string& name) const {
  if (function.table >= 0) return algebra.input(fmt::format("table_{}(time).{}", function.table, derivative));
  const Program written = program_in_time(function.text, function.unit).program;
  const auto input = [&](const std::string& text) {
    return text == "time" ? algebra.input("time") : algebra.value(std::numbers::pi);
  };
  return algebra.inlined(written, input, name).at(derivative);
}

int RowBlocks::speed(Algebra& algebra, const RowBlock& block) const {
  const Joint& motor = *block.motor;
  const std::string name = block.name + "_speed";
  return motor.speed_in_time ? in_time(algebra, *motor.speed_in_time, "value", name) : algebra.value(motor.speed, name);
}

int RowBlocks::speed_rate(Algebra& algebra, const RowBlock& block) const {
  const Joint& motor = *block.motor;
  return motor.speed_in_time ? in_time(algebra, *motor.speed_in_time, "rate", block.name + "_speed") : algebra.value(0);
}

// A number of a vector without the round-off by which the scene's poses came to the body's axes.
double RowBlocks::rounded(const RowBlock& block, std::size_t p) {
  constexpr double slight = 8 * std::numeric_limits<double>::epsilon(), unit = 1.0 / 64;
  const auto stem = [&](std::size_t k) {
    const std::string& field = block.spec->parameters[k];
    return field.substr(0, field.rfind('_'));
  };
  const double number = (*block.parameters)[p], near = unit * std::round(number / unit);
  double most = 0;
  for (std::size_t k = 0; k < block.spec->parameters.size(); ++k)
    if (block.spec->parameters[k].starts_with("p.") && stem(k) == stem(p))
      most = std::max(most, std::abs((*block.parameters)[k]));
  return std::abs(number - near) <= slight * most ? near : number;
}

Values RowBlocks::inputs(Algebra& algebra, const RowBlock& block) const {
  Values in;
  const SpecPrograms& spec = *block.spec;
  for (std::size_t k = 0; k < spec.bodies.size(); ++k) add_body(algebra, in, spec.bodies[k], (*block.bodies)[k]);
  for (std::size_t p = 0; p < spec.parameters.size(); ++p) {
    const std::string& field = spec.parameters[p];
    const std::string name = constant_name(block, field);
    const bool follows = block.in_time && block.in_time->contains(p);
    in[field] =
        follows ? in_time(algebra, block.in_time->at(p), "value", name) : algebra.shared(rounded(block, p), name);
  }
  in["pi"] = algebra.value(3.14159265358979323846);
  in["time"] = algebra.input("time");
  if (block.turns)
    for (const CountedTurns& turns : *block.turns)
      in[spec.parameters[turns.parameter]] = counted(algebra, block, turns, in).turns;
  if (block.holds >= 0) in["holds"] = algebra.input(element("bonds.holds", static_cast<std::size_t>(block.holds)));
  return in;
}

Unwound RowBlocks::counted(Algebra& algebra, const RowBlock& block, const CountedTurns& turns, const Values& in) const {
  const RowPrograms& rows = block.spec->coordinates.at(turns.coordinate);
  const Values C = algebra.inlined(
      rows.function("position"), [&](const std::string& text) { return in.at(text); }, block.name);
  return unwound(algebra, turns.angle, C.at("C[0]"));
}

Values RowBlocks::inputs_with_jacobian(Algebra& algebra, const RowBlock& block) const {
  Values in = inputs(algebra, block);
  for (const auto& [name, op] : call(algebra, block, "jacobian", in))
    if (name.starts_with("J.")) in[name] = op;
  return in;
}

Values RowBlocks::call(Algebra& algebra, const RowBlock& block, const std::string& function, const Values& in) const {
  Values out = call_held(algebra, block, function, in);
  if (block.holds < 0 || function == "jacobian") return out;
  const int holds = in.at("holds"), broken = algebra.sum({{algebra.value(1), holds}, {1, -1}});
  for (auto& [name, op] : out) op = algebra.times(holds, op);
  for (std::size_t r = 0; function == "effective_mass" && r < block.rows->count(); ++r) {
    int& own = out.at(derive::triangle_element("K", r, r));
    own = algebra.sum({{own, broken}, {1, 1}});
  }
  return out;
}

Values RowBlocks::call_held(Algebra& algebra, const RowBlock& block, const std::string& function,
                            const Values& in) const {
  if (block.in_time && (function == "time_derivative" || function == "gamma"))
    return call_in_time(algebra, block, function, in);
  return algebra.inlined(
      block.rows->function(function), [&](const std::string& text) { return in.at(text); }, block.name);
}

// dC/dt = C_t, gamma = gamma at fixed parameters - 2 d(J v)/dt - C_tt, with derivatives at fixed poses and velocities.
Values RowBlocks::call_in_time(Algebra& algebra, const RowBlock& block, const std::string& function, Values in) const {
  const Values C = call_held(algebra, block, "position", in);
  const bool first = function == "time_derivative";
  Values out, Jv;
  if (!first) {
    out = algebra.inlined(
        block.rows->function(function), [&](const std::string& text) { return in.at(text); }, block.name);
    for (const auto& [name, op] : call(algebra, block, "jacobian", in)) in[name] = op;
    Jv = call_held(algebra, block, "velocity", in);
  }
  for (std::size_t r = 0; r < block.rows->count(); ++r) {
    const int C_t = algebra.by_time(C.at(element("C", r)));
    if (first) out[element("C_t", r)] = C_t;
    else
      out[element("g", r)] = algebra.sum(
          {{out.at(element("g", r)), algebra.by_time(Jv.at(element("Jv", r))), algebra.by_time(C_t)}, {1, -2, -1}});
  }
  return out;
}

// With masses of 1 and bodies at rest, the velocities after the impulses are the forces.
void RowBlocks::add_forces(Algebra& algebra, const RowBlock& block, Values in, const std::vector<int>& lambda,
                           Forces& forces) const {
  for (const std::string& L : block.spec->bodies) {
    in["inv_m_" + L] = algebra.value(1);
    if (!mechanism_.spatial()) in["inv_I_" + L] = algebra.value(1);
    else
      for (const std::string_view entry : {"xx", "yy", "zz", "xy", "xz", "yz"})
        in[fmt::format("inv_I_{}_{}", L, entry)] = algebra.value(entry[0] == entry[1] ? 1 : 0);
    each_speed(L, [&](const std::string& input, std::size_t) { in[input] = algebra.value(0); });
  }
  for (std::size_t r = 0; r < lambda.size(); ++r) in[fmt::format("lambda_{}", r + 1)] = lambda[r];
  const Values v = call(algebra, block, "apply", in);
  for (std::size_t k = 0; k < block.spec->bodies.size(); ++k)
    for (std::size_t c = 0; c < mechanism_.columns(); ++c)
      if (const auto found = v.find(element("v", k) + "." + mechanism_.column(c)); found != v.end())
        forces[{(*block.bodies)[k], c}].add(1, found->second);
}

}  // namespace cdot::compile
