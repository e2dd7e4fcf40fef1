#include "runtime/tool/watch/rank_watch.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "runtime/tool/watch/worst.hpp"

namespace cdot {
namespace {

// A loss is the bottom of a dip: before and after it the distance is so many times as large.
constexpr double dip = 5;

}  // namespace

// The bottom of a dip; `falls_only`: the run ends in it.
void RankWatch::note(bool falls_only) {
  const bool fell = dip * dip * least_.row.share < peak_, began_in_it = first_ && !falls_only;
  first_ = false;
  if (is_near_loss(least_.row) && (fell || began_in_it)) found_.push_back(least_);
}

void RankWatch::look(double time, const WeakestRow& now) {
  if (now.joint < 0) return;
  if (least_.row.joint < 0 || now.share < least_.row.share) least_ = {time, now};
  if (now.share > dip * dip * least_.row.share) {
    note(false);
    least_ = {time, now};
    peak_ = now.share;
  }
  peak_ = std::max(peak_, now.share);
}

void RankWatch::end() {
  note(true);
  least_ = {};
}

std::string rank_losses_text(const Scene& scene, const std::vector<RankLoss>& losses) {
  if (losses.empty()) return {};
  const RankLoss& nearest = *std::min_element(
      losses.begin(), losses.end(), [](const RankLoss& a, const RankLoss& b) { return a.row.share < b.row.share; });
  return fmt::format(
      "nearly lost {} time{}, first at t = {:.4g} s; nearest at t = {:.4g} s, where the pivot of row {} of "
      "{} is {:.1e} of its diagonal",
      losses.size(), losses.size() == 1 ? "" : "s", losses.front().time, nearest.time, nearest.row.row + 1,
      joint_name(scene, nearest.row.joint), nearest.row.share);
}

}  // namespace cdot
