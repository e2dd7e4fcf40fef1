#include "runtime/tool/search/stiffness.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/methods.hpp>

namespace cdot {
namespace {

constexpr double evaluations_per_step = 12;  // of the highest order

}  // namespace

double stiff_price(const Scene& scene, const std::vector<WorstOfIsland>& islands) {
  double price = 0;
  for (const WorstOfIsland& island : islands)
    price += evaluations_per_step * scene.duration * std::sqrt(std::max(0.0, island.island.stiffest.square)) /
             row_of(Integrator::dop853).stable_radians;
  return price;
}

double stiff_price_at_start(const Scene& scene) {
  Scene solved = scene;
  solved.settings.integrator = Integrator::dop853;  // for which springs are forces
  const auto look = [&]<class S>(S) {
    std::string ignored;
    BasicWorld<S> world = world_at_start<S>(solved, ignored);
    std::vector<WorstOfIsland> worst;
    add_diagnosis(diagnose(world, scene.duration / intervals_of_own_steps), 0, worst);
    return worst;
  };
  return stiff_price(scene, in_space_of<double>(solved, look));
}

}  // namespace cdot
