// The hinge of generated/ at a pose, behind numbers: its names and those of an emitted hinge cannot meet in one file.
#pragma once

struct HingeValues {
  double C[5], K[15], D[5][12];
};

// Poses, parameters and inverse masses, as numbers in the order of their structs.
void generated_hinge(const double* q, const double* p, const double* m, HingeValues& values);
