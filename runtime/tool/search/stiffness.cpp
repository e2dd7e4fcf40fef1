#include "runtime/tool/search/stiffness.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/methods.hpp>

namespace cdot {
namespace {

constexpr double evaluations_per_step = 12;  // of the highest order

// Of steps that resolve these rates [1/s]: omega of the stiffest oscillation, and that of the fastest decay.
double price_of_rates(const Scene& scene, double omega, double decay) {
  const IntegratorRow& row = row_of(Integrator::dop853);
  return evaluations_per_step * scene.duration * std::max(omega / row.stable_radians, decay / row.stable_decay);
}

double price_of(const Scene& scene, const Diagnosis::Island& island) {
  return price_of_rates(scene, std::sqrt(std::max(0.0, island.stiffest.square)), island.fastest_decay.rate);
}

// The least against a motion by a size, and against a turn by a radian [kg m^2].
double inertia_of(const SceneBody& body, double size, bool planar) {
  const double mass = planar ? body.definition.mass : body.spatial.mass;
  const double inertia = planar ? body.definition.inertia
                                : std::min({body.spatial.inertia.xx, body.spatial.inertia.yy, body.spatial.inertia.zz});
  const double of_motion = mass * (size > 0 ? size * size : 1);
  return inertia > 0 ? std::min(inertia, of_motion) : of_motion;
}

}  // namespace

double stiff_price(const Scene& scene, double step, const std::vector<WorstOfIsland>& islands) {
  double price = 0;
  for (const WorstOfIsland& one : islands) {
    // h (d + h k) K of a spring is at least (h omega)^2, as of a damper at stable steps.
    const double within_limits = std::sqrt(one.island.limited) / step;
    price += std::max(price_of(scene, one.island), price_of_rates(scene, within_limits, 0));
  }
  return price;
}

StiffStart stiffness_at_start(const Scene& scene, const Yardstick& yardstick) {
  Scene solved = scene;
  solved.settings.integrator = Integrator::dop853;  // for which springs are forces
  const auto look = [&]<class S>(S) {
    std::string ignored;
    BasicWorld<S> world = world_at_start<S>(solved, ignored);
    std::vector<WorstOfIsland> worst;
    add_diagnosis(diagnose(world, scene.duration / intervals_of_own_steps), 0, worst);
    return worst;
  };
  const bool planar = scene.dimension == Dimension::planar;
  StiffStart start;
  for (const WorstOfIsland& one : in_space_of<double>(solved, look)) {
    start.price += price_of(scene, one.island);
    start.limited = std::max(start.limited, one.island.limited);
    const Diagnosis::Stiffest& stiffest = one.island.stiffest;
    if (!(stiffest.square > 0)) continue;
    start.omega = std::max(start.omega, std::sqrt(stiffest.square));
    const auto body = static_cast<std::size_t>(stiffest.body);
    start.energy =
        std::min(start.energy, stiffest.square / 2 * inertia_of(scene.bodies[body], yardstick.size(body), planar));
  }
  return start;
}

}  // namespace cdot
