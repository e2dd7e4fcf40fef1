// A spec -> its derivation -> its kernel as programs -> tapes whose inputs and outputs are numbers of arrays.
#include "derive/own/own_kernel.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>

#include "derive/derivation/derivation.hpp"
#include "derive/interpret/tape.hpp"
#include "derive/kernel/emit_parameters.hpp"
#include "derive/kernel/plan.hpp"
#include "derive/language/specs_folder.hpp"

namespace cdot {
namespace {

using namespace derive;
using Argument = OwnFunction::Argument;

// In the order of OwnFunctionName.
constexpr std::array<const char*, own_functions> names_of_functions = {
    "position", "jacobian", "effective_mass",        "factor", "solve",           "velocity",
    "apply",    "dense",    "inverse_mass_jacobian", "gamma",  "time_derivative", "stiffness"};

// The members of Pose, Velocity and InverseMass, in their order.
struct Members {
  std::vector<std::string> pose, velocity, mass;
};
const Members& members(int dimension) {
  static const Members planar = {{"x", "y", "c", "s", "angle"}, {"x", "y", "w"}, {"m", "I"}};
  static const Members spatial = {
      {"x", "y", "z", "e0", "e1", "e2", "e3", "xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"},
      {"x", "y", "z", "wx", "wy", "wz"},
      {"m", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz"}};
  return dimension == 2 ? planar : spatial;
}

const std::vector<std::string> members_of_bounds = {"lower", "upper", "rate", "acceleration"};  // of RowBounds

int index_in(const std::vector<std::string>& list, const std::string& name) {
  return static_cast<int>(std::ranges::find(list, name) - list.begin());
}

// "K[3]" -> 3, "D[1][4]" with rows of `columns` numbers -> columns + 4
int element_of(const std::string& text, int columns) {
  const std::size_t first = text.find('['), second = text.find('[', first + 1);
  const int i = std::stoi(text.substr(first + 1));
  return second == text.npos ? i : i * columns + std::stoi(text.substr(second + 1));
}

// The names of a joint's programs as places in the arguments of the contract.
class Places {
 public:
  explicit Places(const Joint& joint) : joint_(joint), members_(members(joint.dimension)) {
    for (std::size_t b = 0; b < joint.bodies.size(); ++b) add_body(joint.bodies[b], static_cast<int>(b));
    int at = 0;
    for (const Parameter& parameter : joint.parameters)
      for (const std::string& field : fields_of(joint, parameter)) {
        offsets_["p." + field] = at;
        if (parameter.kind == derive::ParameterKind::scalar) inputs_[parameter.name] = {Argument::parameters, at};
        inputs_["p." + field] = {Argument::parameters, at++};
      }
    inputs_["time"] = {Argument::time, 0};
    if (joint.law) add_law();
  }

  OwnFunction of(const Program& program, const std::vector<Field>& fields, int columns) const {
    const NamedTape named(program);
    OwnFunction function;
    function.tape = named.tape();
    for (const std::string& input : named.inputs()) function.inputs.push_back(input_of(input, fields));
    for (const std::string& output : named.outputs()) function.outputs.push_back(output_of(output, fields, columns));
    return function;
  }

 private:
  void add_law() {
    int row = 0;
    const auto add = [&](const LawInput& input, const std::string& axis) {
      if (input.value) inputs_[input.value->symbol + axis] = {Argument::C, row};
      inputs_[input.rate->symbol + axis] = {Argument::rate, row++};
    };
    for (const LawInput& input : joint_.law->inputs) {
      if (!input.rate->vector) add(input, "");
      for (int k = 0; k < joint_.dimension && input.rate->vector; ++k) add(input, std::string("_") + "xyz"[k]);
    }
    if (joint_.law->mass) inputs_[joint_.law->mass->symbol] = {Argument::effective_mass, 0};
    inputs_[bounded_value] = {Argument::C, 0};
    inputs_[bounded_rate] = {Argument::rate, 0};
    inputs_[bounded_load] = {Argument::load, 0};
  }

  void add_body(const std::string& body, int b) {
    const auto add = [&](const std::string& name, Argument of, const std::vector<std::string>& list,
                         const std::string& member) {
      inputs_[name] = {of, b * static_cast<int>(list.size()) + index_in(list, member)};
    };
    const auto& [pose, velocity, mass] = members_;
    for (const std::string& member : pose) add(body + "." + member, Argument::pose, pose, member);
    for (int k = 0; k < joint_.dimension; ++k) {
      const std::string axis(1, "xyz"[k]);
      add("x_" + body + "_" + axis, Argument::pose, pose, axis);
      add("v_" + body + "_" + axis, Argument::velocity, velocity, axis);
      if (joint_.dimension == 3) add("w_" + body + "_" + axis, Argument::velocity, velocity, "w" + axis);
    }
    add("inv_m_" + body, Argument::mass, mass, "m");
    if (joint_.dimension == 2) {
      add("theta_" + body, Argument::pose, pose, "angle");
      add("w_" + body, Argument::velocity, velocity, "w");
      add("inv_I_" + body, Argument::mass, mass, "I");
    }
    for (const char* component : {"xx", "yy", "zz", "xy", "xz", "yz"})
      if (joint_.dimension == 3)
        add("inv_I_" + body + "_" + component, Argument::mass, mass, std::string("I") + component);
  }

  static int field_of(const std::string& name, const std::vector<Field>& fields) {
    const auto field = std::ranges::find(fields, name.substr(2), &Field::name);
    return static_cast<int>(field - fields.begin());
  }

  OwnFunction::Input input_of(const std::string& name, const std::vector<Field>& fields) const {
    if (const auto known = inputs_.find(name); known != inputs_.end()) return known->second;
    if (name.starts_with("J.")) return {Argument::jacobian, field_of(name, fields)};
    if (name.starts_with("lambda_")) return {Argument::numbers, std::stoi(name.substr(7)) - 1};
    if (name.starts_with("K[") || name.starts_with("F[")) return {Argument::matrix, element_of(name, 0)};
    if (name.starts_with("rhs[")) return {Argument::numbers, element_of(name, 0)};
    throw std::logic_error("no place for the input " + name);
  }

  OwnFunction::Output output_of(const std::string& name, const std::vector<Field>& fields, int columns) const {
    if (name.starts_with("J.")) return {true, field_of(name, fields)};
    if (name.starts_with("p.")) return {false, offsets_.at(name)};
    if (name.starts_with("B.")) return {false, index_in(members_of_bounds, name.substr(2))};
    if (name == "E" || name == "D") return {false, 0};
    if (name.starts_with("d[") || name.starts_with("upper[")) return {true, element_of(name, columns)};
    const std::size_t dot = name.find('.');
    if (dot == name.npos) return {false, element_of(name, columns)};
    const auto& velocity = members_.velocity;  // "v[1].wx"
    return {false, element_of(name, 0) * static_cast<int>(velocity.size()) + index_in(velocity, name.substr(dot + 1))};
  }

  const Joint& joint_;
  const Members& members_;
  std::map<std::string, OwnFunction::Input> inputs_;
  std::map<std::string, int> offsets_;
};

// A variant takes what it inherits from `base`.
OwnBlock block_of(const KernelBlock& kernel, const Joint& joint, const Places& places, const OwnBlock& base = {}) {
  OwnBlock block;
  block.functions = base.functions;
  block.name = kernel.name, block.immovable = kernel.block->immovable;
  for (const ScalarRow& row : kernel.block->rows) {
    block.row_names.push_back(row.name);
    block.row_kinds.push_back(static_cast<int>(row.kind));
  }
  block.explicit_time = depends_on_time(*kernel.block);
  block.jacobian_size = static_cast<int>(kernel.fields.size());
  const auto columns = static_cast<int>(columns_per_body(joint.dimension) * joint.bodies.size());
  for (const KernelFunction& f : kernel.functions) {
    const auto name = std::ranges::find(names_of_functions, f.name);
    if (f.isotropic || name == names_of_functions.end()) continue;
    block.functions[static_cast<std::size_t>(name - names_of_functions.begin())] =
        places.of(f.program, kernel.fields, columns);
  }
  return block;
}

// The function of that name; without outputs if there is none.
OwnFunction function_named(const std::string& name, const std::vector<KernelFunction>& functions, const Places& places,
                           int columns) {
  const auto f = std::ranges::find(functions, name, &KernelFunction::name);
  return f == functions.end() ? OwnFunction{} : places.of(f->program, {}, columns);
}

OwnLaw law_of(const Kernel& kernel, const DerivedLaw& law, const Places& places) {
  const auto rows = static_cast<int>(law.force.size());
  const auto function = [&](const char* name) { return function_named(name, kernel.rows.functions, places, rows); };
  return {acts_of(law),         depends_on_time(law), function("energy"), function("force"),
          function("unstored"), function("slopes"),   function("limits")};
}

OwnBound bound_of(const KernelBound& bound, const Places& places) {
  const auto other = [&](const char* name) { return function_named(name, bound.others, places, 0); };
  return {bound.row->name,     bound.coordinate,     bound.row->of_rate,
          bound.in_time,       bound.of_value,       bound.row->load_of,
          bound.row->cone_row, bound.row->cone_rows, places.of(bound.function.program, {}, 0),
          other("by_load"),    other("after"),       other(bound.row->coordinate == "joint" ? "breaks" : "until")};
}

void add_effect(const Kernel& kernel, const Places& places, OwnKernel& own) {
  const Joint& joint = kernel.derivation->joint;
  const std::optional<DerivedLaw>& law = kernel.derivation->law;
  own.is_effect = true;
  if (joint.on_any_coordinate()) own.dimension = 0;
  if (law) own.law = law_of(kernel, *law, places);
  for (const KernelBound& bound : kernel.bounded) own.bounded.push_back(bound_of(bound, places));
  const std::optional<OnCoordinate> on = on_coordinate(joint);
  if (!on) return;
  const SlopesOfLaw slopes = law ? slopes_of(joint, *law) : SlopesOfLaw{};
  own.on_coordinate = {on->unit,
                       {on->uses.begin(), on->uses.end()},
                       static_cast<bool>(joint.law->mass),
                       slopes.linear && joint.on_any_coordinate(),
                       slopes.vanish};
}

std::vector<OwnParameter> parameters_of(const Kernel& kernel, const Places& places) {
  const Joint& joint = kernel.derivation->joint;
  std::vector<OwnParameter> parameters;
  int offset = 0;
  for (const Parameter& p : joint.parameters) {
    const auto size = static_cast<int>(fields_of(joint, p).size());
    parameters.push_back({p.name,
                          text(p.unit),
                          static_cast<int>(p.kind),
                          p.body,
                          offset,
                          size,
                          static_cast<bool>(p.default_value),
                          p.above,
                          p.below,
                          p.from,
                          may_be_unlimited(p),
                          {}});
    offset += size;
  }
  for (const DefaultValue& d : kernel.defaults)
    parameters[static_cast<std::size_t>(d.parameter)].by_default = places.of(d.program, {}, 0);
  return parameters;
}

// The runtime counts turns in space; in the plane angles have no end.
std::vector<OwnTurns> turns_of(const OwnKernel& kernel) {
  std::vector<OwnTurns> turns;
  if (kernel.dimension != 3) return turns;
  for (const OwnBlock& coordinate : kernel.coordinates)
    for (const OwnParameter& p : kernel.parameters)
      if (p.unit == "rad" && p.name == coordinate.name + "_turns")
        turns.push_back({p.offset, coordinate[OwnFunctionName::position]});
  return turns;
}

void add_turns(OwnKernel& kernel) {
  const std::vector<OwnTurns> turns = turns_of(kernel);
  kernel.rows.turns = turns;
  for (OwnBlock& variant : kernel.variants) variant.turns = turns;
  for (OwnBlock& coordinate : kernel.coordinates) coordinate.turns = turns;
}

OwnKernel tapes_of(const Kernel& kernel) {
  const Joint& joint = kernel.derivation->joint;
  const Places places(joint);
  OwnKernel own;
  own.name = joint.name, own.title = joint.title;
  own.dimension = joint.dimension;
  own.body_names = joint.bodies;
  own.parameters = parameters_of(kernel, places);
  if (joint.law) add_effect(kernel, places, own);
  if (joint.on_any_coordinate()) return own;
  own.rows = block_of(kernel.rows, joint, places);
  for (const KernelBlock& variant : kernel.rows.variants)
    own.variants.push_back(block_of(variant, joint, places, own.rows));
  for (const KernelBlock& coordinate : kernel.coordinates) {
    OwnBlock& block = own.coordinates.emplace_back(block_of(coordinate, joint, places));
    block.unit = text(std::ranges::find(joint.coordinates, coordinate.name, &Coordinate::name)->unit);
  }
  add_turns(own);
  return own;
}

}  // namespace

OwnReading read_own_kernel(const std::string& file) {
  OwnReading reading;
  const ReadResult read = SpecsFolder().read(file);
  reading.problems = render(*read.file, read.diagnostics);
  if (!read.joint) return reading;
  const auto refuse = [&](const std::string& reason) {
    Diagnostics diagnostics;
    diagnostics.error(read.joint->rows.empty() ? Span{} : read.joint->rows.front().where, reason);
    reading.problems += render(*read.file, diagnostics);
    return reading;
  };
  try {
    const Derivation derivation = derive::derive(*read.joint);
    reading.kernel = std::make_shared<OwnKernel>(tapes_of(simplified(plan(derivation))));
  } catch (const NotLinear& e) {
    return refuse(e.what());
  } catch (const NumberTooLarge& e) {
    return refuse(e.what());
  }
  return reading;
}

}  // namespace cdot
