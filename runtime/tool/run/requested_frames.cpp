#include "runtime/tool/run/requested_frames.hpp"

#include <algorithm>

#include "runtime/state/world_data.hpp"

namespace cdot {
namespace {

constexpr double close_time = 1e-6;  // of a step

}  // namespace

template <class S>
RequestedFrames<S>::RequestedFrames(const Scene& scene, const Paces* paced_by, const Paces* paces)
    : scene_(scene),
      paced_by_(paced_by),
      noted_(paces),
      allowed_(scene.settings.local_error),
      slack_(close_time * scene.step),
      adaptive_(scene.settings.local_error > 0),
      takes_parts_(!sweeps(scene.settings.solver) && scene.settings.drift != Drift::baumgarte) {
  if (paces) paces_.emplace(paces->local_error(), paces->safety(), paces->longest());
}

template <class S>
void RequestedFrames<S>::request(const std::vector<double>& times, Take take) {
  for (const double time : times) requests_.push_back({time, takes_.size()});
  takes_.push_back(std::move(take));
  std::stable_sort(requests_.begin(), requests_.end(),
                   [](const Request& a, const Request& b) { return a.time < b.time; });
}

template <class S>
void RequestedFrames<S>::before_step(const BasicWorld<S>& run, const Frame& at, double end) {
  last_.reset();
  if (noted_) allowed_ = noted_->allowed(at.time);
  const bool lies_inside =
      next_ < requests_.size() && requests_[next_].time > at.time + slack_ && requests_[next_].time < end - slack_;
  if (takes_parts_ && lies_inside) run.snapshot_into(start_);
}

template <class S>
StepResult RequestedFrames<S>::after_step(const Frame& before, const Frame& after) {
  for (; next_ < requests_.size() && requests_[next_].time <= after.time + slack_; ++next_) {
    const double time = requests_[next_].time;
    const bool at_end = time >= after.time - slack_;
    Frame frame = after;
    if (!at_end && !takes_parts_) frame = between(before, after, time);
    if (!at_end && takes_parts_) {
      if (const StepResult part = go_to(before, time); !part) return part;
      frame = *last_;
    }
    frame.time = time;
    takes_[requests_[next_].take](frame);
  }
  return {};
}

template <class S>
StepResult RequestedFrames<S>::go_to(const Frame& before, double time) {
  if (last_ && last_->time == time) return {};
  if (!part_) {
    part_ = build_world_in<S>(scene_);
    part_->data().paced_by = paced_by_, part_->data().paces = paces_ ? &*paces_ : nullptr;
    part_->on_failure(OnFailure::retry);  // the step itself succeeded
  }
  part_->data().settings.local_error = allowed_;
  const bool goes_on = adaptive_ && last_;
  const Frame start = goes_on ? *last_ : before;
  if (!goes_on) part_->restore(start_);
  if (const StepResult part = part_->step(time - start.time); !part) return part;
  last_ = frame_of(*part_, time, static_cast<int>(before.bodies.size()));
  read_sensors(scene_, *part_, start, *last_);
  return {};
}

#define CDOT_INSTANTIATE(S) template class RequestedFrames<S>;
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
