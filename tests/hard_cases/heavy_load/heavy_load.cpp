// A light chain stiffened by the weight at its end: 1000 kg, then a million, on ten links of 1 kg: rods, which tension
// rotates, and beads on bars, whose positions tension couples.
#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::heavy_load {
namespace {

void set_load(Trial& t, double mass) {
  t.scene.bodies.back().definition.mass = t.scene.bodies.back().spatial.mass = mass;
}

void kick(Trial& t, double mass) {
  set_load(t, mass);
  t.start();
  const Watch w = t.run(10);
  t.at_most("gap [m]", w.gap, 1e-3);
  t.at_most("energy gained, of the kick's", w.rise / (0.5 * mass), 1e-3);
}

void rest(Trial& t, double mass) {
  set_load(t, mass);
  t.scene.bodies.back().definition.vx = t.scene.bodies.back().spatial.vx = 0;
  t.start();
  t.run(1);
  t.near("top joint at rest, relative", t.force(0) / ((10 + mass) * g), 1, 1e-5);
}

template <int mass>
void plain(Trial& t) {
  kick(t, mass);
  rest(t, mass);
}
// First order: the energy oscillates in proportion to the step.
template <int mass>
void finer(Trial& t) {
  t.scene.settings.substeps = 8;
  plain<mass>(t);
}

const Ways exact = only(direct(), {Integrator::dop853}), implicit = only(direct(), {Integrator::implicit});

const Register planar({"heavy_load", "planar", exact + implicit, plain<1000>});
const Register spatial({"heavy_load", "spatial", exact + implicit, plain<1000>});
const Register planar_finer({"heavy_load", "planar", implicit, finer<1000>, "8 substeps"});
const Register spatial_finer({"heavy_load", "spatial", implicit, finer<1000>, "8 substeps"});
const Register planar_beads({"heavy_load", "planar_beads", implicit, plain<1000>});
const Register spatial_beads({"heavy_load", "spatial_beads", implicit, plain<1000>});
// Nothing is damped: in float, round-off of forces of 1e7 N shows in the energy of the kick.
const Register planar_million({"heavy_load", "planar", in_double(implicit), finer<1'000'000>,
                               "a million kg, 8 substeps"});
const Register spatial_million({"heavy_load", "spatial", in_double(implicit), finer<1'000'000>,
                                "a million kg, 8 substeps"});
const Register planar_beads_million({"heavy_load", "planar_beads", in_double(implicit), plain<1'000'000>,
                                     "a million kg"});
const Register spatial_beads_million({"heavy_load", "spatial_beads", in_double(implicit), plain<1'000'000>,
                                      "a million kg"});

}  // namespace
}  // namespace cdot::hard::heavy_load
