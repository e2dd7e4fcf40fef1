#include "tests/derive/engines/generated_hinge.hpp"

#include <cstring>

#include <cdot/spatial/hinge.hpp>

void generated_hinge(const double* q, const double* p, const double* m, HingeValues& values) {
  using namespace cdot::spatial;
  Pose<double> poses[2];
  InverseMass<double> masses[2];
  hinge::Parameters<double> parameters;
  std::memcpy(poses, q, sizeof poses);
  std::memcpy(masses, m, sizeof masses);
  std::memcpy(&parameters, p, sizeof parameters);
  hinge::Jacobian<double> J;
  hinge::jacobian(poses, parameters, 0., values.C, J);
  hinge::effective_mass(J, masses, values.K);
  hinge::dense(J, values.D);
}
