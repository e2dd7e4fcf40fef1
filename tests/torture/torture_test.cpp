// The bounded torture: fixed seeds, every joint of both registries; scenes that once broke; a test that the torture
// finds, shrinks and prints a deliberate fault.
#include <filesystem>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/runtime/tool/swept_rise.hpp"
#include "tests/torture/advice.hpp"
#include "tests/torture/draw/scene_text.hpp"
#include "tests/torture/laws.hpp"
#include "tests/torture/misfit.hpp"
#include "tests/torture/observer.hpp"
#include "tests/torture/shrink.hpp"
#include "tests/torture/tally.hpp"
#include "tests/torture/trial.hpp"

namespace cdot::torture {
namespace {

constexpr int steps = 60;

void run(std::uint64_t seed, const Wish& wish, Tally& tally) {
  const Mechanism mechanism = generate(seed, wish);
  const Verdict verdict = judge(mechanism.scene);
  tally.add(mechanism, verdict);
  std::string wish_text = wish.joint.empty() ? ""
                                             : fmt::format(" --joint {} --dimension {}", wish.joint,
                                                           wish.dimension == Dimension::planar ? 2 : 3);
  if (wish.own) wish_text += " --own";
  if (wish.tables) wish_text += " --tables";
  EXPECT_FALSE(verdict.broken())
      << fmt::format("torture --count 1 --steps {} --seed {}{}, {}: {} {} is {:.3g}, at most {:.3g}, after step {}\n",
                     steps, seed, wish_text, way_of(mechanism.scene), verdict.what, verdict.detail, verdict.value,
                     verdict.bound, verdict.step)
      << text_of(mechanism.scene);
}

TEST(Torture, Bounded) {
  Tally tally;
  std::uint64_t next = 1000;
  for (const Dimension dimension : {Dimension::planar, Dimension::spatial})
    for (const JointType& type : joint_types(dimension))
      for (int k = 0; k < 4 && !type.is_effect; ++k)
        run(++next, {.joint = std::string(type.name), .dimension = dimension, .steps = steps}, tally);
  for (std::uint64_t seed = 1; seed <= 300; ++seed) run(seed, {.steps = steps}, tally);
  for (std::uint64_t seed = 1; seed <= 60; ++seed) run(seed, {.drift = Drift::soft, .steps = steps}, tally);
  for (const Dimension dimension : {Dimension::planar, Dimension::spatial})
    for (const JointType& type : joint_types(dimension))
      if (!type.is_effect) {
        EXPECT_GT(tally.drawn(dimension, std::string(type.name)), 0) << type.name;
      }
  EXPECT_GT(tally.count(Outcome::held), tally.mechanisms() * 3 / 4);
  fmt::print("{}", tally.text());
}

TEST(Torture, EffectsOfOnesOwnAndForcesByTables) {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    run(seed, {.own = true, .steps = steps}, tally);
    run(seed, {.tables = true, .steps = steps}, tally);
  }
  EXPECT_GT(tally.count(Outcome::held), 60);
}

// Mechanisms whose sweeps made energy up: springs of open joints threw bodies about, stiff springs were far from
// converged, and dampers were booked at rates that they never met. Then others.
TEST(Torture, NoSweepsMakeEnergyUp) {
  for (const std::uint64_t seed :
       {0x23c3464full, 0x23c34656ull, 0x23c34661ull, 0x23c346bbull, 0x23c346f0ull, 0x23c34715ull, 0x23c34731ull,
        0x23c34762ull, 0x23c34765ull, 0x23c3478aull, 0x23c3479eull, 0x23c347bcull, 0x23c347e0ull, 0x6ad453ull,
        0x6ad516ull, 0x6acfcbull, 0x7a1391ull}) {
    const Scene scene = generate(seed, {.solver = Solver::iterative, .steps = 30}).scene;
    for (const auto& [sweeps, substeps] : {std::pair{1, 1}, {1, 4}, {8, 1}})
      for (const double shortest : {0.2, 1.0}) {
        const test::SweptRise seen = test::swept_rise(scene, {sweeps, substeps, {shortest, 1}});
        EXPECT_TRUE(seen.holds()) << fmt::format("seed {:#x}, {} sweeps, {} substeps, steps from {}: {}, at most {}",
                                                 seed, sweeps, substeps, shortest, seen.risen, seen.bound);
      }
  }
}

// The same by their own methods: ten sweeps, with projection or Baumgarte's correction.
TEST(Torture, SweepsPayForWhatTheirJointsMakeUp) {
  for (const std::uint64_t seed : {0x5fb0041ull, 0x5fe1b58ull, 0x5fb469bull, 0x5ff7bc6ull, 0x5fdc1dbull, 0x6020f42ull,
                                   0x5fb16e8ull, 0x5ff935aull, 0x603b294ull}) {
    Asked asked;
    asked.bits = false;
    const Verdict verdict = judge(generate(seed, {.solver = Solver::iterative, .steps = 30}).scene, asked);
    EXPECT_FALSE(verdict.broken()) << fmt::format("seed {:#x}: {} {}, at most {}", seed, verdict.what, verdict.value,
                                                  verdict.bound);
  }
}

TEST(Torture, NoSweepsDrawnAtRandomMakeEnergyUp) {
  int held = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Asked asked;
    asked.swept = seed;
    const Verdict verdict = judge(generate(seed, {.steps = steps}).scene, asked);
    held += verdict.outcome == Outcome::held;
    EXPECT_FALSE(verdict.broken()) << "seed " << seed << ": " << verdict.detail << ": " << verdict.value << ", at most "
                                   << verdict.bound;
  }
  EXPECT_GT(held, 150);
}

