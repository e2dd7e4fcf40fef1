// A number as a function of time: a force, a target, a speed, a length. A parameter of a joint or of an effect may
// follow one: NamedValue::in_time. Steps allocate nothing for it, and the same time gives the same bits.
//
//   Profile ramp = Profile::table({.times = {0, 1, 5}, .values = {0, 2, 2}});
//   Profile swing = Profile::function([](double t) -> ProfileValue {
//     return {std::sin(t), std::cos(t), -std::sin(t)};
//   });
//   world.add_joint({"push", {rod}, {{"pa", {0, 0}}, in_time("F", {swing, 0.0})}, {}});
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

namespace cdot {

// A value with its first and second derivative by time.
struct ProfileValue {
  double value = 0, rate = 0, acceleration = 0;
};

enum class Interpolation {
  step,    // the value of the last row
  linear,  // two rows of the same time are a jump
  cubic    // a spline with a continuous second derivative; through four rows or more, cubics are exact
};

enum class Beyond {
  hold,   // before the first row its value, after the last one its value
  repeat  // again from the first row; its period is the time between the first and the last row
};

struct ProfileTable {
  std::vector<double> times, values;  // times grow
  Interpolation interpolation = Interpolation::linear;
  Beyond beyond = Beyond::hold;
};

// The times between which a step takes the numbers: those from `from` to `until`, also at its ends. A step of a method
// that ends at a jump sees the value before the jump, and the next step the value after it.
struct ProfileSpan {
  double from = -std::numeric_limits<double>::infinity(), until = std::numeric_limits<double>::infinity();
};

class Profile {
 public:
  class Course;

  Profile() = default;  // follows nothing
  Profile(double constant);
  // Throws cdot::Error if the table is not one.
  static Profile table(ProfileTable table);
  // The derivatives matter where the number stands in C, in a prescribed speed or in an energy. `of` must be a function
  // of the time alone, smooth, and safe to call from several threads.
  static Profile function(std::function<ProfileValue(double time)> of);

  explicit operator bool() const { return course_ != nullptr; }
  // At a jump the value after it, unless the span ends there.
  ProfileValue at(double time, const ProfileSpan& span = {}) const;
  // The first time after `after` at which the derivative of this order or a lower one jumps (0: the value itself).
  // Infinite if there is none.
  double next_break(double after, int order) const;
  // The smallest and the largest of the values that are known: the rows of a table. Infinite for a function.
  double least() const, most() const;
  std::uint64_t hash() const;  // of its values at a few times

 private:
  std::shared_ptr<const Course> course_;
};

}  // namespace cdot
