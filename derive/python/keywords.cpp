// Keyword arguments of Python -> plain data of the runtime.
#include "derive/python/keywords.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <functional>
#include <map>
#include <optional>

#include <cdot/methods.hpp>

#include "derive/python/arrays.hpp"
#include "runtime/text/spelling.hpp"

namespace cdot::python {
namespace {

using Take = std::function<void(const py::handle& value, const std::string& name)>;
using Takers = std::map<std::string, Take>;

// Hands each keyword to its taker.
void take_all(const py::kwargs& keywords, const Takers& takers) {
  for (const auto& [key, value] : keywords) {
    const auto name = py::cast<std::string>(key);
    const auto taker = takers.find(name);
    if (taker == takers.end()) {
      std::vector<std::string> known;
      for (const auto& [each, take] : takers) known.push_back(each);
      throw py::type_error(fmt::format("there is no keyword `{}`{}", name, suggestion(name, known)));
    }
    taker->second(value, name);
  }
}

Take number(double& to) {
  return [&to](const py::handle& value, const std::string& name) { to = numbers_of(value, name, 1).front(); };
}

Take count(int& to) {
  return [&to](const py::handle& value, const std::string& name) {
    if (!PyLong_Check(value.ptr())) throw py::type_error(name + " must be a whole number");
    to = value.cast<int>();
  };
}

Take flag(bool& to) {
  return [&to](const py::handle& value, const std::string& name) {
    if (!PyBool_Check(value.ptr())) throw py::type_error(name + " must be True or False");
    to = value.cast<bool>();
  };
}

Take numbers(std::vector<double*> to) {
  return [to = std::move(to)](const py::handle& value, const std::string& name) {
    const std::vector<double> given = numbers_of(value, name, to.size());
    for (std::size_t k = 0; k < to.size(); ++k) *to[k] = given[k];
  };
}

// A method by its name in a table of them.
template <class Table, class Method>
Take method(const Table& table, Method& to) {
  return [&table, &to](const py::handle& value, const std::string& name) {
    const auto word = py::str(value).cast<std::string>();
    const std::vector<std::string> known = names_of(table);
    if (std::find(known.begin(), known.end(), word) == known.end())
      throw py::value_error(fmt::format("{} must be one of {}, but is `{}`", name, fmt::join(known, ", "), word));
    to = method_called(table, word);
  };
}

Take gravity(Settings& s) {
  return [&s](const py::handle& value, const std::string& name) {
    const std::vector<double> g = numbers_of(value, name);
    if (g.size() != 2 && g.size() != 3)
      throw py::value_error(fmt::format("{} must have 2 or 3 numbers, but has {}", name, g.size()));
    s.gravity_x = g[0], s.gravity_y = g[1], s.gravity_z = g.size() == 3 ? g[2] : 0;
  };
}

Takers common(auto& body) {
  return {{"mass", number(body.mass)},
          {"linear_damping", number(body.linear_damping)},
          {"angular_damping", number(body.angular_damping)},
          {"static", flag(body.is_static)},
          {"fixed_rotation", flag(body.fixed_rotation)}};
}

// In space: the same about every axis, the three main ones, or all six numbers.
Take tensor(Inertia& to) {
  return [&to](const py::handle& value, const std::string& name) {
    const std::vector<double> I = numbers_of(value, name);
    if (I.size() == 1) to = {I[0], I[0], I[0]};
    else if (I.size() == 3) to = {I[0], I[1], I[2]};
    else if (I.size() == 6) to = {I[0], I[1], I[2], I[3], I[4], I[5]};
    else throw py::value_error(fmt::format("{} must have 1, 3 or 6 numbers, but has {}", name, I.size()));
  };
}

const EffectKind* kind_of(const std::string& type) {
  const auto* found = std::find_if(std::begin(effect_kinds), std::end(effect_kinds),
                                   [&](const EffectKind* kind) { return kind->key == type; });
  return found == std::end(effect_kinds) ? nullptr : *found;
}

// The numbers of a short form, in the order of its table.
CoordinateEffects short_form(const std::string& coordinate, const EffectKind& kind, const py::kwargs& keywords) {
  std::vector<EffectKind::Given> given;
  std::vector<double> values(std::size(kind.numbers));
  Takers takers;
  for (const EffectNumber& each : kind.numbers) {
    if (!each.key) break;
    takers[each.key] = number(values[given.size()]);
    given.push_back({keywords.contains(each.key), {}});
  }
  take_all(keywords, takers);
  for (std::size_t k = 0; k < given.size(); ++k) {
    const EffectNumber& each = kind.numbers[k];
    if (given[k].written) given[k].value = values[k];
    const bool needed = each.example || kind.form == EffectKind::number;
    if (needed && !given[k].written)
      throw py::type_error(fmt::format("the effect `{}` needs the keyword `{}`", kind.key, each.key));
    const bool wrong = given[k].written && ((each.range == EffectNumber::positive && !(values[k] > 0)) ||
                                            (each.range == EffectNumber::not_negative && !(values[k] >= 0)));
    if (wrong)
      throw py::value_error(fmt::format("{} must be {} 0, but is {}", each.key,
                                        each.range == EffectNumber::positive ? ">" : ">=", values[k]));
  }
  CoordinateEffects effects{coordinate};
  if (const auto mistake = kind.take(given, effects))
    throw py::value_error(fmt::format(fmt::runtime(mistake->cause), fmt::format("`{}`", kind.key)));
  return effects;
}

}  // namespace

std::string suggestion(const std::string& word, const std::vector<std::string>& candidates) {
  const std::string near = text::nearest(word, candidates, 2);
  return near.empty() ? std::string() : fmt::format("; did you mean `{}`?", near);
}

Settings settings_of(const py::kwargs& keywords) {
  Settings s;
  const bool drift_is_named = keywords.contains("drift");
  take_all(keywords, {{"solver", method(solvers, s.solver)},
                      {"integrator", method(integrators, s.integrator)},
                      {"drift", method(drifts, s.drift)},
                      {"kernels", method(kernel_forms, s.kernels)},
                      {"gravity", gravity(s)},
                      {"local_error", number(s.local_error)},
                      {"iterations", count(s.iterations)},
                      {"substeps", count(s.substeps)},
                      {"baumgarte", number(s.baumgarte)},
                      {"warm_start", flag(s.warm_start)},
                      {"sleep_after", number(s.sleep_after)},
                      {"sleep_speed", number(s.sleep_speed)}});
  if (!drift_is_named) s.drift = usual_drift(s);
  return s;
}

BodyDefinition planar_body_of(const py::kwargs& keywords) {
  BodyDefinition b;
  Takers takers = common(b);
  takers.insert({{"position", numbers({&b.x, &b.y})},
                 {"angle", number(b.angle)},
                 {"velocity", numbers({&b.vx, &b.vy})},
                 {"omega", number(b.w)},
                 {"inertia", number(b.inertia)},
                 {"force", numbers({&b.force_x, &b.force_y})},
                 {"torque", number(b.torque)}});
  take_all(keywords, takers);
  return b;
}

SpatialBodyDefinition spatial_body_of(const py::kwargs& keywords) {
  SpatialBodyDefinition b;
  Takers takers = common(b);
  takers.insert({{"position", numbers({&b.x, &b.y, &b.z})},
                 {"orientation", numbers({&b.e0, &b.e1, &b.e2, &b.e3})},
                 {"velocity", numbers({&b.vx, &b.vy, &b.vz})},
                 {"omega", numbers({&b.wx, &b.wy, &b.wz})},
                 {"inertia", tensor(b.inertia)},
                 {"force", numbers({&b.force_x, &b.force_y, &b.force_z})},
                 {"torque", numbers({&b.torque_x, &b.torque_y, &b.torque_z})}});
  take_all(keywords, takers);
  return b;
}

std::vector<NamedValue> parameters_of(const py::kwargs& keywords) {
  std::vector<NamedValue> values;
  for (const auto& [key, value] : keywords) {
    const auto name = py::cast<std::string>(key);
    values.push_back({name, numbers_of(value, name)});
  }
  return values;
}

CoordinateEffects effect_of(const std::string& coordinate, const std::string& type, const py::kwargs& keywords) {
  if (const EffectKind* kind = kind_of(type)) return short_form(coordinate, *kind, keywords);
  CoordinateEffects effects{coordinate};
  effects.specs.push_back({type, parameters_of(keywords)});
  return effects;
}

}  // namespace cdot::python