// The README states longer runs of both.
TEST(Torture, ForcesInTime) {
  Asked asked;
  asked.forces = true, asked.bits = false;
  int held = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Mechanism mechanism = generate(seed, {.steps = steps});
    const Verdict verdict = judge(mechanism.scene, asked);
    held += verdict.outcome == Outcome::held;
    EXPECT_FALSE(verdict.broken()) << "seed " << seed << ": " << verdict.what << " " << verdict.value << ", at most "
                                   << verdict.bound;
  }
  EXPECT_GT(held, 40);
}

TEST(Torture, EffectsOfSpecs) {
  Asked asked;
  asked.bits = false;
  int held = 0, with_effects = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Mechanism mechanism = generate(seed, {.effects = true, .steps = steps});
    const Verdict verdict = judge(mechanism.scene, asked);
    held += verdict.outcome == Outcome::held;
    with_effects += std::any_of(mechanism.scene.joints.begin(), mechanism.scene.joints.end(), [&](const auto& joint) {
      const auto specs = [](const CoordinateEffects& effects) { return !effects.specs.empty(); };
      return find_joint_type(mechanism.scene.dimension, joint.definition.type)->is_effect ||
             std::any_of(joint.effects.begin(), joint.effects.end(), specs);
    });
    EXPECT_FALSE(verdict.broken()) << "seed " << seed << ": " << verdict.what << " " << verdict.value << ", at most "
                                   << verdict.bound;
  }
  EXPECT_GT(held, 40);
  EXPECT_GT(with_effects, 30);
}

TEST(Torture, NearlyMisfittingLoopsStay) {
  int told = 0;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    const Verdict verdict = judge_misfit(nearly_misfitting(seed, {.steps = steps}).scene);
    told += verdict.what == "told";
    EXPECT_FALSE(verdict.broken()) << "seed " << seed << ": " << verdict.what << " " << verdict.value << ", at most "
                                   << verdict.bound;
  }
  EXPECT_GT(told, 40);
}

