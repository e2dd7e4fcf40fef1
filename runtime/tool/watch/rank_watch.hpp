// The times of a run at which K nearly loses rank: a row becomes redundant there, two branches of the motion may cross,
// and forces may grow without bound.
#pragma once

#include <vector>

#include <cdot/world.hpp>

#include "runtime/tool/scene/scene.hpp"

namespace cdot {

// The square root of a pivot's share is the distance from the loss of rank, in rad or in arms. Below this one K nearly
// loses rank.
inline bool is_near_loss(const WeakestRow& row) {
  constexpr double near = 0.05;
  return row.joint >= 0 && row.share < near * near;
}

struct RankLoss {
  double time = 0;  // [s], of the nearest step's end
  WeakestRow row;
};

class RankWatch {
 public:
  // After every step.
  void look(double time, const WeakestRow& now);
  void end();
  const std::vector<RankLoss>& found() const { return found_; }

 private:
  void note(bool falls_only);
  double peak_ = 0;    // since the last loss
  bool first_ = true;  // none yet
  RankLoss least_;
  std::vector<RankLoss> found_;
};

// For a person: "14 times, first at t = ...", without a line end; empty if there was none.
std::string rank_losses_text(const Scene& scene, const std::vector<RankLoss>& losses);

}  // namespace cdot
