// Every effect of the catalogue: the methods keep their orders with the smooth ones, adaptive steps locate the events
// of the others, and the work by source is the change of energy. An effect without a scene fails.
#include <algorithm>
#include <fmt/format.h>

#include "tests/runtime/effects/catalogue_scenes.hpp"
#include "tests/runtime/effects/generated_effects.hpp"

namespace cdot::test::catalogue {
namespace {

constexpr double duration = 1, glance = 1. / 16;  // [s] a run, and a call of an adaptive step

void place(const Start& at, BodyDefinition& d) { d.w = at.w; }
void place(const Start& at, SpatialBodyDefinition& d) { d.wx = 0.3 * at.w, d.wy = -0.2 * at.w, d.wz = at.w; }

template <class S>
int add_body(BasicWorld<S>& world, const Start& at, double mass, double inertia) {
  typename S::BodyDefinition d;
  d.x = at.x, d.y = at.y, d.vx = at.vx, d.vy = at.vy, d.mass = mass;
  if constexpr (S::dimension == Dimension::planar) d.inertia = inertia;
  else d.inertia = {inertia, 0.9 * inertia, 1.2 * inertia};
  place(at, d);
  return world.add_body(d);
}

// The numbers of the scene, and places of points and axes that have no default.
std::vector<NamedValue> numbers_of(const Scene& scene, const JointType& type) {
  std::vector<NamedValue> numbers = scene.numbers;
  for (const ParameterInfo& info : type.parameters) {
    if (info.has_default || std::ranges::find(numbers, info.name, &NamedValue::name) != numbers.end()) continue;
    std::vector<double> of = {0.3, -0.2, 1};
    if (info.kind == ParameterKind::point)
      of = info.body == 0 ? std::vector{0.1, 0.05, 0.02} : std::vector{-0.1, 0.08, 0.03};
    if (scene.grounded && info.kind == ParameterKind::point) of = {0, 0, 0};
    if (info.size < 3) of.resize(static_cast<std::size_t>(info.size));
    numbers.push_back({std::string(info.name), of});
  }
  return numbers;
}

// As many bodies as the effect has, up to three, that move freely.
template <class S>
struct BetweenBodies {
  static void build(BasicWorld<S>& world, const Scene& scene) {
    const JointType& type = *find_joint_type(S::dimension, scene.name);
    std::vector<int> bodies = {add_body(world, scene.a, 2, 0.5)};
    if (type.bodies >= 2)
      bodies.push_back(scene.grounded ? world.ground() : add_body(world, {0, 0, -0.2, 0.1, -0.5}, 3, 0.8));
    if (type.bodies >= 3) bodies.push_back(add_body(world, {0.2, -0.8, 0.1, 0.3, 0.7}, 1.5, 0.4));
    world.add_joint({scene.name, bodies, numbers_of(scene, type), {}});
  }
};

// A pendulum in the plane, or a block on a rail that rises by 1 : 2. They start with the rate Start::w.
template <class S>
struct OnACoordinate {
  static void build(BasicWorld<S>& world, const Scene& scene) {
    const bool turns = find_coordinate_effect(scene.name)->acts_on("rad");
    const double rate = scene.a.w;
    const int body = add_body(world, turns ? Start{1, 0, 0, rate, rate} : Start{1, 0.5, 2 * rate, rate, 0}, 2, 0.5);
    JointDefinition joint{turns ? "revolute" : "prismatic", {world.ground(), body}, {{"pa", {0, 0}}}, {}};
    if (!turns) joint.parameters.push_back({"t", {-1, 2}});  // the normal of the rail
    const int number = world.add_joint(joint);
    const char* const coordinate = turns ? "angle" : "slide";
    add_effect(world, number, coordinate, SpecEffect{scene.name, scene.numbers});
    if (scene.ramp == 0) return;
    const Profile grows = Profile::table({.times = {0, duration}, .values = {0, scene.ramp * duration}});
    add_effect(world, number, coordinate, SpecEffect{"load", {in_time("push", {grows})}});
  }
};

Settings by(Integrator integrator, double local_error, double gravity) {
  Settings s = effects::with(integrator, -gravity);
  s.local_error = local_error;
  return s;
}

template <class S>
std::vector<double> places_of(const BasicWorld<S>& world) {
  std::vector<double> numbers;
  for (int body = 0; body < world.body_count(); ++body) {
    const auto pose = world.pose(body);
    if constexpr (S::dimension == Dimension::planar) numbers.insert(numbers.end(), {pose.x, pose.y, pose.angle});
    else numbers.insert(numbers.end(), {pose.x, pose.y, pose.z, pose.xx, pose.yx, pose.zx, pose.xy, pose.yy, pose.zy});
  }
  return numbers;
}

double distance_of(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
  return largest;
}

struct Ended {
  std::vector<double> places;
  double change = 0, work = 0;  // of the energy; and by all sources
  double unaccounted = 0;       // a share of what moved
  StepCounts counts;
};

template <class S, class Builder>
Ended run_of(const Scene& scene, const Settings& settings, double h) {
  BasicWorld<S> world(settings);
  Builder::build(world, scene);
  const double before = world.energy();
  BalanceWatch watch;
  watch.look(world.balance());
  for (long k = 0; k < std::lround(duration / h); ++k) {
    const StepResult step = world.step(h);
    if (!step) return ADD_FAILURE() << scene.name << ": " << in_words(step, "", ""), Ended{};
    watch.look(world.balance());
  }
  Ended ended{places_of(world), world.energy() - before, 0, watch.energy.share(), world.step_counts()};
  for (const WorkOfSource& of : world.work_by_source()) ended.work += of.work;
  return ended;
}

// The order that the errors above round-off show, the larger of those of the last two pairs of steps, of which one is
// half of the other. Nothing if all errors are round-off.
template <class S, class Builder>
std::optional<double> slope_of(const Scene& scene, Integrator integrator, double gravity, const Ended& exact) {
  constexpr double round_off = 3e-12;
  std::optional<double> slope, last;
  double before = 0;
  for (double h = 1. / 4; h >= 1. / 512; h /= 2) {
    const double error = distance_of(run_of<S, Builder>(scene, by(integrator, 0, gravity), h).places, exact.places);
    if (error < round_off) break;
    if (before > 0) last = slope, slope = std::log2(before / error);
    before = error;
  }
  return std::max(slope, last);
}

template <class S, class Builder>
void expect_orders(const Scene& scene, double gravity) {
  const Ended exact = run_of<S, Builder>(scene, by(Integrator::dop853, 1e-14, gravity), 0.25);
  std::string measured;
  for (const IntegratorRow& row : integrator_rows) {
    const auto slope = slope_of<S, Builder>(scene, row.integrator, gravity, exact);
    measured += slope ? fmt::format(" {:.1f}", *slope) : " exact";
    EXPECT_GT(slope.value_or(row.order), 0.85 * row.order) << scene.name << " by " << row.name;
  }
  fmt::print("  {}:{}\n", scene.name, measured);
}

// The largest error of runs of `steps` fixed steps and of a few more: where an event falls within a step, the error has
// any size up to the bound of its order.
template <class S, class Builder>
double error_around(const Scene& scene, Integrator integrator, double gravity, const Ended& exact, int steps) {
  double largest = 0;
  for (const int more : {0, 1, 3, 4}) {
    const Ended ended = run_of<S, Builder>(scene, by(integrator, 0, gravity), duration / (steps + more));
    largest = std::max(largest, distance_of(ended.places, exact.places));
  }
  return largest;
}

template <class S, class Builder>
void expect_located(const Scene& scene, double gravity) {
  const Ended exact = run_of<S, Builder>(scene, by(Integrator::dop853, 1e-13, gravity), glance);
  EXPECT_GT(exact.counts.events, 0) << scene.name << ": give a scene in which something happens";
  std::string measured;
  for (const Integrator integrator : {Integrator::rk4, Integrator::dop853})
    for (const double tolerance : {1e-6, 1e-9}) {
      const Ended ended = run_of<S, Builder>(scene, by(integrator, tolerance, gravity), glance);
      const double error = distance_of(ended.places, exact.places);
      measured += fmt::format(" {:.0e}", error);
      EXPECT_LT(error, 100 * tolerance) << scene.name << " by " << row_of(integrator).name;
      EXPECT_EQ(ended.counts.rescued, 0) << scene.name << " by " << row_of(integrator).name;
    }
  for (const IntegratorRow& row : integrator_rows) {  // fixed steps: at least first order
    const double coarse = error_around<S, Builder>(scene, row.integrator, gravity, exact, 32);
    const double fine = error_around<S, Builder>(scene, row.integrator, gravity, exact, 512);
    const double slope = std::log2(coarse / fine) / 4;
    measured += fmt::format(" {} {:.0e} {:.1f}", row.name, fine, slope);
    EXPECT_LT(fine, 2e-2) << scene.name << " by " << row.name;
    EXPECT_TRUE(slope > 0.8 || fine < (scene.rubs_as_it_lands ? 5e-5 : 1e-8))
        << scene.name << " by " << row.name << ": " << slope;
  }
  fmt::print("  {}:{}\n", scene.name, measured);
}

template <class S, class Builder>
void expect_closed(const Scene& scene, double gravity) {
  const auto unaccounted = [&](Integrator integrator, double h) {
    return run_of<S, Builder>(scene, by(integrator, 0, gravity), h).unaccounted;
  };
  for (const IntegratorRow& row : integrator_rows) {
    const double coarse = unaccounted(row.integrator, 1. / 256), fine = unaccounted(row.integrator, 1. / 512);
    EXPECT_LT(coarse, row.order < 2               ? 0.15
                      : scene.kind == Kind::event ? 1e-2
                                                  : 2e-3)
        << scene.name << " by " << row.name;
    EXPECT_TRUE(fine < 1e-3 || fine < 0.7 * coarse) << scene.name << " by " << row.name << ": " << coarse / fine;
  }
  const double tolerance = scene.kind == Kind::event ? 1e-6 : 1e-9;
  const Ended ended = run_of<S, Builder>(scene, by(Integrator::dop853, 1e-11, gravity), glance);
  EXPECT_NEAR(ended.work, ended.change, tolerance * (1 + std::abs(ended.change))) << scene.name;
  EXPECT_LT(ended.unaccounted, tolerance) << scene.name;
}

// f(scene, gravity) for each effect of the types.
template <class F>
void each_effect(std::span<const JointType> types, const std::vector<Scene>& scenes, F f) {
  for (const JointType& type : types) {
    if (!type.is_effect) continue;
    const auto scene = std::ranges::find(scenes, type.name, &Scene::name);
    if (scene == scenes.end()) ADD_FAILURE() << "give a scene for the effect " << type.name << ": catalogue_scenes.hpp";
    else f(*scene);
  }
}

std::vector<JointType> on_any_coordinate() {
  std::vector<JointType> types;
  for (const JointType& type : coordinate_effects())
    if (type.bodies == 0 && !type.acts_on_joint()) types.push_back(type);
  return types;
}

// f(std::type_identity<S>, std::type_identity<Builder>, scene, gravity) over the whole catalogue.
template <class F>
void over_the_catalogue(F f) {
  using Plane = Planar<double>;
  using Space = Spatial<double>;
  each_effect(joint_types(Dimension::planar), planar_scenes(), [&](const Scene& scene) {
    f(std::type_identity<Plane>{}, std::type_identity<BetweenBodies<Plane>>{}, scene, scene.gravity);
  });
  each_effect(joint_types(Dimension::spatial), spatial_scenes(), [&](const Scene& scene) {
    f(std::type_identity<Space>{}, std::type_identity<BetweenBodies<Space>>{}, scene, scene.gravity);
  });
  each_effect(on_any_coordinate(), coordinate_scenes(), [&](const Scene& scene) {
    f(std::type_identity<Plane>{}, std::type_identity<OnACoordinate<Plane>>{}, scene, 3.0);
  });
}

TEST(Catalogue, MethodsKeepTheirOrdersWithEverySmoothEffect) {
  over_the_catalogue([]<class S, class B>(std::type_identity<S>, std::type_identity<B>, const Scene& scene, double g) {
    if (scene.kind == Kind::smooth) expect_orders<S, B>(scene, g);
  });
}

TEST(Catalogue, AdaptiveStepsLocateTheEventsOfEveryOtherEffect) {
  over_the_catalogue([]<class S, class B>(std::type_identity<S>, std::type_identity<B>, const Scene& scene, double g) {
    if (scene.kind == Kind::event) expect_located<S, B>(scene, g);
  });
}

TEST(Catalogue, TheWorkBySourceIsTheChangeOfEnergy) {
  over_the_catalogue([]<class S, class B>(std::type_identity<S>, std::type_identity<B>, const Scene& scene, double g) {
    expect_closed<S, B>(scene, g);
  });
}

}  // namespace
}  // namespace cdot::test::catalogue
