// The equations of each island at the present poses: rank, condition, redundant and contradicting rows, and the
// stiffness of the motion. The World's state does not change.
#pragma once

#include <vector>

#include <cdot/world.hpp>

namespace cdot {

struct Diagnosis {
  struct Row {
    int joint = -1, row = -1;
  };
  // A row that follows from others, or contradicts them.
  struct Redundant {
    Row row;
    std::vector<int> joints;  // its own and the others that take part, ascending
    double missed = 0;        // [m, rad]: part of C that no motion of the bodies removes, to first order
    bool conflicting = false;
  };
  // Small oscillations about the present motion, within the joints, by the forces that a step takes from its start:
  // gravity, springs between points, for other than Euler's methods springs on coordinates, and the tensions of joints,
  // whose directions turn with the bodies.
  struct Stiffest {
    double square = 0;   // [1/s^2] omega^2, the largest in size; negative if the motion grows instead of oscillating
    int body = -1;       // the one that moves most
    double tension = 0;  // part of omega^2 from the joints' forces; springs make the rest
  };
  struct Island {
    std::vector<int> bodies;  // movable ones
    int rows = 0, rank = 0;   // of inequalities the active ones
    // Largest over smallest eigenvalue of K, of its independent rows scaled to K_ii = 1. A power iteration with K and
    // its factors estimates it from below.
    double condition = 1;
    double smallest_pivot = 1;  // of L D L^T of that K, among its independent rows
    Row weakest;                // of that pivot
    std::vector<Redundant> redundant;
    Stiffest stiffest;
    double lightest = 0, heaviest = 0;  // [kg]
    double fastest_spin = 0;            // [rad/s]
    int spinning = -1;                  // the body that has it
    double size = 1;                    // [m] its longest arm or distance between joined bodies
    double farthest = 0;                // [m] of its bodies from the origin of poses
  };
  std::vector<Island> islands;
};

// `h`: length of the next substeps [s].
template <class S>
Diagnosis diagnose(BasicWorld<S>& world, double h);

}  // namespace cdot