// The README follows the advice on a thousand mechanisms.
TEST(Torture, AdviceCuresWhatItWasGivenFor) {
  int followed = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Mechanism mechanism = generate(seed, {.steps = steps});
    const Verdict verdict = judge_advice(mechanism.scene);
    followed += verdict.what == "advice";
    EXPECT_FALSE(verdict.broken()) << "seed " << seed << ": " << verdict.detail << "\n" << text_of(mechanism.scene);
  }
  fmt::print("{} pieces of advice followed\n", followed);
  EXPECT_GT(followed, 5);
}

// f(path, scene) for all scenes of a folder.
template <class F>
void each_scene_in(const std::string& folder, F f) {
  int scenes = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    if (file.path().extension() != ".toml") continue;
    f(file.path().string(), read_scene(file.path().string()));
    ++scenes;
  }
  fmt::print("{} scenes\n", scenes);
}

// Scenes from the long run whose faults are fixed.
TEST(Torture, FoundAndMended) {
  each_scene_in(CDOT_FOUND, [](const std::string& file, const Scene& scene) {
    const Verdict verdict = judge(scene);
    EXPECT_EQ(verdict.outcome, Outcome::held) << file << ": " << verdict.what << " " << verdict.detail;
  });
}

// Their titles tell the seed that draws the steps.
TEST(Torture, FoundBySweeps) {
  each_scene_in(CDOT_FOUND "/swept", [](const std::string& file, const Scene& scene) {
    Asked asked;
    asked.swept = std::stoull(scene.title.substr(5), nullptr, 16);
    const Verdict verdict = judge(scene, asked);
    EXPECT_EQ(verdict.outcome, Outcome::held)
        << file << ": " << verdict.detail << ": " << verdict.value << ", at most " << verdict.bound;
  });
}

// Closing its gaps in a step takes more energy than there is.
TEST(Torture, StartsWithGapsAreNotJudgedBySweeps) {
  Asked asked;
  asked.swept = 0x77359469;
  EXPECT_EQ(judge(generate(*asked.swept, {.steps = 30}).scene, asked).outcome, Outcome::limited);
}

// Gravity along a coordinate: two bodies fall onto each other, which no step resolves, long after the start.
TEST(Torture, PolesMetByStepsBySweepsAreLimits) {
  Asked asked;
  asked.swept = 0x12aeb55ba;
  const Verdict verdict = judge(read_scene(CDOT_FOUND "/limited/pole_met_by_sweeps.toml"), asked);
  EXPECT_EQ(verdict.outcome, Outcome::limited) << verdict.detail << verdict.value;
  EXPECT_EQ(verdict.what, "steps by sweeps: no step resolves the force of an effect");
}

TEST(Torture, FoundMisfitsStay) {
  each_scene_in(CDOT_FOUND "/misfit", [](const std::string& file, const Scene& scene) {
    for (const Integrator integrator :
         {Integrator::euler, Integrator::rattle, Integrator::implicit, Integrator::rk4, Integrator::dop853})
      for (const bool single : {false, true}) {
        Scene same = scene;
        same.settings.integrator = integrator, same.single = single;
        if (!works_on_accelerations(integrator)) same.settings.local_error = 0;
        const Verdict verdict = judge_misfit(same);
        EXPECT_FALSE(verdict.broken()) << file << ", " << way_of(same) << ": " << verdict.what << " " << verdict.value
                                       << ", at most " << verdict.bound;
        in_space_of(same, [&](auto space) {  // nor does a start open its joints
          auto world = build_world_in<decltype(space)>(same);
          const double most = 2 * world.worst_position_error().value + 1e-4;
          EXPECT_TRUE(!world.step(same.step) || world.worst_position_error().value <= most) << file << way_of(same);
        });
      }
  });
}

// A force in space adds a rank to all rows, so the row of a slide that floats no longer resolve was not seen among
// them.
TEST(Torture, ForcesHideNoRowsThatFloatsLose) {
  Asked asked;
  asked.bits = false;
  const Scene scene = read_scene(CDOT_FOUND "/limited/rows_hidden_by_forces.toml");
  EXPECT_EQ(judge(scene, asked).what, "rows that light bodies or long arms hide");
}

