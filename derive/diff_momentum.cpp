// A published Jacobian judged alone: moving all bodies together must not be felt by a joint that
// has nothing to do with the world, whatever C was.
#include <fmt/format.h>

#include "derive/diff_entry.hpp"

namespace cdot::derive {

// Judged where C = 0: a vector row in world axes turns with the bodies, and is zero only there
// after it.
void EntryJudge::judge_momentum(const Part& part, const Matrix& J) {
  if (joint_.uses_world || immovable_ >= 0) return;
  const std::vector<Expr> axes = world_axes(pool_);
  const int width = static_cast<int>(columns_per_body(joint_.dimension)), linear = joint_.dimension;
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
      Expr v = zero_vector(pool_), w = zero_spin(pool_);
      for (int k = 0; k < linear; ++k)
        v = v + J.at(r, b * width + k) * axes[static_cast<std::size_t>(k)];
      for (int k = linear; k < width; ++k) {
        const Expr entry = J.at(r, b * width + k);
        w = w + (linear == 2 ? entry : entry * axes[static_cast<std::size_t>(k - linear)]);
      }
      // A turn about the origin gives the centre at x the velocity w x x.
      moved = moved + v;
      turned = turned + w + cross(body_symbols(joint_, b).x, v);
    }
    if (!vanishes(moved))
      pushed.push_back(name_of_row(part, r));
    else if (!vanishes(turned))
      spun.push_back(name_of_row(part, r));
  }
  note_momentum(pushed, "momentum", "translation");
  note_momentum(spun, "angular momentum", "rotation");
}

void EntryJudge::note_momentum(const std::vector<std::string>& rows, const char* quantity,
                               const char* motion) {
  if (rows.empty()) return;
  std::string names;
  for (const std::string& row : rows) names += (names.empty() ? "" : ", ") + row;
  const bool one = rows.size() == 1;
  out_.remarks.push_back(
      fmt::format("{} {} of this J {} conservation of {}: a common {} of all bodies gives J v != 0",
                  one ? "row" : "rows", names, one ? "breaks" : "break", quantity, motion));
}

}  // namespace cdot::derive
