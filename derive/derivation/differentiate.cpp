// C to Cdot, Cdot to J, J to K: the derivation, on vectors.
#include <algorithm>
#include <map>

#include "derive/derivation/derivation.hpp"
#include "derive/derivation/free_coordinates.hpp"
#include "derive/derivation/gradient.hpp"
#include "derive/expression/symbols.hpp"

namespace cdot::derive {
namespace {

// d(J^T lambda)/dq: each component of the generalised force, differentiated along the motion at fixed time and
// lambda; what multiplies each component of v and w of a body is its column.
std::vector<std::vector<Expr>> geometric_stiffness(const Joint& joint, Block& block) {
  Pool& pool = *joint.pool;
  for (std::size_t i = 0; i < block.rows.size(); ++i) {
    block.lambda.push_back(pool.symbol("lambda_" + std::to_string(i + 1), Role::multiplier));
  }
  std::vector<std::vector<Expr>> H;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    JacobianEntry force{zero_vector(pool), zero_spin(pool)};
    for (std::size_t i = 0; i < block.rows.size(); ++i) {
      force.v = force.v + block.lambda[i] * block.rows[i].J[b].v;
      force.w = force.w + block.lambda[i] * block.rows[i].J[b].w;
    }
    for (const Expr component : columns_of(force)) {
      const Expr rate = time_derivative(component, joint, {block.immovable});
      H.push_back(columns_of(isolate_velocities(rate, joint)));
    }
  }
  return H;
}

// -Jdot v - d(C_t)/dt, where what one entry of J multiplies is collected first: J (w_a - w_b), whose difference loses
// nothing when the bodies turn nearly alike.
Expr gamma_by_entries(const Joint& joint, const ScalarRow& row) {
  std::vector<std::pair<Expr, Expr>> entries;  // of J without numeric factor; the velocities times theirs
  const auto collect = [&](Expr entry, Expr velocity) {
    if (is_zero(entry)) return;
    const Term part = split_coefficient(entry);
    const auto found =
        std::find_if(entries.begin(), entries.end(), [&](const auto& known) { return known.first == part.e; });
    if (found == entries.end()) {
      entries.emplace_back(part.e, part.coef * velocity);
    } else {
      found->second = found->second + part.coef * velocity;
    }
  };
  for (std::size_t b = 0; b < row.J.size(); ++b) {
    const BodySymbols body = body_symbols(joint, static_cast<int>(b));
    collect(row.J[b].v, body.v);
    collect(row.J[b].w, body.w);
  }
  Expr gamma = -time_derivative(row.C_t, joint);
  for (const auto& [entry, velocity] : entries) {
    const Expr rate = time_derivative(entry, joint);
    gamma = gamma - (entry->vector ? dot(rate, velocity) : rate * velocity);
  }
  return gamma;
}

// J of all bodies, by the names of its gradients.
std::vector<JacobianEntry> whole_jacobian(const Joint& joint, const ScalarRow& row, int immovable) {
  if (immovable < 0) return row.J;
  ScalarRow whole = row;
  whole.J = factors_of_velocities(time_derivative(row.C, joint), joint);
  whole.gradients.clear();
  name_gradients(joint, whole);
  return whole.J;
}

ScalarRow derive_row(const Joint& joint, ScalarRow row, Expr expression, int immovable) {
  Pool& pool = *joint.pool;
  const bool at_velocity_level = row.kind == RowKind::velocity;
  row.C = at_velocity_level ? pool.number(0) : expression;
  row.Cdot = at_velocity_level ? expression : time_derivative(expression, joint, {immovable});
  std::map<const Node*, Expr> at_rest;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BodySymbols body = body_symbols(joint, static_cast<int>(b));
    at_rest.emplace(&*body.v, zero_vector(pool));
    at_rest.emplace(&*body.w, zero_spin(pool));
  }
  if (at_velocity_level && immovable >= 0) {
    const BodySymbols body = body_symbols(joint, immovable);
    row.Cdot = substitute(row.Cdot, {{&*body.v, zero_vector(pool)}, {&*body.w, zero_spin(pool)}}, KeepNames::no);
  }
  row.C_t = substitute(row.Cdot, at_rest, KeepNames::no);
  row.J = factors_of_velocities(row.Cdot, joint);
  name_gradients(joint, row);
  for (JacobianEntry& entry : row.J) entry.w = collected(entry.w);
  if (!at_velocity_level && has_long_lever(row))
    shorten_lever_of_carrier(joint, row, whole_jacobian(joint, row, immovable));
  name_axes(joint, row);
  if (immovable < 0) {
    row.gamma = -time_derivative(row.Cdot, joint);
    row.gamma_by_entries = gamma_by_entries(joint, row);
  }
  return row;
}

Block finished(const Joint& joint, Block block) {
  block.K = effective_mass(joint, block.rows, block.immovable);
  if (joint.dimension == 3) block.K_isotropic = effective_mass(joint, block.rows, block.immovable, true);
  if (block.immovable < 0) block.stiffness = geometric_stiffness(joint, block);
  return block;
}

