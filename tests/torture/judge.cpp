// A verdict, and whether shorter steps change it.
#include <fmt/format.h>

#include <cdot/methods.hpp>

#include "tests/methods.hpp"
#include "tests/torture/laws.hpp"
#include "tests/torture/trial.hpp"

namespace cdot::torture {
namespace {

constexpr int most_steps = 30000;  // of a run with shorter steps

// True for invariants that need a short step. Equal bits hold at every step; so does linear momentum while the summed
// terms stay bounded.
bool may_be_the_step(const Verdict& v) {
  return v.what == "finite" || v.what == "C" || v.what == "an end is passed" || v.what == "momentum" ||
         judged_by_order(v.what);
}

}  // namespace

Verdict judge(const Scene& scene, const Asked& asked) {
  const Verdict seen = judge_once(scene, asked);
  if (!seen.broken() || !may_be_the_step(seen) || asked.refinements == 0) return seen;
  Scene finer = scene;
  finer.duration = seen.step * scene.step;
  Asked without_bits = asked;
  without_bits.bits = false;
  Verdict again = seen;
  for (int k = 0; k < asked.refinements && 4 * steps_of(finer) <= most_steps; ++k) {
    finer.step /= 4;
    again = judge_once(finer, without_bits);
    if (!again.broken())
      return verdict(Outcome::limited, fmt::format("the step is too long: {}", seen.what),
                     fmt::format("holds at a step {:.0f} times shorter", scene.step / finer.step), seen.value,
                     seen.bound, seen.step);
  }
  const bool as_forces =
      scene.settings.integrator == Integrator::rattle || works_on_accelerations(scene.settings.integrator);
  if (as_forces && stiff(scene, finer.step, seen.length))
    return verdict(Outcome::limited, fmt::format("a spring too stiff for a force at any step tried: {}", seen.what), "",
                   seen.value, seen.bound, seen.step);
  if (finer.step * again.fastest > 2)
    return verdict(Outcome::limited, fmt::format("no step tried resolves the force of an effect: {}", seen.what), "",
                   seen.value, seen.bound, seen.step);
  if (judged_by_order(seen.what) && most_turned(finer, without_bits) > turns_round)
    return verdict(Outcome::limited, fmt::format("no step tried resolves how a joint's directions turn: {}", seen.what),
                   "", seen.value, seen.bound, seen.step);
  const bool unresolved = again.roughest > resolved && again.what != "C" && again.what != "finite";
  if (unresolved && !laws_of(scene).smooth)
    return verdict(Outcome::limited, fmt::format("no step tried resolves the motion: {}", seen.what), "", seen.value,
                   seen.bound, seen.step);
  return seen;
}

}  // namespace cdot::torture
