// Symplectic Euler: the velocities have been advanced first, the poses follow with the new ones.
// First order.
#include "runtime/planar.hpp"
#include "runtime/stages.hpp"

namespace cdot {

template <class S>
void integrate(WorldState<S>& world, Island<S>& island, typename S::Scalar h) {
  Bodies<S>& all = world.bodies;
  for (int i : island.bodies) all.pose[i] = S::moved(all.pose[i], S::sum({}, all.velocity[i], h));
  island.evaluated = island.factored = false;
}

template void integrate(WorldState<Planar<double>>&, Island<Planar<double>>&, double);
template void integrate(WorldState<Planar<float>>&, Island<Planar<float>>&, float);

}  // namespace cdot