// Its start cannot be projected, whichever rows count as redundant. The search for them ran on for minutes.
TEST(Torture, ProjectionsEnd) { EXPECT_FALSE(judge(generate(0x758903, {.steps = 10}).scene).broken()); }

template <class S>
void expect_told(const std::string& file, const Scene& scene) {
  BasicWorld<S> world = build_world_in<S>(scene);
  if (scene.project) world.project(1e-9);
  StepResult result;
  std::uint64_t before = 0;
  do {
    before = world.hash();
    result = world.step(scene.step);
  } while (result && world.time() < scene.duration);
  fmt::print("{}\n", in_words(result, "a body", fmt::format("joint {}", result.joint)));
  EXPECT_EQ(world.hash(), before) << file;
  EXPECT_EQ(result.island, 0) << file;
  ASSERT_GE(result.joint, 0) << file;
}

// Scenes that no step of their length can solve: the failed step names island and joint and restores the state; all
// earlier steps satisfy the invariants.
TEST(Torture, FoundAndTold) {
  each_scene_in(CDOT_FOUND "/told", [](const std::string& file, const Scene& scene) {
    const Verdict verdict = judge(scene);
    EXPECT_EQ(verdict.outcome, Outcome::limited) << file;
    EXPECT_EQ(verdict.what, "the World says: joints_apart") << file << ": " << verdict.detail;
    in_space_of(scene, [&](auto space) { expect_told<decltype(space)>(file, scene); });
  });
}

// Projected onto J v = 0 by the least change, a motion loses half the square of its speed across the joints.
template <class S>
void expect_speed_across(const Scene& scene, std::uint64_t seed) {
  BasicWorld<S> world = build_world_in<S>(scene);
  world.project(1e-9);
  for (int body = 0; body < static_cast<int>(scene.bodies.size()); ++body) {
    typename S::Exact::Velocity v{};
    v.x = 0.3 + body, v.y = 1.7 / (body + 1);
    if (!scene.bodies[static_cast<std::size_t>(body)].is_static) world.set_velocity(body, v);
  }
  const double across = speed_across(world, scene), before = motion_of(world).kinetic;
  if (independence(system_matrix(world), 1e-15) < 1e-3) return;
  world.project(1e-9);
  const double lost = before - motion_of(world).kinetic;
  EXPECT_NEAR(lost, across * across / 2, 1e-6 * before) << seed;
}

TEST(Torture, SpeedAcrossJointsIsWhatTheProjectionTakes) {
  int judged = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Scene scene = generate(seed, {.single = false, .steps = 3}).scene;
    const Laws laws = laws_of(scene);
    if (!laws.smooth || !laws.energy_kept) continue;
    ++judged;
    if (scene.dimension == Dimension::planar) expect_speed_across<Planar<double>>(scene, seed);
    else expect_speed_across<Spatial<double>>(scene, seed);
  }
  EXPECT_GT(judged, 10);
}

// A free ball flies and turns as it did, several whole turns in a step: no impulse, no correction.
TEST(Torture, NothingChangesTheMeanOfAFreeWay) {
  SpatialWorld<double> world{Settings{}};
  SpatialBodyDefinition ball;
  ball.mass = 1, ball.inertia = {2, 2, 2, 0, 0, 0}, ball.vx = 3, ball.wy = -11, ball.wz = 12;
  world.add_body(ball);
  const Motion start = motion_of(world);
  ASSERT_TRUE(world.step(1.0));
  const Motion end = motion_of(world);
  EXPECT_NEAR(square(end, change_to_mean(start, end, 1.0)), 0, 1e-18);
}

TEST(Torture, SameMechanismFromTheSameSeed) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed)
    ASSERT_EQ(text_of(generate(seed).scene), text_of(generate(seed).scene)) << seed;
  EXPECT_NE(text_of(generate(1).scene), text_of(generate(2).scene));
}

