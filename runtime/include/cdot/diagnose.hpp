// The equations of each island at the present poses: rank, condition, redundant and contradicting rows, fastest
// oscillation and decay. The World's state does not change.
#pragma once

#include <vector>

#include <cdot/world.hpp>

namespace cdot {

struct Diagnosis {
  struct Row {
    int joint = -1, row = -1;
  };
  // A row that is a combination of others: redundant, or contradicting if `missed` is not 0.
  struct Redundant {
    Row row;
    std::vector<int> joints;  // the row's joint and the joints of the other rows, ascending
    double missed = 0;        // [m, rad]: part of C that no small motion of the bodies removes
    bool conflicting = false;
    // [m/s^2, rad/s^2] The row is redundant in this pose only, where branches of the motion cross, and the velocities
    // follow none of them: no acceleration of the bodies keeps the row. This is what it misses.
    double undecided = 0;
  };
  // A row that is nearly a combination of others: an error of it moves bodies by more than 200 times that error. In a
  // structure without mobility such a row is all that locks it: the structure is rigid but for a small misfit.
  struct NearlyRedundant {
    Row row;
    double per_way = 0;  // change of C by a way of 1 m (or an arc of 1 m) of `body`
    int body = -1;       // that moves most
  };
  // The fastest small oscillation about the present motion that the joints allow. It counts the forces that a step
  // evaluates at its start: gravity, springs between points, and the joints' tensions, whose directions turn with the
  // bodies. Springs on coordinates count unless the method is one of Euler's.
  struct Stiffest {
    double square = 0;   // [1/s^2] omega^2, largest in size; negative: the motion grows instead of oscillating
    int body = -1;       // with the largest amplitude
    double tension = 0;  // part of omega^2 from the joints' forces; the other part comes from springs
  };
  // The fastest decay of a small change of the velocities that the joints allow, by dampers, drag, and effects that
  // depend on velocities: exp(-rate t).
  struct Decay {
    double rate = 0;  // [1/s] negative: the change grows
    int body = -1;    // with the largest amplitude
  };
  struct Island {
    std::vector<int> bodies;  // movable ones
    int rows = 0, rank = 0;   // active inequality rows count
    // Largest over smallest eigenvalue of K, for its independent rows scaled to K_ii = 1. A power iteration with K and
    // its factors estimates this ratio from below.
    double condition = 1;
    double smallest_pivot = 1;  // of L D L^T of that K, over its independent rows
    Row weakest;                // row of that pivot
    std::vector<Redundant> redundant;
    std::vector<NearlyRedundant> nearly_redundant;
    int mobility = 0;  // velocities that the rows leave free
    Stiffest stiffest;
    Decay fastest_decay;
    double limited = 0;                 // stiffness for the step of the stiffest force with limits; stiff above 1
    double lightest = 0, heaviest = 0;  // [kg]
    double fastest_spin = 0;            // [rad/s]
    int spinning = -1;                  // body with that spin
    double size = 1;                    // [m] its longest arm or distance between joined bodies
    double farthest = 0;                // [m] largest distance of a body from the origin of poses
  };
  std::vector<Island> islands;
};

// `h`: length of the next substeps [s].
template <class S>
Diagnosis diagnose(BasicWorld<S>& world, double h);

}  // namespace cdot
