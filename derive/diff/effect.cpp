// Published energies, forces and slopes of an effect against the generated ones. Both are written over the bodies: what
// the law reads of them, a coordinate or its rate, gives way to the row behind it.
#include <algorithm>
#include <fmt/format.h>

#include "derive/diff/entry.hpp"
#include "derive/expression/components.hpp"

namespace cdot::derive {
namespace {

const Rational hair(1, 100000);  // of central differences

Expr zero_of(const Entry& entry) { return entry.pool().number(0); }

// The leaves of the law by what stands behind them, with one of them moved by `amount`.
std::map<const Node*, Expr> behind(const Entry& entry, const std::vector<Expr>& leaves, bool rates, std::size_t moved,
                                   Rational amount) {
  std::map<const Node*, Expr> replacements;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    if (!leaves[i]) continue;
    const Expr e = rates ? entry.block.rows[i].Cdot : entry.block.rows[i].C;
    replacements.emplace(&*leaves[i], i == moved ? e + entry.pool().number(amount) : e);
  }
  return replacements;
}

// e over the bodies. A leaf of the values, or of the rates, may be moved.
Expr over_bodies(const Entry& entry, Expr e, std::size_t value = ~std::size_t{0}, std::size_t rate = ~std::size_t{0},
                 Rational amount = 0) {
  auto replacements = behind(entry, entry.law->value, false, value, amount);
  replacements.merge(behind(entry, entry.law->rate, true, rate, amount));
  for (const LawInput& input : entry.joint.law->inputs) {
    if (!input.rate->vector) continue;
    for (const Expr leaf : {input.value, input.rate}) {
      if (!leaf) continue;
      Components components;
      const std::vector<Expr> axes = world_axes(entry.pool());
      const std::vector<Expr> parts = components.of_vector(leaf);
      Expr sum = zero_vector(entry.pool());
      for (std::size_t k = 0; k < parts.size(); ++k) sum = sum + replacements.at(&*parts[k]) * axes[k];
      replacements.emplace(&*leaf, sum);
    }
  }
  return substitute(e, replacements);
}

// The part of the force along row i that no energy stores, with vectors as the spec writes them.
Expr unstored_along(const Entry& entry, std::size_t i) {
  std::size_t first = 0;
  for (const LawInput& input : entry.joint.law->inputs) {
    const std::size_t rows = input.rate->vector ? static_cast<std::size_t>(entry.joint.dimension) : 1;
    if (i >= first + rows) {
      first += rows;
      continue;
    }
    if (!input.force || !input.rate->vector) break;
    std::map<const Node*, Expr> vectors;
    for (std::size_t k = 0, row = 0; k < entry.joint.law->inputs.size(); ++k) {
      const LawInput& leaf = entry.joint.law->inputs[k];
      const Expr C = entry.block.rows[row].row->C;
      row += leaf.rate->vector ? static_cast<std::size_t>(entry.joint.dimension) : 1;
      if (!leaf.rate->vector || !leaf.value) continue;
      vectors.emplace(&*leaf.value, C);
      vectors.emplace(&*leaf.rate, time_derivative(C, entry.joint));
    }
    return components_of(over_bodies(entry, substitute(input.force, vectors)))[i - first];
  }
  return over_bodies(entry, entry.law->unstored[i]);
}

// The whole force along row i.
Expr force_along(const Entry& entry, std::size_t i) {
  return entry.law->energy ? over_bodies(entry, entry.law->force[i]) : unstored_along(entry, i);
}

// The rows along which the law pushes.
std::vector<std::size_t> acting_rows(const Entry& entry, const Part& part) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < entry.law->force.size(); ++i) {
    const std::string& name = entry.block.rows[i].row->name;
    const bool meant = part.hand->rows.empty() || std::ranges::count(part.hand->rows, name) > 0 ||
                       std::ranges::count(part.hand->rows, entry.block.rows[i].name) > 0;
    if (meant && !is_zero(entry.law->force[i])) rows.push_back(i);
  }
  return rows;
}

// Of one item: the generated numbers, and the numbers by central differences beside which both are measured.
struct Side {
  Matrix generated;
  std::function<double(int row, int column, const Sample&)> measured;
  std::string how;
};

double half_difference(Expr after, Expr before, const Sample& sample) {
  const std::vector<double> v = values_at({after, before}, sample);
  return (v[0] - v[1]) / (2 * hair.value());
}

// Along row i: -dE/ds and what has no energy.
Side force_side(const Entry& entry, const std::vector<std::size_t>& rows) {
  Side side{{static_cast<int>(rows.size()), 1, {}},
            {},
            entry.law->energy ? "the slope of the energy" : "the law of the spec"};
  for (const std::size_t i : rows) side.generated.entries.push_back(force_along(entry, i));
  side.measured = [&entry, rows](int r, int, const Sample& sample) {
    const std::size_t i = rows[static_cast<std::size_t>(r)];
    double force = values_at({over_bodies(entry, entry.law->unstored[i])}, sample)[0];
    if (entry.law->energy && entry.law->value[i])
      force -= half_difference(over_bodies(entry, entry.law->energy, i, ~std::size_t{0}, hair),
                               over_bodies(entry, entry.law->energy, i, ~std::size_t{0}, -hair), sample);
    return force;
  };
  return side;
}

