// The steps of a run -> the lengths of the steps of a further run of the same motion, with another local error.
//
// A step of length h whose error is x times the allowed one could have been b = h x^(-1/p) long, p being the order of
// the estimate. b is short where the motion is quick, in both runs. The further run takes steps of c b by the b of the
// first. The factor c begins at (e / e_first)^(1/p), e being the local errors, and follows the errors of the further
// run. The control by the last error alone learns that a motion quickens from a step that was too long.
#pragma once

#include <limits>
#include <map>
#include <vector>

namespace cdot {

// The steps of an island.
class Pace {
 public:
  // A step of this length from `time` on could have been `best` long.
  void note(double time, double length, double best);
  // The best length of a step with this middle, interpolated.
  double at(double middle) const;

 private:
  struct Point {
    double time, best;
  };
  std::vector<Point> points_;
};

// Lengths in units of the longest that has the allowed error, unless a run notes its steps.
inline constexpr double usual_safety = 0.9;

// The steps of a run, by islands, each known by its first body.
class Paces {
 public:
  explicit Paces(double local_error, double safety = usual_safety,
                 double longest = std::numeric_limits<double>::infinity())
      : local_error_(local_error), safety_(safety), longest_(longest) {}
  double local_error() const { return local_error_; }
  // Steps from `time` on may have this local error.
  void loosen(double time, double local_error) { looser_.push_back({time, local_error}); }
  // The local error of steps from `time` on.
  double allowed(double time) const;
  double safety() const { return safety_; }
  // [s] No step of the run is longer.
  double longest() const { return longest_; }
  void note(int body, double time, double length, double best) { of_[body].note(time, length, best); }
  const Pace* find(int body) const;

 private:
  double local_error_, safety_, longest_;
  struct Looser {
    double from, local_error;
  };
  std::vector<Looser> looser_;  // in the order of time
  std::map<int, Pace> of_;
};

// One step of a further run.
class PacedStep {
 public:
  // From `time` on. `proposed`: its length, by next() after the step before; c follows from it.
  PacedStep(const Pace& pace, double safety, double time, double proposed);
  // The first step.
  static PacedStep first(const Pace& pace, double safety, double time, double c);

  double proposed() const { return proposed_; }
  // A try of this length could have been `best` long.
  void learn(double length, double best);
  // The length of a step from `time` on, where the last one could have been `best` long.
  double next(double time, double best) const;

 private:
  PacedStep(const Pace& pace, double safety, double time) : pace_(pace), safety_(safety), time_(time) {}
  const Pace& pace_;
  double safety_, time_, proposed_ = 0, c_ = 0;
};

}  // namespace cdot
