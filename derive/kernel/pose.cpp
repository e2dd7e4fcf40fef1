// Poses and parameters to the vectors of formulas: arms and directions rotated into the world, and back for defaults.
#include "derive/derivation/forms.hpp"
#include "derive/expression/components.hpp"
#include "derive/expression/symbols.hpp"
#include "derive/kernel/plan.hpp"

namespace cdot::derive {

std::vector<std::string> fields_of(const Joint& joint, const Parameter& parameter) {
  if (parameter.kind == ParameterKind::scalar) return {parameter.name};
  std::vector<std::string> stems = {parameter.name}, fields;
  if (!parameter.axes.empty()) stems = {parameter.name + "_x", parameter.name + "_y", parameter.name + "_z"};
  for (const std::string& stem : stems) {
    for (int k = 0; k < joint.dimension; ++k) fields.push_back(stem + "_" + "xyz"[k]);
  }
  return fields;
}

std::vector<Expr> local_symbols(const Joint& joint, const Parameter& parameter) {
  if (parameter.kind == ParameterKind::scalar) return {parameter.symbol};
  std::vector<Expr> symbols;
  for (const std::string& field : fields_of(joint, parameter)) {
    symbols.push_back(joint.pool->symbol("p." + field, Role::parameter));
  }
  return symbols;
}

PoseInputs::PoseInputs(const Joint& joint, int in_axes_of, const std::vector<std::string>& crossed) {
  for (const Parameter& parameter : joint.parameters) {
    if (parameter.kind == ParameterKind::scalar || !parameter.symbol) continue;
    rotate(joint, parameter, std::ranges::find(crossed, parameter.name) != crossed.end());
  }
  Components components;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const int body = static_cast<int>(b);
    const auto A = rotation_matrix(joint, body);
    const std::vector<Expr> axes = body_axes(*joint.pool, body);
    for (std::size_t k = 0; k < axes.size() && axes[k]->kind == Kind::symbol; ++k) {
      const std::vector<Expr> world = components.of_vector(axes[k]);
      for (std::size_t i = 0; i < world.size(); ++i) rotated_.emplace(&*world[i], A[i][k]);
    }
  }
  if (in_axes_of >= 0) fix(joint, in_axes_of);
  components_.emplace(axes_ ? &*axes_ : nullptr);
  rotation_.emplace(rotated_);
}

void PoseInputs::fix(const Joint& joint, int body) {
  Pool& pool = *joint.pool;
  const std::size_t n = static_cast<std::size_t>(joint.dimension);
  axes_ = {body, joint.bodies[static_cast<std::size_t>(body)], rotation_matrix(joint, body), {}};
  for (const Parameter& parameter : joint.parameters) {
    if (parameter.kind == ParameterKind::scalar || parameter.body != body) continue;
    const std::vector<Expr> local = local_symbols(joint, parameter);
    const std::vector<Expr> leaves = parameter.axes.empty() ? std::vector{parameter.symbol} : parameter.axes;
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      const auto first = local.begin() + static_cast<std::ptrdiff_t>(i * n);
      axes_->fixed[&*leaves[i]] = {first, first + static_cast<std::ptrdiff_t>(n)};
    }
  }
  const std::vector<Expr> own = body_axes(pool, body);
  for (std::size_t i = 0; i < n && own[i]->kind == Kind::symbol; ++i) {
    std::vector<Expr>& components = axes_->fixed[&*own[i]];
    for (std::size_t k = 0; k < n; ++k) components.push_back(pool.number(i == k ? 1 : 0));
  }
}

// r = R l for each vector leaf behind the parameter; the third axis of a frame as x × y, if it is `crossed`.
void PoseInputs::rotate(const Joint& joint, const Parameter& parameter, bool crossed) {
  Components components;
  const std::vector<Expr> local = local_symbols(joint, parameter);
  const std::vector<Expr> leaves = parameter.axes.empty() ? std::vector{parameter.symbol} : parameter.axes;
  for (std::size_t n = 0; n < leaves.size(); ++n) {
    const std::vector<Expr> world = components.of_vector(leaves[n]);
    const auto turned = [&](std::size_t axis, std::size_t i) {
      return rotated_.at(&*components.of_vector(leaves[axis])[i]);
    };
    for (std::size_t i = 0; i < world.size(); ++i) {
      Expr component = local[n * world.size() + i];
      if (crossed && n == 2) {
        const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
        component = turned(0, j) * turned(1, k) - turned(0, k) * turned(1, j);
        joint.pool->name(component, world[i]->symbol, true);
      } else if (parameter.body >= 0) {
        const std::vector<Expr> row = rotation_matrix(joint, parameter.body)[i];
        component = joint.pool->number(0);
        for (std::size_t k = 0; k < row.size(); ++k) component = component + row[k] * local[n * row.size() + k];
        joint.pool->name(component, world[i]->symbol, true);
      }
      rotated_.emplace(&*world[i], component);
    }
  }
}

std::vector<std::string> whole_frames(const Joint& joint, const std::vector<NamedExpr>& outputs) {
  std::vector<Expr> roots;
  for (const NamedExpr& output : outputs) roots.push_back(output.e);
  const std::vector<Expr> leaves = leaves_of(roots);
  std::vector<std::string> frames;
  for (const Parameter& parameter : joint.parameters) {
    if (parameter.axes.empty() || parameter.body < 0) continue;
    const auto is_read = [&](char axis) {
      const std::string start = "p." + parameter.name + "_" + axis + "_";
      return std::ranges::any_of(leaves, [&](Expr leaf) { return leaf->symbol.starts_with(start); });
    };
    if (is_read('x') && is_read('y') && is_read('z')) frames.push_back(parameter.name);
  }
  return frames;
}

Expr PoseInputs::of(Expr scalar) { return rotation_->of(components_->of(scalar)); }

// The default of a parameter in its own frame: R^T (p - x) for a point, R^T u for a vector.
DefaultValue plan_default(const Joint& joint, int index) {
  const Parameter& parameter = joint.parameters[static_cast<std::size_t>(index)];
  PoseInputs pose(joint);
  Pool& pool = *joint.pool;
  const std::vector<std::string> fields = fields_of(joint, parameter);
  std::vector<NamedExpr> outputs;
  const auto output = [&](Expr e) { outputs.push_back({"p." + fields[outputs.size()], pose.of(e)}); };
  if (parameter.kind == ParameterKind::scalar) {
    output(parameter.default_value);
    return {index, assemble(outputs)};
  }
  std::vector<Expr> values = {parameter.default_value};
  if (!parameter.default_axes.empty()) values = parameter.default_axes;
  if (parameter.kind == ParameterKind::point && parameter.body >= 0) {
    values[0] = values[0] - body_symbols(joint, parameter.body).x;
  }
  for (const Expr value : values) {
    for (const Expr axis : body_axes(pool, parameter.body)) output(dot(axis, value));
  }
  return {index, assemble(outputs)};
}

bool depends_on_time(const Block& block) {
  std::vector<Expr> roots;
  for (const ScalarRow& row : block.rows) roots.insert(roots.end(), {row.C, row.Cdot});
  return std::ranges::any_of(leaves_of(roots), [](Expr leaf) { return leaf->role == Role::time; });
}

}  // namespace cdot::derive
