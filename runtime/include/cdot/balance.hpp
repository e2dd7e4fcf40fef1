// The balance of a run: the energy and momentum that a World has against what it should have. The difference is the
// method's own error, without any reference.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

namespace cdot {

// From BasicWorld::balance(). The start is the first step, or the change of joints since which momentum is watched.
struct Balance {
  double time = 0;     // [s]
  double kinetic = 0;  // [J]
  // Of gravity, constant forces, springs and soft joints [J]. A constant torque in space has no potential: its work is
  // put in.
  double potential = 0;
  double start = 0;   // kinetic + potential at the start [J]
  double put_in = 0;  // by motors, joints that depend on time, and changes from outside [J]; negative if they brake
  double taken = 0;   // by dampers, drag, friction, impacts of limits and ropes, breaking and sleep [J]
  // The rest: energy that appeared (> 0) or disappeared (< 0) without a source [J].
  double method() const { return kinetic + potential - start - put_in + taken; }
  // Energies below this are small for the mechanism [J]: a tenth of its weight times its size; the work of its largest
  // force on 1e-12 of that (in float 1e-5), round-off; and the energy of motions by a millionth of its size a second
  // (in float a thousandth), or by as much as the local error lets a mechanism at rest move, which has no other scale.
  double small = 0;

  // Over the islands that touch no immovable body and have no drag, the worst. The error is the change of an island's
  // momentum less what gravity and forces gave; the scale is the sum of its bodies' |momentum|, plus that of rest.
  struct Momentum {
    double error = 0, scale = 0;  // [kg m/s], or [kg m^2/s] about the centre of mass
    int body = -1;                // the island's first
  };
  Momentum linear, angular;
};

// Work since the first step [J]: positive if put in, negative if taken.
struct WorkOfSource {
  // Of effects on coordinates their name ("motor", "friction", "limit", "spring", "servo"); of effects from
  // specs, ropes and joints that depend on time their type ("drag", "driven_crank"); "damping" and "torque" of bodies;
  // "changes from outside", "breaking", "sleep".
  std::string_view name;
  double work;
};

// Follows the balance of a run and keeps its worst moment. Shares refer to a scale: the largest kinetic energy so far,
// plus the range of the potential, plus the work put in and taken, plus Balance::small.
class BalanceWatch {
 public:
  struct Worst {
    double amount = 0;  // the error [J], [kg m/s], [kg m^2/s]; that of an energy has a sign
    double scale = 0;   // of the run so far, in the same unit
    double time = 0;    // [s] of the amount
    int body = -1;      // of a momentum: the first of its island
    // Not finite counts as infinitely wrong.
    double share() const {
      if (amount == 0) return 0;
      const double share = std::abs(amount) / scale;
      return std::isfinite(share) ? share : std::numeric_limits<double>::infinity();
    }
  };
  Worst energy, linear, angular;
  Worst risen;  // the largest energy that appeared without a source
  Balance last;

  // The scale without the work: a motor and an end that press on each other may do any amount [J].
  double of_motion() const { return kinetic_ + (highest_ - lowest_) + small_; }

  void look(const Balance& now) {
    last = now;
    kinetic_ = std::max(kinetic_, now.kinetic);
    lowest_ = std::min(lowest_, now.potential), highest_ = std::max(highest_, now.potential);
    small_ = std::max(small_, now.small);
    energy.scale = risen.scale = of_motion() + std::abs(now.put_in) + now.taken;
    const double method = now.method();
    keep(energy, method, now.time, -1);
    if (!(method <= 0)) keep(risen, method, now.time, -1);
    look(linear, now.linear, now.time);
    look(angular, now.angular, now.time);
  }

 private:
  static void keep(Worst& worst, double amount, double time, int body) {
    if (std::abs(amount) <= std::abs(worst.amount)) return;
    worst.amount = amount, worst.time = time, worst.body = body;
  }
  static void look(Worst& worst, const Balance::Momentum& now, double time) {
    worst.scale = std::max(worst.scale, now.scale);
    keep(worst, now.error, time, now.body);
  }

  double kinetic_ = 0, small_ = 0;
  double lowest_ = std::numeric_limits<double>::infinity(), highest_ = -std::numeric_limits<double>::infinity();
};

}  // namespace cdot
