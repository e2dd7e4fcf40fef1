// What is known about the equations of each island at the present poses: rank, condition, rows that say nothing new,
// and those among them that contradict the others; how stiff the motion is that forces and tensions make. The World's
// state stays as it was.
#pragma once

#include <vector>

#include <cdot/world.hpp>

namespace cdot {

struct Diagnosis {
  struct Row {
    int joint = -1, row = -1;
  };
  // A row that depends on others: what it says follows from theirs, or contradicts it.
  struct Redundant {
    Row row;
    std::vector<int> joints;  // it and the others that take part, ascending
    double missed = 0;        // [m, rad]: of C, what stays however the bodies are moved, to first order
    bool conflicting = false;
  };
  // Small oscillations about the present motion, within the joints, under forces that are taken as they are at the
  // start of a step: gravity, springs between points (but for Euler's methods also those on coordinates), and the
  // tensions in the joints, whose directions turn with the bodies.
  struct Stiffest {
    double square = 0;   // [1/s^2] omega^2, the largest in size; negative where it grows in place of oscillating
    int body = -1;       // that moves most in it
    double tension = 0;  // of omega^2, the share of the joints' forces; the rest is the springs'
  };
  struct Island {
    std::vector<int> bodies;  // movable ones
    int rows = 0, rank = 0;   // of inequalities those that touch
    // The largest over the smallest eigenvalue of K with every row scaled to K_ii = 1, of its independent rows:
    // estimated from below by a few iterations with K and its factors.
    double condition = 1;
    double smallest_pivot = 1;  // of L D L^T of that K, among the rows that were kept
    Row weakest;                // that pivot's
    std::vector<Redundant> redundant;
    Stiffest stiffest;
    double lightest = 0, heaviest = 0;  // [kg]
    double fastest_spin = 0;            // [rad/s]
    int spinning = -1;                  // the body that has it
    double size = 1;                    // [m] its longest arm or distance between joined bodies
    double farthest = 0;                // [m] of its bodies from where poses are counted
  };
  std::vector<Island> islands;
};

// `h`: of the substeps to come [s].
template <class S>
Diagnosis diagnose(BasicWorld<S>& world, double h);

}  // namespace cdot
