#include "runtime/step/integrators.hpp"

#include <array>

#include <cdot/spaces.hpp>

#include "runtime/solve/solver.hpp"
#include "runtime/step/runge_kutta.hpp"

namespace cdot {

// Defined in the file of the method's name.
template <class S>
void prepare_euler(Island<S>& island);

namespace {

template <class S>
void euler(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  step_euler(world, island, h, world.last_step);
}

// The midpoint rule closes the joints by the direct solver. Sweeps and other drift corrections take linearly implicit
// steps of Euler's.
template <class S>
void implicit(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  if (takes_midpoint(world.settings)) step_midpoint(world, island, h);
  else step_euler(world, island, h, world.last_step);
}

template <class S, const auto& method>
void runge_kutta(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  step_runge_kutta<S>(world, island, method, h);
}
template <class S, const auto& method>
void prepare(Island<S>& island) {
  prepare_runge_kutta<S>(island, method);
  prepare_midpoint(island);
}

// In the order of integrator_rows.
template <class S, class Real = ExactNumber<typename S::Scalar>>
constexpr std::array<Stepper<S>, integrator_rows.size()> steppers{{
    {Integrator::euler, euler<S>, prepare_euler<S>, false},
    {Integrator::implicit, implicit<S>, prepare_midpoint<S>, true},
    {Integrator::rattle, step_rattle<S>, prepare_rattle<S>, true},
    {Integrator::rk4, runge_kutta<S, rk4<Real>>, prepare<S, rk4<Real>>, false, true},
    {Integrator::dop853, runge_kutta<S, dop853<Real>>, prepare<S, dop853<Real>>, false, true},
    {Integrator::radau5, runge_kutta<S, radau5<Real>>, prepare<S, radau5<Real>>, false, true},
}};

}  // namespace

template <class S>
const Stepper<S>& stepper_of(Integrator integrator) {
  static_assert([] {
    for (std::size_t k = 0; k < integrator_rows.size(); ++k)
      if (steppers<S>[k].integrator != integrator_rows[k].integrator) return false;
    return true;
  }());
  return steppers<S>[static_cast<std::size_t>(integrator)];
}

#define CDOT_INSTANTIATE(S) template const Stepper<S>& stepper_of(Integrator);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