// -dF/ds, or -dF/d(rate of s).
Side slope_side(const Entry& entry, const std::vector<std::size_t>& rows, bool by_rates) {
  const int n = static_cast<int>(rows.size());
  Side side{{n, n, {}}, {}, "central differences of the force"};
  const auto& slopes = by_rates ? entry.law->damping : entry.law->stiffness;
  for (const std::size_t i : rows)
    for (const std::size_t j : rows) side.generated.entries.push_back(over_bodies(entry, slopes[i][j]));
  side.measured = [&entry, rows, by_rates](int r, int c, const Sample& sample) {
    const Expr force = entry.law->force[rows[static_cast<std::size_t>(r)]];
    const std::size_t j = rows[static_cast<std::size_t>(c)], none = ~std::size_t{0};
    const auto moved = [&](Rational amount) {
      return over_bodies(entry, force, by_rates ? none : j, by_rates ? j : none, amount);
    };
    return -half_difference(moved(hair), moved(-hair), sample);
  };
  return side;
}

// Forces and torques on the bodies, J^T F: a column with a number for each column of J.
Side wrench_side(const Entry& entry) {
  const std::vector<std::vector<Expr>> J = columns_of(std::span<const ScalarRow>(entry.block.rows));
  const int width = static_cast<int>(J.empty() ? 0 : J[0].size());
  Side side{{width, 1, {}}, {}, "virtual work"};
  for (int c = 0; c < width; ++c) {
    Expr sum = zero_of(entry);
    for (std::size_t i = 0; i < J.size(); ++i) sum = sum + J[i][static_cast<std::size_t>(c)] * force_along(entry, i);
    side.generated.entries.push_back(sum);
  }
  ScalarRow energy;
  energy.C = entry.law->energy ? over_bodies(entry, entry.law->energy) : zero_of(entry);
  side.measured = [&entry, energy, width](int c, int, const Sample& sample) {
    Motion along(static_cast<std::size_t>(width));
    along[static_cast<std::size_t>(c)] = 1;
    double work = -rate_along(entry.joint, energy, sample, along, 0);
    for (std::size_t i = 0; i < entry.law->unstored.size(); ++i)
      if (!is_zero(entry.law->unstored[i]))
        work += values_at({over_bodies(entry, entry.law->unstored[i])}, sample)[0] *
                rate_along(entry.joint, entry.block.rows[i], sample, along, 0);
    return work;
  };
  return side;
}

// "force on a", "torque on a": of the columns of J.
std::vector<Group> groups_of_wrench(const Entry& entry) {
  std::vector<Group> groups;
  const int linear = entry.joint.dimension, angular = linear == 2 ? 1 : 3;
  for (const std::string& body : entry.joint.bodies)
    for (const auto& [what, count] : {std::pair{"force", linear}, {"torque", angular}})
      groups.push_back(
          {groups.empty() ? 0 : groups.back().first + groups.back().count, count, fmt::format("{} on {}", what, body)});
  return groups;
}

// Rows of one vector form a group.
std::vector<Group> groups_of_law(const Entry& entry, const std::vector<std::size_t>& rows) {
  std::vector<Group> groups;
  const Row* before = nullptr;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Row* const row = entry.block.rows[rows[k]].row;
    if (row == before) ++groups.back().count;
    else groups.push_back({static_cast<int>(k), 1, row->name});
    before = row;
  }
  return groups;
}

// Of one number: "force on a.x".
std::string name_in(const std::vector<Group>& groups, int i) {
  const auto group = std::ranges::find_if(groups, [&](const Group& g) { return i < g.first + g.count; });
  return group->count == 1 ? group->name : fmt::format("{}.{}", group->name, "xyz"[i - group->first]);
}

void judge_side(Entry& entry, const HandItem& item, const Side& side, const std::vector<Group>& rows,
                const std::vector<Group>& columns) {
  const Matrix& published = *item.value;
  if (published.rows != side.generated.rows || published.columns != side.generated.columns)
    return compare_sizes(entry, item, item.what, published, side.generated);
  compare(entry, {item.what, published, side.generated, rows, columns}, [&](int r, int c) {
    const Place place{item.what, name_in(rows, r), name_in(columns, c), {}, {}, &entry.joint};
    const Expr hand = entry.as_assumed(published.at(r, c)), right = entry.as_assumed(side.generated.at(r, c));
    Difference d = describe_difference(place, hand, right, entry.poses());
    d.confirmed = entry.confirm().against([&](const Sample& sample) { return side.measured(r, c, sample); }, right,
                                          hand, side.how);
    return finished(entry, item, std::move(d), hand, right);
  });
}

