// The equations of a mechanism as programs, a function of the header each.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "derive/compile/one_freedom/programs.hpp"
#include "derive/compile/rows/row_blocks.hpp"

namespace cdot::compile {

struct Equations {
  std::vector<std::string> rows;    // of all joints, numbered from joint to joint: "hinge_pin_x"
  std::vector<std::string> stored;  // the numbers of J and of its factor that `evaluate` writes
  std::set<std::string> turning;    // bodies whose c and s are read
  Constants constants;
  // With joints:
  Program evaluate;    // q, time -> J: Jacobian, factor of K = J M^-1 J^T
  Program errors;      // q, time -> C
  Program rates;       // J, v -> J v + dC/dt
  Program solve;       // J, b -> lambda with K lambda = b, d = M^-1 J^T lambda
  Program accelerate;  // q, v, time, J -> a, lambda: M a = f + J^T lambda, J a = gamma
  // With joints, where a step foresees the multipliers of its projection:
  Program apply;                   // J, lambda -> d = M^-1 J^T lambda
  Program aim;                     // q, time, J -> B: Aim, the factor of J' M^-1 J^T with J' of q
  Program solve_aimed;             // J, B, b -> lambda with J' M^-1 J^T lambda = b, d = M^-1 J^T lambda
  std::vector<std::string> aimed;  // the numbers that `aim` writes
  FreedomPrograms freedom;         // by Euler's steps, of a mechanism of one freedom
  bool apart = false;              // by explicit Runge-Kutta methods: no stage reads a centre of mass or its velocity
  // Without:
  Program fall;       // q, v, time -> a
  Program kick;       // q, v, time, J, h -> next: v after an Euler step with effects; lambda of the joints
  Program potential;  // q, time -> E of the effects
  Program angles;     // q, time -> angle, turns: angles that count whole turns
  // For who asks (readings/readings.hpp); no step calls them:
  Program coordinates;  // q, v, time -> value, rate
  Program reactions;    // q, time, lambda -> load
  // Of effects and rows with bounds by RATTLE and by the midpoint rule:
  bool finishes = false;       // the end of a step solves for more than the joints
  bool exerts = false;         // so does the start of a run
  int groups = 1;              // mechanisms
  std::string group_lists;     // by body, by row, by row with bounds
  std::vector<int> freed;      // rows of velocities
  std::vector<int> effect_of;  // by row of Damping: its effect
  std::size_t triangle = 0;    // numbers in Damping::K
  Program dampen;              // q, v, time, h -> next: v with the dampers at the start
  Program notice, look;        // rates of effects at the end, were each alone (rows/dampers.hpp)
  Program finish;              // q, v, time, J, h -> next, lambda, pull, B
  Program exert;               // q, v, time, J, h -> lambda, pull, B: forces at the start of a run
  // By the midpoint rule (rows/middle.hpp):
  Program weigh, stiffen, improve;
  std::size_t taut = 0, taut_numbers = 0;  // rows of tension, and the numbers of these
  // Of rows with bounds:
  std::string is_rate;  // "true, false", by row
  std::string cones;    // "-1, 1, 1", by row: the first row of its cone
  bool has_ends = false, has_events = false, has_late_ends = false, has_clutches = false;
  std::string waits;      // "true, false", by row: it waits for an event
  std::string late;       // and is an end
  Program reach;          // q, time, J -> B: their part in a projection
  Program past;           // q, time -> past: errors
  Program nearest;        // q, time -> off, side: of the nearer end; not by Euler's steps
  Program drift_of_ends;  // by the midpoint rule: q, time -> moves: how C leaves that end while bodies rest
  Program along;          // q, v, time -> along: J v
  Program displace;       // q, time, J, lambda, mu -> d; where inertias turn
  Program distances;      // q, v, time -> after, until: distances from events
  Program draw;    // by RATTLE: q, time, J, lambda, mu -> d: the pull of joints and of rows that prescribe a rate
  Program share;   // J, lambda -> shared: loads of redundant rows of joints that may break (borne/shares.hpp)
  Program strain;  // load, time -> from: the distances of joints from their end
  // q, v, time, ... -> borne: forces of effects that may break (borne/borne.hpp). By RATTLE and by the midpoint rule
  // what they did at the start of a step and at its end, too, in `bear_start` and `bear_end`.
  Program bear, bear_start, bear_end;
  std::vector<std::size_t> first_borne;  // by joint that may break; the last one is the number of all rows
  std::vector<std::size_t> first_rows;   // by joint; the last one is the number of all rows
  Program guard;                         // by Runge-Kutta methods (methods/modes.hpp): q, v, time -> B
  Program carry;                         // q, time, J, lambda, force -> load: the forces with which bounds grow
  Program resolve;                       // q, v, time, a, force, h -> of_value, of_rate, of_force, of_hop
};
// Of steps.
std::vector<const Program*> programs_of_equations(const Equations& equations);
// The functions that it calls, beside those of every header.
std::set<std::string> functions_of(const Program& program);
std::set<std::string> functions_of(const Equations& equations);

Equations equations_of(const Mechanism& mechanism, const Names& names, const derive::SpecsFolder& specs);

}  // namespace cdot::compile
