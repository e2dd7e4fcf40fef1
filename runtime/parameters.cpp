#include "runtime/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "runtime/joint_table.hpp"

namespace cdot {
namespace {

std::string list_of_parameters(const JointType& type) {
  std::string text;
  for (const ParameterInfo& info : type.parameters)
    text += fmt::format("{}`{}`", text.empty() ? "" : ", ", info.name);
  return text.empty() ? "none" : text;
}

const ParameterInfo& find_parameter(const JointType& type, const std::string& name) {
  for (const ParameterInfo& info : type.parameters)
    if (info.name == name) return info;
  throw Error(fmt::format("joint `{}` has no parameter `{}`; its parameters are {}", type.name,
                          name, list_of_parameters(type)));
}

void check_numbers(const JointType& type, const ParameterInfo& info, const NamedValue& value) {
  if (static_cast<int>(value.numbers.size()) != info.size)
    throw Error(fmt::format("parameter `{}` of joint `{}` takes {} number{}, not {}", info.name,
                            type.name, info.size, info.size == 1 ? "" : "s", value.numbers.size()));
  for (double number : value.numbers)
    if (!std::isfinite(number))
      throw Error(fmt::format("parameter `{}` of joint `{}` is not finite", info.name, type.name));
}

// A direction of any length but zero stands for the unit vector along it.
void normalise(const JointType& type, const ParameterInfo& info, double* numbers) {
  if (info.kind != ParameterKind::unit && info.kind != ParameterKind::frame) return;
  const double x = numbers[0], y = numbers[1];
  const double length = std::hypot(x, y);
  if (!(length >= std::numeric_limits<double>::min()))
    throw Error(fmt::format("parameter `{}` of joint `{}` is a direction and must not be zero",
                            info.name, type.name));
  numbers[0] = x / length;
  numbers[1] = y / length;
}

}  // namespace

std::vector<double> parameter_numbers(int type_index, const std::vector<NamedValue>& given,
                                      const planar::Pose<double>* poses, double time) {
  const JointType& type = joint_types()[static_cast<size_t>(type_index)];
  const auto& entry = joint_entries<Planar<double>>()[static_cast<size_t>(type_index)];
  std::vector<double> numbers(static_cast<size_t>(type.parameter_size), 0.0);
  std::vector<const NamedValue*> value_of(type.parameters.size(), nullptr);
  for (const NamedValue& value : given) {
    const ParameterInfo& info = find_parameter(type, value.name);
    const NamedValue*& slot = value_of[static_cast<size_t>(&info - type.parameters.data())];
    if (slot)
      throw Error(fmt::format("parameter `{}` of joint `{}` is given twice", info.name, type.name));
    check_numbers(type, info, value);
    slot = &value;
  }
  // In order of declaration, since a default may use the parameters before it.
  for (size_t i = 0; i < type.parameters.size(); ++i) {
    const ParameterInfo& info = type.parameters[i];
    double* at = numbers.data() + info.offset;
    if (value_of[i]) {
      std::copy(value_of[i]->numbers.begin(), value_of[i]->numbers.end(), at);
      normalise(type, info, at);
    } else if (info.has_default) {
      entry.default_value(static_cast<int>(i), poses, numbers.data(), time);
    } else {
      throw Error(fmt::format("joint `{}` needs its parameter `{}` (it has no default)", type.name,
                              info.name));
    }
    for (int k = 0; k < info.size; ++k)
      if (!std::isfinite(at[k]))
        throw Error(fmt::format("the default of parameter `{}` of joint `{}` is not finite here",
                                info.name, type.name));
  }
  return numbers;
}

}  // namespace cdot
