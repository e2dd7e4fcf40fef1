// Blows that decide whether joints and ropes break, where a method takes steps of equal length. These end a blow in the
// step after the one in which an end is met. A joint that the first part breaks takes no second part, so the bodies
// keep a speed that depends on where in the step the end was met. And the load of a blow falls with the length of the
// step: a joint may hold that breaks where a blow is located and lasts impact_time.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include <cdot/detail/block.hpp>
#include <cdot/world.hpp>

#include "runtime/tool/watch/struck_islands.hpp"

namespace cdot {

struct BlowOnJoint {
  int joint = -1;  // -1: none
  bool held = false;
  // Of its strength: what it carried a step before it broke; or, if it held, the blow over impact_time.
  double share = 0;
  double time = 0;  // [s], of the step's end
};

class BlowWatch {
 public:
  // After every step. Notes the first joint that broke in a step in which an end of its mechanism began to press, and
  // that would have held by the growth of its load before; or the first that held such a blow.
  template <class S>
  void look(BasicWorld<S>& world, double time);
  const BlowOnJoint& found() const { return found_; }

 private:
  using Forces = std::array<double, most_rows>;
  // After the last steps: the forces of a joint's rows, in turn, and their load as a share of the strength, the newest
  // first, which is infinite once it is broken.
  struct Loads {
    static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    std::array<Forces, 4> forces{};
    unsigned newest = 0;
    std::array<double, 2> share{unknown, unknown};
    int since_blow = 4;  // [steps]

    const Forces& ago(unsigned steps) const { return forces[(newest - steps) % forces.size()]; }
    void add(const Forces& now, double share_now, bool struck);
    double without_blow() const;     // the share expected now, from those before
    double of_blow(double h) const;  // the load over impact_time of one that began two steps of h ago; else 0
  };

  template <class S>
  void look_at_bonds(const WorldData<S>& world, double time);
  template <class S>
  void look_at_rows(const WorldData<S>& world, double time);
  void note_break(int joint, const Loads& loads, double time);
  void note_hold(int joint, double share, double time);

  std::vector<Loads> of_bonds_;
  std::vector<std::vector<Loads>> of_rows_;  // that act until they carry too much, by batch and home
  StruckIslands struck_;
  BlowOnJoint found_;
};

}  // namespace cdot
