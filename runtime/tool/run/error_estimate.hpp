// The error of a run's trajectory, estimated while it runs, for a few per cent of its cost.
//
// Before some steps the World takes the step in three parts and goes back; for sweeps a second World takes it, with
// more of them. A method of order p errs in the step by e = d / (1 - 3^-p), d being the difference (E. Hairer, S. P.
// Norsett, G. Wanner, "Solving Ordinary Differential Equations I", 1993, II.4). The errors of the steps add up with
// their signs, as those of a symplectic method cancel along an orbit: an error s of velocities displaces a body by
// s T, where T is the time in which the motion changes, the root of sum v^2 / sum a^2. Growth by chaos is not in it.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <cdot/world.hpp>

#include "runtime/tool/run/frame.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {

struct TrajectoryError {
  double position = 0, angle = 0;  // the largest of a body so far [m], [rad]
  double share = 0;                // the larger of the angle and of the position in sizes of the body's mechanism
  double time = 0;                 // of the share [s]
  int body = -1;                   // of the share
  int samples = 0;                 // 0: no estimate
};

template <class S>
class ErrorEstimate {
 public:
  // Of a run of `steps` steps.
  ErrorEstimate(const Scene& scene, long long steps);
  // Call before step `k` of length h, counted from 1, and after it with the frames of its ends.
  void before_step(BasicWorld<S>& run, long long k, double h);
  void after_step(const Frame& before, const Frame& after, long long k);
  const TrajectoryError& error() const { return error_; }

 private:
  using Vector = std::array<double, 3>;
  struct Sums {
    Vector position{}, angle{}, velocity{}, spin{};  // of a body's errors
  };
  bool take_finer_step(BasicWorld<S>& run, double h);
  void add(const Frame& before, const Frame& after, double steps);
  void judge(const Frame& after, std::size_t body, double linear, double angular);

  const Scene& scene_;
  double share_;  // 1 / (1 - 3^-p)
  long long spacing_, next_, last_ = 0;
  Snapshot start_;
  std::optional<BasicWorld<S>> sweeper_;  // the second World
  std::vector<BodyState> finer_;          // at the end of the finer step; empty: that failed
  std::vector<Sums> sums_;
  std::vector<double> size_;  // of the mechanism of each body [m]; of a single point the distance that it travels
  std::vector<bool> is_point_;
  Frame first_;  // before the first sample
  Vector speeds_{}, changes_{};
  TrajectoryError error_;
};

}  // namespace cdot