// Forces without an energy: the rate of the published one is not what they take.
void no_energy(Entry& entry, const HandItem& item) {
  const Expr published = item.value->entries[0];
  Expr taken = zero_of(entry);
  for (std::size_t i = 0; i < entry.law->force.size(); ++i)
    taken = taken - force_along(entry, i) * entry.block.rows[i].Cdot;
  const auto measured = [&](const Sample& sample) {
    double power = 0;
    for (std::size_t i = 0; i < entry.law->force.size(); ++i)
      power += values_at({force_along(entry, i)}, sample)[0] * entry.confirm().rate(entry.block.rows[i], sample);
    return -power;
  };
  add_plain(entry, item, {item.what, "", "", {}, {}, &entry.joint}, "extra term",
            "the forces of this effect have no energy",
            entry.confirm().against(measured, taken, time_derivative(published, entry.joint), "minus their power"));
}

// An energy is known up to a constant: what counts is its rate along every motion.
void judge_energy(Entry& entry, const HandItem& item) {
  if (item.value->entries.size() != 1) return compare_sizes(entry, item, item.what, *item.value, {1, 1, {}});
  if (!entry.law->energy) return no_energy(entry, item);
  const Expr generated = over_bodies(entry, entry.law->energy), published = item.value->entries[0];
  if (entry.equal(published, generated)) return;
  const Expr rate = time_derivative(generated, entry.joint), claimed = time_derivative(published, entry.joint);
  if (entry.equal(claimed, rate)) {
    entry.verdict.remarks.push_back("its energy is 0 elsewhere: a constant more or less changes no force");
    return;
  }
  const Matrix right{1, 1, {generated}};
  compare(entry, {item.what, *item.value, right, {{0, 1, ""}}, {{0, 1, ""}}}, [&](int, int) {
    Difference d = describe_difference({item.what, "", "", {}, {}, &entry.joint}, entry.as_assumed(published),
                                       entry.as_assumed(generated), entry.poses());
    ScalarRow row;
    row.C = generated;
    d.confirmed = entry.confirm().against([&](const Sample& sample) { return entry.confirm().rate(row, sample); }, rate,
                                          claimed, "its rate by central differences of the energy");
    return finished(entry, item, std::move(d), published, generated);
  });
}

}  // namespace

void read_over_bodies(Entry& entry) {
  for (std::size_t i = 0; i < entry.joint.law->inputs.size(); ++i) {
    const LawInput& input = entry.joint.law->inputs[i];
    for (const ScalarRow& row : entry.block.rows)  // kernels and people know it by this name
      if (row.row->name == input.name && row.component < 0 && row.C->name.empty())
        entry.pool().name(row.C, input.name, true);
  }
  const auto all = [&](std::optional<Matrix>& m) {
    if (m)
      for (Expr& e : m->entries) e = over_bodies(entry, e);
  };
  for (HandPart& part : entry.hand.parts)
    for (HandItem& item : part.items) {
      all(item.value), all(item.right);
      for (Expr* e : {&item.expression, &item.right_expression})
        if (*e) *e = over_bodies(entry, *e);
    }
  for (HandAssumption& a : entry.hand.assumptions) {
    all(a.left), all(a.right);
    for (Expr* e : {&a.left_expression, &a.right_expression})
      if (*e) *e = over_bodies(entry, *e);
  }
}

std::vector<Expr> expressions_of_law(const Entry& entry) {
  std::vector<Expr> all;
  const auto take = [&](Expr e) {
    if (e) all.push_back(over_bodies(entry, e));
  };
  const DerivedLaw& law = *entry.law;
  take(law.energy);
  for (const auto* forces : {&law.force, &law.unstored})
    for (const Expr e : *forces) take(e);
  for (const auto* slopes : {&law.stiffness, &law.damping})
    for (const auto& row : *slopes)
      for (const Expr e : row) take(e);
  for (std::size_t i = 0; i < law.force.size(); ++i) all.push_back(force_along(entry, i));
  return all;
}

void judge_law(Entry& entry, const Part& part, const HandItem& item) {
  if (item.what == "energy") return judge_energy(entry, item);
  const std::vector<std::size_t> acting = acting_rows(entry, part);
  const std::vector<Group> one = {{0, 1, ""}};
  if (item.what == "wrench") return judge_side(entry, item, wrench_side(entry), groups_of_wrench(entry), one);
  const std::vector<Group> rows = groups_of_law(entry, acting);
  if (item.what == "force") return judge_side(entry, item, force_side(entry, acting), rows, one);
  judge_side(entry, item, slope_side(entry, acting, item.what == "damping"), rows, rows);
}

}  // namespace cdot::derive
