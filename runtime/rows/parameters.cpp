#include "runtime/rows/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include <cdot/detail/joint_table.hpp>
#include <cdot/spaces.hpp>

namespace cdot {
namespace {

std::string list_of_parameters(const JointType& type) {
  std::string text;
  for (const ParameterInfo& info : type.parameters) text += fmt::format("{}`{}`", text.empty() ? "" : ", ", info.name);
  return text.empty() ? "none" : text;
}

const ParameterInfo& find_parameter(const JointType& type, const std::string& name) {
  for (const ParameterInfo& info : type.parameters)
    if (info.name == name) return info;
  throw Error(fmt::format("joint `{}` has no parameter `{}`; its parameters are {}", type.name, name,
                          list_of_parameters(type)));
}

void check_numbers(const JointType& type, const ParameterInfo& info, const NamedValue& value) {
  const int count = static_cast<int>(value.numbers.size());
  const bool part_of_a_triad = info.kind == ParameterKind::frame && (count == 3 || count == 6);
  if (count != info.size && !(part_of_a_triad && info.size == 9))
    throw Error(fmt::format("parameter `{}` of joint `{}` takes {} number{}, not {}", info.name, type.name, info.size,
                            info.size == 1 ? "" : "s", value.numbers.size()));
  for (double number : value.numbers)
    if (!std::isfinite(number) && !(info.unlimited && std::isinf(number)))
      throw Error(fmt::format("parameter `{}` of joint `{}` is not finite", info.name, type.name));
}

void check_range(const JointType& type, const ParameterInfo& info, double number) {
  const bool in_range = (info.from ? info.above <= number : info.above < number) && number < info.below;
  const bool unlimited = info.unlimited && std::isinf(number) && info.above <= number && number <= info.below;
  if (!in_range && !unlimited)
    throw Error(fmt::format("parameter `{}` of joint `{}` is {:.6g} [{}]. Likely fix: a number{}", info.name, type.name,
                            number, info.unit, range_of(info)));
}

// Scales a direction of any length but 0 to length 1.
void normalise(const JointType& type, const ParameterInfo& info, double* numbers, int size) {
  double square = 0;
  for (int k = 0; k < size; ++k) square += numbers[k] * numbers[k];
  const double length = size == 2 ? std::hypot(numbers[0], numbers[1]) : std::sqrt(square);
  if (!(length >= std::numeric_limits<double>::min()))
    throw Error(fmt::format("parameter `{}` of joint `{}` is a direction and must not be zero", info.name, type.name));
  for (int k = 0; k < size; ++k) numbers[k] /= length;
}

// Completes a triad from its x axis and, if given, an approximate y axis. x stays, y is made perpendicular to x, z = x
// cross y. Without y the frame axis furthest from x replaces it.
void complete_triad(const JointType& type, const ParameterInfo& info, double* numbers, bool with_y) {
  using Vector = spatial::Vector<double>;
  normalise(type, info, numbers, 3);
  const Vector x = {numbers[0], numbers[1], numbers[2]};
  Vector y = {numbers[3], numbers[4], numbers[5]};
  if (!with_y) {
    const double ax = std::abs(x.x), ay = std::abs(x.y), az = std::abs(x.z);
    y = {0, 0, 0};
    (ay <= ax && ay <= az ? y.y : ax <= az ? y.x : y.z) = 1;
  }
  y = y - spatial::dot(x, y) * x;
  if (!(spatial::norm(y) >= 1e-9))
    throw Error(
        fmt::format("the y axis of parameter `{}` of joint `{}` is parallel to its x axis", info.name, type.name));
  y = (1 / spatial::norm(y)) * y;
  const Vector z = spatial::cross(x, y);
  const double triad[] = {x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z};
  std::copy_n(triad, 9, numbers);
}

void make_directions(const JointType& type, const ParameterInfo& info, double* numbers, size_t given) {
  if (info.kind == ParameterKind::frame && info.size == 9) complete_triad(type, info, numbers, given > 3);
  else if (info.kind == ParameterKind::unit || info.kind == ParameterKind::frame)
    normalise(type, info, numbers, info.size);
}

// The value given for each parameter of the type; null: none.
std::vector<const NamedValue*> match(const JointType& type, const std::vector<NamedValue>& given) {
  std::vector<const NamedValue*> value_of(type.parameters.size(), nullptr);
  for (const NamedValue& value : given) {
    const ParameterInfo& info = find_parameter(type, value.name);
    const NamedValue*& slot = value_of[static_cast<size_t>(&info - type.parameters.data())];
    if (slot) throw Error(fmt::format("parameter `{}` of joint `{}` is given twice", info.name, type.name));
    check_numbers(type, info, value);
    slot = &value;
  }
  return value_of;
}

void take(const JointType& type, const ParameterInfo& info, const NamedValue& value, double* at) {
  std::copy(value.numbers.begin(), value.numbers.end(), at);
  make_directions(type, info, at, value.numbers.size());
  check_range(type, info, *at);
}

}  // namespace

std::string range_of(const ParameterInfo& info) {
  if (std::isinf(info.above) && std::isinf(info.below)) return "";
  if (std::isinf(info.below)) return fmt::format(" {} {:.6g}", info.from ? "from" : "above", info.above);
  if (std::isinf(info.above)) return fmt::format(" below {:.6g}", info.below);
  return fmt::format(" between {:.6g} and {:.6g}", info.above, info.below);
}

template <class S>
std::vector<double> parameter_numbers(int type_index, const std::vector<NamedValue>& given,
                                      const typename S::Pose* poses, double time) {
  const JointType& type = joint_types(S::dimension)[static_cast<size_t>(type_index)];
  const auto& entry = joint_entries<S>()[static_cast<size_t>(type_index)];
  std::vector<double> numbers(static_cast<size_t>(type.parameter_size), 0.0);
  const std::vector<const NamedValue*> value_of = match(type, given);
  // In order of declaration, because a default may use earlier parameters.
  for (size_t i = 0; i < type.parameters.size(); ++i) {
    const ParameterInfo& info = type.parameters[i];
    double* at = numbers.data() + info.offset;
    if (value_of[i]) {
      take(type, info, *value_of[i], at);
    } else if (info.has_default) {
      entry.default_value(static_cast<int>(i), poses, numbers.data(), time);
    } else {
      throw Error(fmt::format("joint `{}` needs its parameter `{}` (it has no default)", type.name, info.name));
    }
    for (int k = 0; k < info.size; ++k)
      if (!std::isfinite(at[k]) && !(info.unlimited && std::isinf(at[k])))
        throw Error(
            fmt::format("the default of parameter `{}` of joint `{}` is not finite here", info.name, type.name));
    check_range(type, info, *at);
  }
  return numbers;
}

std::vector<const ParameterInfo*> change_parameters(const JointType& type, const std::vector<NamedValue>& given,
                                                    std::vector<double>& numbers) {
  std::vector<const ParameterInfo*> changed;
  const std::vector<const NamedValue*> value_of = match(type, given);
  for (size_t i = 0; i < value_of.size(); ++i) {
    if (!value_of[i]) continue;
    const ParameterInfo& info = type.parameters[i];
    take(type, info, *value_of[i], numbers.data() + info.offset);
    changed.push_back(&info);
  }
  return changed;
}

template std::vector<double> parameter_numbers<Planar<double>>(int, const std::vector<NamedValue>&,
                                                               const planar::Pose<double>*, double);
template std::vector<double> parameter_numbers<Spatial<double>>(int, const std::vector<NamedValue>&,
                                                                const spatial::Pose<double>*, double);

}  // namespace cdot