template <class S>
Snapshot after(const Scene& scene, int count) {
  BasicWorld<S> world = build_world_in<S>(scene);
  for (int k = 0; k < count; ++k) world.step(scene.step);
  return world.snapshot();
}
Snapshot after(const Scene& scene, int count) {
  return scene.dimension == Dimension::planar ? after<Planar<double>>(scene, count)
                                              : after<Spatial<double>>(scene, count);
}

// A scene that is written and read again has a run with the same bits and the same text.
TEST(Torture, WrittenSceneReadsBack) {
  int tables = 0;
  for (std::uint64_t seed = 1; seed <= 80; ++seed) {
    // Not Runge-Kutta, which may take many steps of its own.
    const Integrator integrator = seed % 2 ? Integrator::rattle : Integrator::implicit;
    const bool more = seed % 4 < 2;
    const Scene scene = generate(seed, {.integrator = integrator, .effects = more, .in_time = more, .steps = 3}).scene;
    const Scene copy = copy_of(scene);
    ASSERT_EQ(text_of(copy), text_of(scene)) << seed;
    ASSERT_EQ(after(copy, 3).differences(after(scene, 3)), std::vector<std::string>{}) << seed;
    ASSERT_EQ(copy.single, scene.single);
    tables += !tables_of(scene).empty();
  }
  EXPECT_GT(tables, 5);
}

// Sometimes pushes one body of every joint of that type without the opposite push on the other, like an impulse with a
// wrong sign.
Sabotage wrong_sign(const std::string& type) {
  return [type](const Scene& scene, int step, const Push& push) {
    if (step % 5 != 0) return;
    for (const SceneJoint& joint : scene.joints)
      for (const int body : joint.definition.bodies) {
        if (joint.definition.type != type || body == world_body) continue;
        const SceneBody& pushed = scene.bodies[static_cast<std::size_t>(body)];
        const double mass = pushed.definition.mass + pushed.spatial.mass;
        if (!pushed.is_static) push(body, mass);
        break;
      }
  };
}

// Many seeds find the fault, the shrunk scene contains the joint, and the printed scene shows the fault.
TEST(Torture, FindsAndShrinksWhatIsSabotaged) {
  Asked asked;
  asked.bits = false;
  asked.sabotage = wrong_sign("revolute");
  int found = 0, sound = 0;
  for (std::uint64_t seed = 1; found < 5 && seed < 400; ++seed) {
    const Mechanism mechanism =
        generate(seed, {.joint = "revolute", .solver = Solver::direct, .single = false, .steps = 40});
    const Verdict verdict = judge(mechanism.scene, asked);
    if (!verdict.broken()) {
      ++sound;
      continue;
    }
    const Shrunk small = shrink(mechanism.scene, verdict, [&](const Scene& scene) { return judge(scene, asked); });
    ++found;
    EXPECT_EQ(small.verdict.what, verdict.what);
    EXPECT_LE(small.scene.bodies.size(), 3u) << text_of(small.scene);
    EXPECT_LE(steps_of(small.scene), steps_of(mechanism.scene));
    const Scene copy = copy_of(small.scene);
    const Verdict again = judge(copy, asked);
    EXPECT_TRUE(again.broken());
    EXPECT_EQ(again.what, verdict.what);
    EXPECT_EQ(again.value, small.verdict.value);
    Asked honest = asked;
    honest.sabotage = {};
    EXPECT_FALSE(judge(copy, honest).broken()) << text_of(small.scene);
    fmt::print("seed {}: {}, {} bodies to {}, {} joints to {}, in {} tries\n", seed, verdict.what,
               mechanism.scene.bodies.size(), small.scene.bodies.size(), mechanism.scene.joints.size(),
               small.scene.joints.size(), small.tries);
  }
  EXPECT_EQ(found, 5);
  EXPECT_LT(sound, 20);
}

}  // namespace
}  // namespace cdot::torture
