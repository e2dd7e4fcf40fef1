// A published Jacobian judged alone: moving all bodies together must not be felt by a joint that
// has nothing to do with the world, whatever C was.
#include <fmt/format.h>

#include "derive/diff/entry.hpp"
#include "derive/expression/symbols.hpp"

namespace cdot::derive {

// What multiplies the column of each rate of turning in J_w: nothing in the plane, axes in space;
// J_w = 1/2 J_e G^T for those of Euler parameters.
std::vector<Expr> EntryJudge::turns_of_columns(int body) const {
  if (joint_.dimension == 2) return {pool_.number(1)};
  if (form_ == Form::global) return world_axes(pool_);
  if (form_ == Form::local) return body_axes(pool_, body);
  std::vector<Expr> turns;
  const std::vector<Expr> axes = world_axes(pool_);
  for (std::size_t i = 0; i < 3; ++i) {
    // The row i of 2 G, as columns_in makes it of the row [0, e_i].
    std::vector<Expr> row(6, pool_.number(0));
    row[3 + i] = pool_.number(1);
    const std::vector<Expr> columns = columns_in(form_, row, joint_, body);
    for (std::size_t m = 0; m < 4; ++m) {
      const Expr turn = Rational(1, 4) * (columns[3 + m] * axes[i]);
      if (i == 0) turns.push_back(turn);
      else turns[m] = turns[m] + turn;
    }
  }
  return turns;
}

// Judged where C = 0: a vector row in world axes turns with the bodies, and is zero only there
// after it.
void EntryJudge::judge_momentum(const Part& part, const Matrix& J) {
  if (joint_.uses_world || immovable_ >= 0) return;
  const std::vector<Expr> axes = world_axes(pool_);
  const Poses& there = poses_on_constraint();
  if (there.empty()) return;
  const auto vanishes = [&](Expr e) {
    for (const Expr component : components_of(e)) {
      if (!there.equal(component, pool_.number(0))) return false;
    }
    return true;
  };
  std::vector<std::string> pushed, spun;  // rows that feel a common translation, rotation
  for (int r = 0; r < J.rows && r < static_cast<int>(part.rows.size()); ++r) {
    Expr moved = zero_vector(pool_), turned = zero_spin(pool_);
    for (int b = 0; b < static_cast<int>(joint_.bodies.size()); ++b) {
      const int first = b * width();
      Expr v = zero_vector(pool_), w = zero_spin(pool_);
      for (int k = 0; k < joint_.dimension; ++k) {
        v = v + J.at(r, first + k) * axes[static_cast<std::size_t>(k)];
      }
      const std::vector<Expr> turns = turns_of_columns(b);
      for (int k = joint_.dimension; k < width(); ++k) {
        w = w + J.at(r, first + k) * turns[static_cast<std::size_t>(k - joint_.dimension)];
      }
      // A turn about the origin gives the centre at x the velocity w x x.
      moved = moved + v;
      turned = turned + w + cross(body_symbols(joint_, b).x, v);
    }
    if (!vanishes(moved)) pushed.push_back(name_of_row(part, r));
    else if (!vanishes(turned)) spun.push_back(name_of_row(part, r));
  }
  note_momentum(pushed, "momentum", "translation");
  note_momentum(spun, "angular momentum", "rotation");
}

void EntryJudge::note_momentum(const std::vector<std::string>& rows, const char* quantity, const char* motion) {
  if (rows.empty()) return;
  std::string names;
  for (const std::string& row : rows) names += (names.empty() ? "" : ", ") + row;
  const bool one = rows.size() == 1;
  out_.remarks.push_back(fmt::format("{} {} of this J {} conservation of {}: a common {} of all bodies gives J v != 0",
                                     one ? "row" : "rows", names, one ? "breaks" : "break", quantity, motion));
}

}  // namespace cdot::derive
