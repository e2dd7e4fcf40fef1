#include "runtime/tool/search/stiffness.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/methods.hpp>

namespace cdot {
namespace {

constexpr double evaluations_per_step = 12;  // of the highest order

}  // namespace

double stiff_price(const Scene& scene, const std::vector<WorstOfIsland>& islands) {
  const IntegratorRow& row = row_of(Integrator::dop853);
  double price = 0;
  for (const WorstOfIsland& island : islands) {
    const double oscillating = std::sqrt(std::max(0.0, island.island.stiffest.square)) / row.stable_radians;
    const double steps = scene.duration * std::max(oscillating, island.island.fastest_decay.rate / row.stable_decay);
    price += evaluations_per_step * steps;
  }
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
