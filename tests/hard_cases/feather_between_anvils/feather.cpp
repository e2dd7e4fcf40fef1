// A mass ratio of a million on both sides of one body.
#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::feather_between_anvils {
namespace {

void fall(Trial& t) {
  t.start();
  const Watch w = t.run(5);
  t.at_most("gap [m]", w.gap, 1e-3);
  const double swing = 1000 * g * (0.5 + 2.5);  // energy of the swing: the anvils' potential above the vertical [J]
  t.at_most("energy off, of the swing's", w.drift() / swing, 5e-3);
}

// Methods of low order: the energy of the swing has an error proportional to the step.
void finer(Trial& t) {
  t.scene.settings.substeps = 32;
  fall(t);
}

const Register planar_finer({"feather_between_anvils", "planar", without(direct(), {Integrator::implicit}), finer,
                             "32 substeps"});
const Register spatial_finer({"feather_between_anvils", "spatial",
                              in_double(only(direct(), {Integrator::euler})) +
                                  without(direct(), {Integrator::euler, Integrator::implicit}),
                              finer, "32 substeps"});
const Register planar({"feather_between_anvils", "planar", in_double(only(direct(), {Integrator::dop853})), fall});
const Register spatial({"feather_between_anvils", "spatial", in_double(only(direct(), {Integrator::dop853})), fall});

}  // namespace
}  // namespace cdot::hard::feather_between_anvils
