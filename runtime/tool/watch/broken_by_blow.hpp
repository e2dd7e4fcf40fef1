// Joints and ropes that break by a blow, where a method takes steps of equal length. These pass the blow on as a whole
// before they break, although a part of it breaks them: no step in which an end strikes resolves its force.
#pragma once

#include <limits>
#include <vector>

#include <cdot/world.hpp>

namespace cdot {

struct BrokenByBlow {
  int joint = -1;           // -1: none
  double share_before = 0;  // of its strength, which it carried a step before
  double time = 0;          // [s], of the step's end
};

class BlowWatch {
 public:
  // After every step: notes the first joint that broke in a step in which an end of its mechanism began to press, and
  // that would have held by the growth of its load before.
  template <class S>
  void look(BasicWorld<S>& world, double time);
  const BrokenByBlow& found() const { return found_; }

 private:
  // From breaking, after the last two steps, as shares of the strength.
  struct Distances {
    static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    double last = unknown, last_but_one = unknown;
    void add(double now) { last_but_one = last, last = now; }
  };

  template <class S>
  void find_struck_islands(const WorldData<S>& world);
  template <class S>
  void look_at_bonds(const WorldData<S>& world, double time);
  template <class S>
  void look_at_rows(const WorldData<S>& world, double time);
  void note(int joint, const Distances& before, double time);

  std::vector<Distances> of_bonds_;
  std::vector<std::vector<Distances>> of_rows_;  // that act until they carry too much, by batch and home
  std::vector<std::vector<char>> pressed_;       // ends that pressed in the last step, by batch and home
  std::vector<char> struck_;                     // islands with an end that began to press in this step
  BrokenByBlow found_;
};

}  // namespace cdot
