// Judges a published Jacobian alone: a common motion of all bodies must not change a joint without the world, whatever
// C is.
#include <fmt/format.h>

#include "derive/diff/entry.hpp"
#include "derive/expression/symbols.hpp"

namespace cdot::derive {
namespace {

// The factor of each angular column in J_w: 1 in the plane, an axis in space; J_w = 1/2 J_e G^T for Euler parameters.
std::vector<Expr> turns_of_columns(const Entry& entry, int body) {
  Pool& pool = entry.pool();
  if (entry.joint.dimension == 2) return {pool.number(1)};
  if (entry.form == Form::global) return world_axes(pool);
  if (entry.form == Form::local) return body_axes(pool, body);
  std::vector<Expr> turns;
  const std::vector<Expr> axes = world_axes(pool);
  for (std::size_t i = 0; i < 3; ++i) {
    // Row i of 2 G: columns_in of the row [0, e_i].
    std::vector<Expr> row(6, pool.number(0));
    row[3 + i] = pool.number(1);
    const std::vector<Expr> columns = columns_in(entry.form, row, entry.joint, body);
    for (std::size_t m = 0; m < 4; ++m) {
      const Expr turn = Rational(1, 4) * (columns[3 + m] * axes[i]);
      if (i == 0) turns.push_back(turn);
      else turns[m] = turns[m] + turn;
    }
  }
  return turns;
}

void note_momentum(Entry& entry, const std::vector<std::string>& rows, const char* quantity, const char* motion) {
  if (rows.empty()) return;
  std::string names;
  for (const std::string& row : rows) names += (names.empty() ? "" : ", ") + row;
  const bool one = rows.size() == 1;
  entry.verdict.remarks.push_back(
      fmt::format("{} {} of this J {} conservation of {}: a common {} of all bodies gives J v != 0",
                  one ? "row" : "rows", names, one ? "breaks" : "break", quantity, motion));
}

}  // namespace

// Judged where C = 0: a vector row in world axes rotates with the bodies, so it stays zero only if it was zero.
void judge_momentum(Entry& entry, const Part& part, const Matrix& J) {
  if (entry.immovable >= 0) return;
  Pool& pool = entry.pool();
  const std::vector<Expr> axes = world_axes(pool);
  const Poses& there = entry.poses_on_constraint();
  if (there.empty()) return;
  const auto vanishes = [&](Expr e) {
    for (const Expr component : components_of(e)) {
      if (!there.equal(component, pool.number(0))) return false;
    }
    return true;
  };
  std::vector<std::string> pushed, spun;  // rows that feel a common translation, rotation
  for (int r = 0; r < J.rows && r < static_cast<int>(part.rows.size()); ++r) {
    if (part.rows[static_cast<std::size_t>(r)].of_world) continue;
    Expr moved = zero_vector(pool), turned = zero_spin(pool);
    for (int b = 0; b < static_cast<int>(entry.joint.bodies.size()); ++b) {
      const int first = b * entry.width();
      Expr v = zero_vector(pool), w = zero_spin(pool);
      for (int k = 0; k < entry.joint.dimension; ++k) {
        v = v + J.at(r, first + k) * axes[static_cast<std::size_t>(k)];
      }
      const std::vector<Expr> turns = turns_of_columns(entry, b);
      for (int k = entry.joint.dimension; k < entry.width(); ++k) {
        w = w + J.at(r, first + k) * turns[static_cast<std::size_t>(k - entry.joint.dimension)];
      }
      // A rotation about the origin gives the centre at x the velocity w x x.
      moved = moved + v;
      turned = turned + w + cross(body_symbols(entry.joint, b).x, v);
    }
    if (!vanishes(moved)) pushed.push_back(name_of_row(part, r));
    else if (!vanishes(turned)) spun.push_back(name_of_row(part, r));
  }
  note_momentum(entry, pushed, "momentum", "translation");
  note_momentum(entry, spun, "angular momentum", "rotation");
}

}  // namespace cdot::derive
