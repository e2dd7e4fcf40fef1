// A verdict, and whether shorter steps change it.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include <cdot/methods.hpp>

#include "tests/methods.hpp"
#include "tests/runtime/tool/swept_rise.hpp"
#include "tests/torture/draw/random.hpp"
#include "tests/torture/laws.hpp"
#include "tests/torture/motion.hpp"
#include "tests/torture/springs.hpp"
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

// True if an effect's force grows so much as bodies approach that no such step resolves it, or if it moves them within
// the round-off of their poses.
template <class S>
bool unresolved_now(BasicWorld<S>& world, double step) {
  constexpr double rounded = by_precision<typename S::Scalar>(1e-6, 1e-13);
  const Motion motion = motion_of(world);
  double farthest = 0;
  for (const BodyMotion& body : motion.bodies) farthest = std::max(farthest, norm(body.x));
  return std::ranges::any_of(spring_rows(world), [&](const SpringRow& row) {
    return step * std::sqrt(std::max(0.0, -row.stiffness * row.mass)) > 2 ||
           std::abs(row.force) * rounded * farthest > motion.kinetic;
  });
}

// The same at a pose of the run by sweeps, up to a time.
bool unresolved(const Scene& scene, const test::SweptWay& way, double until) {
  return in_space_of(scene, [&](auto space) {
    auto world = build_world_in<decltype(space)>(test::with_sweeps(scene, way));
    if (scene.project) world.project(by_precision<typename decltype(space)::Scalar>(1e-5, 1e-12));
    for (int k = 0;; ++k) {
      const double step = way.jitter.length(k) * way.unit;
      if (unresolved_now(world, step / way.substeps)) return true;
      if (world.time() >= until || !world.step(step)) return false;
    }
  });
}

// Its work has no potential, and a step of first order knows it to first order only.
bool has_torques_in_space(const Scene& scene) {
  return std::ranges::any_of(scene.bodies, [](const SceneBody& body) {
    const SpatialBodyDefinition& of = body.spatial;
    return of.torque_x != 0 || of.torque_y != 0 || of.torque_z != 0;
  });
}

test::SweptWay drawn_way(const Scene& scene, std::uint64_t seed) {
  constexpr std::uint64_t other_than_the_scene = 0x50f7;
  constexpr auto soft = Drift::soft, projection = Drift::projection, baumgarte = Drift::baumgarte, none = Drift::none;
  Random random(seed ^ other_than_the_scene);
  test::SweptWay way;
  way.sweeps = random.of<int>({1, 1, 1, 2, 4, 10, 30}), way.substeps = random.of<int>({1, 1, 2, 4, 8});
  way.jitter = random.chance(0.5) ? test::Jitter{1, 1} : test::Jitter{random.log_between(0.1, 1), 1};
  way.unit = scene.step * random.log_between(0.3, 30), way.duration = 60 * way.unit;
  way.drift = random.of<Drift>({soft, soft, soft, projection, projection, baumgarte, baumgarte, none});
  if (way.drift != soft && random.chance(0.3)) way.integrator = Integrator::implicit;
  return way;
}

Verdict judge_swept(const Scene& scene, std::uint64_t seed) {
  const test::SweptWay way = drawn_way(scene, seed);
  const test::SweptRise seen = test::swept_rise(scene, way);
  const auto limited = [](const char* why) {
    return verdict(Outcome::limited, fmt::format("steps by sweeps: {}", why), "");
  };
  if (!seen.starts) return limited("the start is off its joints or beyond an end");
  if (seen.fails) return limited("the World says that one failed");
  if (seen.holds()) return {};
  if (!std::isfinite(seen.bound + seen.risen))
    return limited("an effect has no energy at a pose, which cdot-run tells");
  if (has_torques_in_space(scene)) return limited("torques in space put in work of first order");
  if (unresolved(scene, way, seen.time)) return limited("no step resolves the force of an effect");
  const std::string words =
      fmt::format("{} {}, {} sweeps, {} substeps, steps of {:.3g} to {:.3g} s", name_of(integrators, way.integrator),
                  name_of(drifts, way.drift), way.sweeps, way.substeps, way.jitter.shortest * way.unit, way.unit);
  return verdict(Outcome::broken, "energy of steps by sweeps", words, seen.risen, seen.bound);
}

}  // namespace

Verdict judge(const Scene& scene, const Asked& asked) {
  try {
    if (asked.swept) return judge_swept(scene, *asked.swept);
  } catch (const SceneError& error) {
    return verdict(Outcome::refused, error.what(), "");
  } catch (const Error& error) {
    return verdict(Outcome::refused, error.what(), "");
  }
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