bool some_row_vanishes(const Block& block) {
  return std::any_of(block.rows.begin(), block.rows.end(), [](const ScalarRow& row) {
    return std::all_of(row.J.begin(), row.J.end(), [](const JacobianEntry& e) { return is_zero(e.v) && is_zero(e.w); });
  });
}

template <class Derive>
std::vector<Block> variants(const Joint& joint, Derive derive) {
  std::vector<Block> variants;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    Block variant = derive(static_cast<int>(b));
    if (!variant.rows.empty() && !some_row_vanishes(variant)) variants.push_back(std::move(variant));
  }
  return variants;
}

}  // namespace

Derivation derive(Joint joint) {
  Derivation d(std::move(joint));
  d.rows = derive_rows(d.joint);
  for (const Coordinate& c : d.joint.coordinates) d.coordinates.push_back(derive_coordinate(d.joint, c));
  if (!d.joint.law) drop_constrained_coordinates(d);
  else derive_law(d);
  d.rows.variants = variants(d.joint, [&](int immovable) { return derive_rows(d.joint, immovable); });
  for (std::size_t i = 0; i < d.coordinates.size(); ++i) {
    d.coordinates[i].variants =
        variants(d.joint, [&](int immovable) { return derive_coordinate(d.joint, d.joint.coordinates[i], immovable); });
  }
  return d;
}

BodySymbols body_symbols(const Joint& joint, int body) {
  Pool& pool = *joint.pool;
  return {body_position(pool, body), pool.dimension() == 2 ? body_angle(pool, body) : Expr(),
          body_velocity(pool, body), body_spin(pool, body),
          inverse_mass(pool, body),  inverse_inertia(pool, body)};
}

Expr zero_spin(Pool& pool) { return pool.dimension() == 2 ? pool.number(0) : zero_vector(pool); }

std::vector<Expr> columns_of(const JacobianEntry& entry) {
  std::vector<Expr> columns = components_of(entry.v), w = components_of(entry.w);
  columns.insert(columns.end(), w.begin(), w.end());
  return columns;
}

std::vector<std::vector<Expr>> columns_of(std::span<const ScalarRow> rows) {
  std::vector<std::vector<Expr>> J;
  for (const ScalarRow& row : rows) J.push_back(columns_of(row.J));
  return J;
}

std::vector<Expr> columns_of(const std::vector<JacobianEntry>& J) {
  std::vector<Expr> columns;
  for (const JacobianEntry& entry : J) {
    const std::vector<Expr> part = columns_of(entry);
    columns.insert(columns.end(), part.begin(), part.end());
  }
  return columns;
}

// Entry by entry the sum over the bodies of v_i . v_j / m + w_i . I^-1 w_j.
std::vector<std::vector<Expr>> effective_mass(const Joint& joint, const std::vector<ScalarRow>& rows, int immovable,
                                              bool isotropic) {
  std::vector<std::vector<Expr>> K(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      Expr entry = joint.pool->number(0);
      for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
        if (static_cast<int>(b) == immovable) continue;
        const BodySymbols body = body_symbols(joint, static_cast<int>(b));
        const JacobianEntry& Ji = rows[i].J[b];
        const JacobianEntry& Jj = rows[j].J[b];
        const bool tensor = Ji.w->vector && !isotropic;
        const Expr turning = tensor         ? dot(Ji.w, apply(body.inv_I, Jj.w))
                             : Ji.w->vector ? body.inv_I * dot(Ji.w, Jj.w)
                                            : body.inv_I * (Ji.w * Jj.w);
        entry = entry + body.inv_m * dot(Ji.v, Jj.v) + turning;
      }
      K[i].push_back(entry);
    }
  }
  return K;
}

Block derive_rows(const Joint& joint, int immovable) {
  Block block;
  block.immovable = immovable;
  const std::vector<Expr> axes = world_axes(*joint.pool);
  for (const Row& row : joint.rows) {
    if (!row.C->vector) {
      block.rows.push_back(
          derive_row(joint, {row.name, &row, row.kind, -1, row.of_world, {}, {}, {}, {}, {}, {}}, row.C, immovable));
      continue;
    }
    for (std::size_t k = 0; k < axes.size(); ++k) {
      ScalarRow part{
          row.name + "_" + "xyz"[k], &row, row.kind, static_cast<int>(k), row.of_world, {}, {}, {}, {}, {}, {}};
      block.rows.push_back(derive_row(joint, std::move(part), dot(axes[k], row.C), immovable));
    }
  }
  return finished(joint, std::move(block));
}

Block derive_coordinate(const Joint& joint, const Coordinate& coordinate, int immovable) {
  Block block;
  block.name = coordinate.name;
  block.immovable = immovable;
  const RowKind kind = coordinate.by_rate ? RowKind::velocity : RowKind::equality;
  ScalarRow row{coordinate.name, nullptr, kind, -1, coordinate.of_world, {}, {}, {}, {}, {}, {}};
  block.rows.push_back(derive_row(joint, std::move(row), coordinate.value, immovable));
  return finished(joint, std::move(block));
}

}  // namespace cdot::derive
