// A joint between two immovable bodies has no effective mass and no influence; a note reports it. A massless body is
// refused.
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::both_immovable {
namespace {

void idle(Trial& t) {
  t.start();
  const auto notes = t.ask([](const auto& world) { return world.notes().size(); });
  t.near("notes", double(notes), 1, 0);
  const Watch w = t.run(2);
  t.at_most("gap [m]", w.gap, 1e-6, 1e-5);
}

void no_mass(Trial& t) {
  t.scene.bodies.back().definition.mass = t.scene.bodies.back().spatial.mass = 0;
  t.at_most("accepted", t.refused("mass") ? 0 : 1, 0);
}

const Register planar({"both_immovable", "planar", all_ways(), idle});
const Register spatial({"both_immovable", "spatial", all_ways(), idle});
const Register planar_no_mass({"both_immovable", "planar", all_ways(), no_mass, "mass 0"});
const Register spatial_no_mass({"both_immovable", "spatial", all_ways(), no_mass, "mass 0"});

}  // namespace
}  // namespace cdot::hard::both_immovable
