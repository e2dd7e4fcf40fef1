// A row with bounds as operations: what it asks for in a step of h, and its error.
#pragma once

#include "derive/compile/rows/joint_rows.hpp"
#include "derive/compile/rows/laws.hpp"
#include "derive/kernel/factor.hpp"

namespace cdot::compile {

class BoundWriter {
 public:
  BoundWriter(const RowBlocks& blocks, Algebra& algebra, std::size_t bounded);

  const RowBlock& block() const { return block_; }
  const Values& inputs() const { return in_; }  // with J
  int rate_change() const;                      // of the rate that a row prescribes
  // J v of these velocities alone, by the names of components.
  int along(const Values& velocities) const;
  int drift() const { return law_.drift()[0]; }  // dC/dt
  int rate() const { return law_.rate()[0]; }    // J v + dC/dt
  int gamma() const { return blocks_.call(algebra_, block_, "gamma", in_).at("g[0]"); }
  // J v' + dC/dt + bias + softness lambda = 0 at the end of a step, lambda within [low, high].
  struct Kick {
    int bias, softness, low, high;
  };
  Kick kick(int h) const;
  // The same in the middle of a step of h: rows with ends miss the input `missed`, and serve the end of the input
  // `side`, both by the row.
  Kick in_middle(int h) const;
  // On accelerations, as the World's Guard: how far C is from the end that the row serves, the rate that it prescribes
  // and its derivative, and the bounds of its force.
  struct Guard {
    int off, rate, low, high, acceleration;
  };
  // The change of the bounds of the force by each unit of a load.
  struct ByLoad {
    int low, high;
  };
  ByLoad by_load() const;
  void output_by_load() const;  // to B.by_low and B.by_high
  Guard guard() const;
  // Bounds of its force, of a row with ends: none where it is off its end.
  Kick while_it_is_met() const;
  // Resolutions below which its value, its rate and its force count as 0, in units of the relative one.
  struct Resolution {
    int value, rate, force, hop;
  };
  Resolution resolution() const;
  // True if its ends are one.
  bool holds() const;
  // The part of C that the projection removes.
  int past() const;
  // C - end of the nearer end, 0 without ends; the side: 1 for the lower one, -1 for the upper one, 0 for both.
  struct End {
    int off, side;
  };
  End nearest() const;
  // The rate of C from that end while the bodies rest: dC/dt less the rate of the end.
  int drift_from_end() const;
  // The distance from an event, far without one.
  int distance(const std::optional<Program>& event) const;

 private:
  Kick kick_while_it_acts(int h) const;
  Kick while_it_acts(Kick kick) const;
  Guard guard_while_it_acts() const;
  // The largest change of C by the mechanism's size and 1 rad; the terms |J v|, |J dv/dt| and 1/m.
  struct Sizes {
    int value;
    Summands rates, accelerations, along, masses;
  };
  Sizes sizes_of_terms() const;
  End nearest_while_it_acts() const;
  // It begins or ends to act, or its joint may break; and the number of this.
  bool may_rest() const { return has_events() || block_.holds >= 0; }
  bool has_events() const;
  int acts() const;
  bool is_rate() const;
  // C - lower, upper - C; at_low > 0 where the lower end is the nearer one, apart > 0 where they do not hold the
  // coordinate; how the nearer one moves.
  struct Ends {
    int above, below, at_low, apart, rate, acceleration;
  };
  Ends ends() const;
  int is_apart(int lower, int upper) const;
  int nearer(const Ends& ends, int lower, int upper) const;
  int unless_held(const Ends& ends, int number, int held) const;
  Kick bounds_at(const Ends& ends) const;
  Kick of_rate(int h) const;
  Kick of_ends(int h) const;
  Kick of_force(int h) const;
  Kick of_pull(int h, int bias, int softness) const;
  // lower and upper: bounds of the force, or ends.
  Values bounds() const;
  int bound(const Values& bounds, const std::string& name, double missing) const;

  const RowBlocks& blocks_;
  Algebra& algebra_;
  const std::size_t number_;
  const Effect& effect_;
  const RowBlock& block_;
  Values in_;
  LawWriter law_;
};

// True for a row that prescribes a rate: others hold it where they contradict it.
bool prescribes_rate(const RowBlocks& blocks, std::size_t bounded);
// True if its force has one sign in all states.
bool drives_one_way(const RowBlocks& blocks, std::size_t bounded, Constants& constants);
// True for a row that begins or ends to act at an event. The input events.acts tells whether it acts.
bool has_events(const RowBlocks& blocks, std::size_t bounded);
bool waits(const RowBlocks& blocks, std::size_t bounded);
// It has one end, or two that are apart, and waits for an event: an end may be passed as it begins to hold.
bool is_late_end(const RowBlocks& blocks, std::size_t bounded, Constants& constants);
// q, v, time -> after, until: the distances from the events of rows with bounds, at most 0 where one happens.
Program distances_of(const RowBlocks& blocks, Constants& constants);
// q, v, time -> B: of each row its distance from the end that it serves, what its rate misses of the prescribed one,
// and the bounds of its force.
Program guard_of(const RowBlocks& blocks, Constants& constants);
// q, v, time, a, force, h -> of_value, of_rate, of_force, of_hop: resolutions of C, its rate and the force of each row,
// and of the square of a rate with which it hops off its end, in units of the relative one.
Program resolve_of(const RowBlocks& blocks, Constants& constants);
// q, time, J, lambda, force -> load: the force with which the bounds of each row grow.
Program carry_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants);
// load, time -> from: the distances of bonds from their end, at most 0 where one breaks.
Program strain_of(const RowBlocks& blocks, Constants& constants);
// True for a row with ends, or one that holds a value.
bool has_ends(const RowBlocks& blocks, std::size_t bounded);

}  // namespace cdot::compile
