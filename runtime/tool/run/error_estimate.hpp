// The error of a run's trajectory, estimated while it runs, for at most a twentieth of its steps and twenty more.
//
// Before some three or four steps the World takes them as one, goes back, and goes on. A method of order p errs in the
// n steps by e = d / (1 - n^p), d being the difference (E. Hairer, S. P. Norsett, G. Wanner, "Solving Ordinary
// Differential Equations I", 1993, II.4). That formula need not hold for a step of n times the length.
// Where such a step fails, is divided, or promises a warning, fewer are taken from its start on: two as one in short
// runs, or one in parts, dearer and true at longer steps. For sweeps a second World takes the step, with more of them.
// RK4 tells its errors by its own rates, but for steps with events.
//
// The errors of the steps add up with their signs, as those of a symplectic method cancel along an orbit: an error s of
// velocities displaces a body by s T, where T is the time in which the motion changes, the root of sum v^2 / sum a^2.
// Growth by chaos is not in it. Where a joint breaks or a row ends in the run's own steps, the samples need not see it:
// an error s of velocities by that (runtime/tool/watch/release_watch.hpp) displaces a body by s T, or by s t in the
// time t that is left, if it is shorter or no joint holds the body.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <cdot/world.hpp>

#include "runtime/tool/run/frame.hpp"
#include "runtime/tool/scene/scene.hpp"
#include "runtime/tool/watch/errors_by_rates.hpp"
#include "runtime/tool/watch/release_watch.hpp"

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
  // Call before step `k` of length h, counted from 1, and after it with the frames of its ends. The run goes on as if
  // neither had been called.
  void before_step(BasicWorld<S>& run, long long k, double h);
  void after_step(BasicWorld<S>& run, const Frame& before, const Frame& after, long long k);
  // Call after the last of so many steps.
  void finish(const Frame& last, long long steps);
  const TrajectoryError& error() const { return total_.error; }

 private:
  using Vector = std::array<double, 3>;
  struct Total {
    std::vector<BodyError> sums;  // by body
    Vector speeds{}, changes{};
    TrajectoryError error;
  };
  struct TimeScales {
    double linear, angular;  // T of positions and of angles [s]
  };
  enum class By { own_rates, longer_steps, pairs, shorter_steps, more_sweeps };

  void choose(By by);
  int longest_window() const;  // of By::longer_steps, in steps
  int steps_instead() const;   // of the run's World in a sample
  // Of a sample, in steps of the run.
  double price() const;
  long long never() const { return steps_ + 1; }
  // Finds the next sample after one that ends with step `k`.
  void find_next(long long k);
  // Takes the window in so many steps, from its start on, and compares.
  void take_anew(BasicWorld<S>& run, const std::vector<BodyState>& after, int steps);
  // False if one of them fails, or is divided. `expected`: the error of the window [m], 0 if it is not known.
  bool take_instead(BasicWorld<S>& world, int steps, double expected = 0);
  // From here on two steps as one or, if they were, parts of one. Takes them from the window's start on, and goes back.
  void take_fewer(BasicWorld<S>& run);
  void compare(const std::vector<BodyState>& after);
  // Adds the sample, unless there is none or it promises more than `most` of the share that warns.
  bool accept(const Frame& before, const Frame& after, long long k, double most);
  void add(const Frame& before, const Frame& after, long long k);
  void find_error_of_step();
  // The last sample stands for the steps since the one before it, and at the end of the run for those that follow.
  void add_sums(const Frame& after, long long k);
  // Of forces that ended too late.
  void add_releases(const Frame& last);
  TimeScales time_scales(const Frame& after) const;
  void judge(const Frame& after, std::size_t body, const TimeScales& scales);

  const Scene& scene_;
  const long long steps_;
  const double warned_;  // a share
  ErrorsByRates<S> rates_;
  ReleaseWatch<S> releases_;
  bool watches_ = false;
  By by_;
  int window_;                                    // steps of the run in a sample
  long long spacing_, next_, last_ = 0;           // first step of the next sample, last step of the previous one
  int parts_;                                     // of a step, By::shorter_steps
  double budget_, spent_ = 0;                     // for all samples, and on those so far, in steps
  Snapshot start_, end_;                          // of a window
  double length_ = 0;                             // of a step in it [s]
  bool taken_ = false;                            // the steps instead were, or those of the run tell their errors
  double share_ = 1;                              // of a difference that is the run's error
  std::optional<BasicWorld<S>> sweeper_;          // the second World
  std::vector<BodyState> instead_;                // at the end of the steps taken instead
  std::array<std::vector<BodyState>, 2> firsts_;  // after the first two steps of the window, of the run
  std::vector<BodyError> sample_;                 // the last one: errors of a window
  int window_of_sample_ = 1;
  double error_of_step_ = 0;  // in the last sample, as a share of its mechanism, times the size of the smallest [m]
  Total total_, kept_;        // and before the last sample
  std::vector<double> size_;  // of the mechanism of each body [m]; of a single point the distance that it travels
  std::vector<bool> is_point_;
  Frame first_;  // before the first sample
};

}  // namespace cdot
