// A spec -> its kernel of tapes -> entries in the tables by which Worlds find joints.
#include "runtime/own/own.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <map>

#include <cdot/detail/coordinate_effects.hpp>
#include <cdot/detail/joint_table.hpp>
#include <cdot/spaces.hpp>

#include "runtime/own/check_own.hpp"
#include "runtime/own/own_rows.hpp"
#include "runtime/own/own_tables.hpp"

namespace cdot {
namespace {

// A kernel and the texts that its JointType refers to, for ever.
struct Registered {
  std::string name, file;
  std::shared_ptr<const OwnKernel> kernel;
};

void describe_effect(const OwnKernel& kernel, JointType& type) {
  const std::optional<OwnLaw>& law = kernel.law;
  type.is_effect = true;
  type.explicit_time |= law && law->in_time;
  for (const OwnBound& bound : kernel.bounded) type.explicit_time |= bound.in_time;
  type.without_energy = !law || law->unstored.exists() || !law->energy.exists();
  if (!kernel.on_coordinate) return;
  type.coordinate_unit = kernel.on_coordinate->unit;
  for (const int use : kernel.on_coordinate->uses) type.coordinate_uses.push_back(static_cast<CoordinateUse>(use));
}

JointType described(const Registered& own) {
  const OwnKernel& kernel = *own.kernel;
  JointType type{};
  type.name = own.name, type.title = kernel.title;
  type.bodies = kernel.bodies();
  type.body_names.assign(kernel.body_names.begin(), kernel.body_names.end());
  type.row_names.assign(kernel.rows.row_names.begin(), kernel.rows.row_names.end());
  for (const int kind : kernel.rows.row_kinds) type.row_kinds.push_back(static_cast<RowKind>(kind));
  for (const OwnParameter& p : kernel.parameters)
    type.parameters.push_back({p.name, static_cast<ParameterKind>(p.kind), p.body, p.unit, p.offset, p.size,
                               p.has_default, p.above, p.below, p.from, p.unlimited});
  for (const OwnBlock& coordinate : kernel.coordinates) type.coordinates.push_back({coordinate.name, coordinate.unit});
  type.parameter_size = kernel.parameter_size();
  type.explicit_time = kernel.rows.explicit_time;
  if (kernel.is_effect) describe_effect(kernel, type);
  return type;
}

template <class T>
auto bounds_of(std::shared_ptr<const OwnKernel> kernel, std::size_t i) {
  return [kernel = std::move(kernel), i](T C, const T* parameters, T time, RowBounds<T>& B) {
    run_own<T>(kernel->bounded[i].bounds, {.parameters = parameters, .time = &time, .C = &C}, &B.lower);
  };
}

template <class S>
JointEntry<S> entry_of(std::shared_ptr<const OwnKernel> kernel) {
  using T = typename S::Scalar;
  JointEntry<S> entry{{own_block_ops<S>(*kernel, kernel->rows), {}}, {}, {}};
  for (const OwnBlock& variant : kernel->variants)
    entry.rows.immovable.emplace_back(variant.immovable, own_block_ops<S>(*kernel, variant));
  for (const OwnBlock& coordinate : kernel->coordinates)
    entry.coordinates.push_back({own_block_ops<S>(*kernel, coordinate), {}});
  entry.default_value = [kernel](int index, const typename S::Pose* q, T* parameters, T time) {
    const OwnParameter& parameter = kernel->parameters[static_cast<std::size_t>(index)];
    run_own<T>(parameter.by_default, {.pose = reinterpret_cast<const T*>(q), .parameters = parameters, .time = &time},
               parameters);
  };
  entry.law = own_law<S>(*kernel);
  const std::vector<const Law<S>*> laws = own_bounded_laws<S>(*kernel);
  for (std::size_t i = 0; i < laws.size(); ++i) {
    const OwnBound& bound = kernel->bounded[i];
    entry.bounded.push_back({bound.coordinate, bound.name, laws[i], bounds_of<T>(kernel, i)});
  }
  return entry;
}

template <class S>
void add_entry(const std::shared_ptr<const OwnKernel>& kernel, Dimension dimension) {
  if (S::dimension == dimension) joint_entries<S>().push_back(entry_of<S>(kernel));
}

bool has_value(const OwnLaw& law, double C, const double* parameters, double time) {
  const double rate = 0, mass = 1;
  const OwnArguments<double> in = {
      .parameters = parameters, .time = &time, .C = &C, .rate = &rate, .effective_mass = &mass};
  double force = 0, energy = 0;
  run_own<double>(law.force, in, &force);
  run_own<double>(law.energy, in, &energy);
  return std::isfinite(force) && std::isfinite(energy);
}

FunctionsOnCoordinate functions_of(const std::shared_ptr<const OwnKernel>& kernel) {
  FunctionsOnCoordinate functions;
  functions.default_value = [kernel](int index, double* parameters, double time) {
    const OwnParameter& parameter = kernel->parameters[static_cast<std::size_t>(index)];
    run_own<double>(parameter.by_default, {.parameters = parameters, .time = &time}, parameters);
  };
  if (kernel->bounded.empty())
    functions.has_value = [kernel](double C, const double* parameters, double time) {
      return has_value(*kernel->law, C, parameters, time);
    };
  else if (kernel->on_coordinate->unit == "joint")
    functions.breaks = [kernel](const double* parameters, double time, double load) {
      double distance;
      run_own<double>(kernel->bounded[0].until, {.parameters = parameters, .time = &time, .load = &load}, &distance);
      return distance;
    };
  else functions.bounds = bounds_of<double>(kernel, 0);
  return functions;
}

void add_on_coordinates(const Registered& own) {
  registered_coordinate_effects().push_back(described(own));
  functions_on_coordinates().push_back(functions_of(own.kernel));
#define CDOT_ADD_LAW(S) laws_on_coordinates<S>().push_back(own_law_on_coordinate<S>(*own.kernel));
  CDOT_FOR_EACH_SPACE(CDOT_ADD_LAW)
#undef CDOT_ADD_LAW
}

void add_joint(const Registered& own) {
  const Dimension dimension = own.kernel->dimension == 2 ? Dimension::planar : Dimension::spatial;
  add_joint_type(dimension, described(own));
#define CDOT_ADD_ENTRY(S) add_entry<S>(own.kernel, dimension);
  CDOT_FOR_EACH_SPACE(CDOT_ADD_ENTRY)
#undef CDOT_ADD_ENTRY
}

std::vector<std::unique_ptr<Registered>>& registered() {
  static std::vector<std::unique_ptr<Registered>> all;
  return all;
}

// Why these tapes cannot stand for a compiled kernel; empty if they can.
std::string obstacle(const OwnKernel& kernel) {
  const std::string compile = "Likely fix: cdot_add_joints compiles it into a program";
  if (kernel.bodies() > most_own_bodies || kernel.rows.rows() > most_own_rows)
    return fmt::format("it has {} bodies and {} rows, the most without a compiler are {} and {}. {}", kernel.bodies(),
                       kernel.rows.rows(), most_own_bodies, most_own_rows, compile);
  if (kernel.parameter_size() > most_own_parameters || kernel.rows.jacobian_size > most_own_entries)
    return fmt::format(
        "its parameters have {} numbers and its Jacobian {}, the most without a compiler are {} and {}. {}",
        kernel.parameter_size(), kernel.rows.jacobian_size, most_own_parameters, most_own_entries, compile);
  std::string wrong = wrong_rate(kernel);
  if (wrong.empty()) wrong = wrong_law(kernel);
  return wrong.empty() ? wrong : wrong + ". Please report this spec";
}

std::string free_name(const OwnKernel& kernel) {
  const Dimension dimension = kernel.dimension == 2 ? Dimension::planar : Dimension::spatial;
  const auto taken = [&](const std::string& name) {
    return (kernel.bodies() > 0 && find_joint_type(dimension, name)) ||
           (kernel.on_coordinate && find_coordinate_effect(name));
  };
  std::string name = kernel.name;
  for (int k = 2; taken(name); ++k) name = fmt::format("{}#{}", kernel.name, k);
  return name;
}

std::string content_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

OwnType add_own_type(const std::string& file) {
  struct Known {
    std::string content;
    OwnType type;
  };
  static std::map<std::string, Known> known;
  Known& last = known[file];
  const std::string content = content_of(file);
  if (!last.type.name.empty() && last.content == content) return last.type;
  const auto [kernel, problems] = read_own_kernel(file);
  if (!kernel) return {"", true, problems};
  if (const std::string why = obstacle(*kernel); !why.empty())
    return {"", kernel->bodies() > 0, fmt::format("{}{}: error: it cannot run: {}\n", problems, file, why)};
  registered().push_back(std::make_unique<Registered>(Registered{free_name(*kernel), file, kernel}));
  const Registered& own = *registered().back();
  if (kernel->bodies() > 0) add_joint(own);
  if (kernel->on_coordinate) add_on_coordinates(own);
  last = {content, {own.name, kernel->bodies() > 0, problems}};
  return last.type;
}

std::string file_of_own_type(const std::string& name) {
  const auto own =
      std::ranges::find(registered(), name, [](const auto& one) -> const std::string& { return one->name; });
  return own == registered().end() ? "" : (*own)->file;
}

}  // namespace cdot
