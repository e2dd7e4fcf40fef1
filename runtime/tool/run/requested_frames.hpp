// Frames at requested times, which may lie inside a step.
#pragma once

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <cdot/world.hpp>

#include "runtime/state/pace.hpp"
#include "runtime/tool/run/frame.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {

// A second World starts from the state at the start of the step and takes a part of it, by the same method. A frame
// thus has the order of the method and closed joints. The run never notices: its steps have the same bits with and
// without requests. Steps whose end does not tend to their start as they become short have no such part: sweeps and
// baumgarte remove a share of C in every step. Their frames lie on a cubic.
template <class S>
class RequestedFrames {
 public:
  using Take = std::function<void(const Frame&)>;
  // The run's steps follow those of an earlier one and are noted, if these are not null: `paces` outlive this.
  RequestedFrames(const Scene& scene, const Paces* paced_by, const Paces* paces);

  // `take` receives the frames at these ascending times.
  void request(const std::vector<double>& times, Take take);
  // Call before a step from the frame `at` to the time `end`: notes the state of the run if a request lies inside.
  void before_step(const BasicWorld<S>& run, const Frame& at, double end);
  // Call after it with the frames of its ends; at the start of the run they are equal. If a part of the step fails,
  // says why: nothing knows the frame there.
  StepResult after_step(const Frame& before, const Frame& after);

 private:
  // Leads last_ to a time inside the step that began at `before`.
  StepResult go_to(const Frame& before, double time);

  struct Request {
    double time;
    std::size_t take;
  };
  const Scene& scene_;
  const Paces *paced_by_, *noted_;
  std::optional<Paces> paces_;  // of part_, for the same lengths
  double allowed_;              // local error of the present step
  double slack_;                // [s]: closer times count as equal
  bool adaptive_;               // the method interpolates: a part may go on from the last one
  bool takes_parts_;
  std::vector<Take> takes_;
  std::vector<Request> requests_;  // in the order of time
  std::size_t next_ = 0;
  Snapshot start_;                     // of the present step
  std::optional<BasicWorld<S>> part_;  // made for the first request inside a step
  std::optional<Frame> last_;          // of part_, in the present step
};

}  // namespace cdot
