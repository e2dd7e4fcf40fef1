// The kick of joints and effects, as functions of the header: accelerations, and an Euler step.
#pragma once

#include "derive/compile/rows/joint_rows.hpp"
#include "derive/compile/rows/laws.hpp"

namespace cdot::compile {

// q, v, time, J -> a and lambda: M a = f + J^T lambda with J a = gamma. With rows that have bounds, these are without
// their forces, and B holds the system that gives them.
Program accelerations_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants);

// The impulse of an effect in a kick, by row: given - share^2 (J v' + dC/dt), v' the velocities after the kick.
struct EffectRows {
  std::vector<int> given, share;
};

// Of a step of h that is implicit as far as the slopes of the law say.
EffectRows implicit_rows(Algebra& algebra, const LawWriter& law);

// The effects that act in a kick, and how.
struct KickPlan {
  std::vector<std::size_t> effects;
  std::function<EffectRows(Algebra& algebra, std::size_t effect, const LawWriter& law, const Values& in)> rows_of;
};

// q, v, time, J, h -> next: v after an Euler step of h with effects, and lambda of the joints. With rows that have
// bounds, these are without their impulses, and B holds the system that gives them.
Program kick_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants);

// The same at the end of a step of RATTLE, from velocities that forces have changed: such that J v' = -dC/dt. Also
// pull: what the joints' impulses change; of rows with bounds B.p, and B.u of those that repeat theirs in the next
// step.
Program finish_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants, const KickPlan& plan);

// q, v, time, J, h -> lambda, pull and B at the start of a run by RATTLE: forces by which rows with bounds that
// prescribe a rate reach it in h/2.
Program exert_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants);

// q, time, J -> B.g and B.S for rows with ends, on accelerations for all rows, without effects: their part in a
// projection.
Program reach_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants);

// q, time, J, lambda, mu -> d = M^-1 (J^T lambda + E^T mu), E those rows with bounds.
Program displace_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants,
                    const std::function<bool(std::size_t bounded)>& takes_part);

// q, time -> past: errors of rows with bounds; on accelerations, how far each is from its end.
Program past_of(const RowBlocks& blocks, Constants& constants);

// q, time -> off, side: C - end of the nearer end of each, and 1 for a lower end, -1 for an upper one, 0 for both.
Program nearest_of(const RowBlocks& blocks, Constants& constants);
// q, time -> moves: rates of C from that end while bodies rest; without outputs if all are 0.
Program drift_of_ends(const RowBlocks& blocks, Constants& constants);

// q, v, time -> along: J v of rows with bounds.
Program along_of(const RowBlocks& blocks, Constants& constants);

}  // namespace cdot::compile
