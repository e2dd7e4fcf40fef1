// Runs every joint in space with both solvers, between bricks in free space: projected onto C = 0, then pushed. The
// momentum is that of the push, unless the joint connects to the world.
#include "tests/runtime/spatial_support.hpp"

namespace cdot::test {
namespace {

using spatial::Vector;

bool holds_the_world(const JointType& type) {
  for (const ParameterInfo& info : type.parameters)
    if (info.body < 0 && info.kind != ParameterKind::scalar) return true;
  return false;
}

class Catalogue : public testing::TestWithParam<const JointType*> {};

TEST_P(Catalogue, RunsAndConservesMomentum) {
  const JointType& type = *GetParam();
  for (Solver solver : {Solver::direct, Solver::iterative}) {
    Settings s = settings(solver);
    s.iterations = 30;
    SpatialWorld<double> world(s);
    JointDefinition joint{std::string(type.name), {}, some_values(type), {}};
    for (int i = 0; i < type.bodies; ++i)
      joint.bodies.push_back(world.add_body(brick(0.8 * i, 0.3 * i, -0.2 * i, 1 + 0.5 * i)));
    world.add_joint(joint);
    for (int body : joint.bodies) world.apply_impulse(body, {0.2 * body, 0.1, -0.1, 0.02, -0.01 * body, 0.03});
    const bool fits{world.project(1e-9)};
    EXPECT_TRUE(fits) << type.name;
    const SpatialMomentum before = momentum(world);
    run(world, 1, 0.002);
    const SpatialMomentum after = momentum(world);
    EXPECT_LT(world.worst_position_error().value, 1e-6) << type.name;
    if (!holds_the_world(type) && !type.explicit_time) {
      EXPECT_LT(norm(after.linear - before.linear), 1e-11) << type.name;
      EXPECT_LT(norm(after.angular - before.angular), solver == Solver::direct ? 1e-10 : 1e-5) << type.name;
    }
    for (int body : joint.bodies) EXPECT_EQ(off_unit(world.pose(body)), 0);
  }
}

std::vector<const JointType*> all_types() {
  std::vector<const JointType*> types;
  for (const JointType& type : joint_types(Dimension::spatial))
    if (!type.is_effect) types.push_back(&type);
  return types;
}

INSTANTIATE_TEST_SUITE_P(Spatial, Catalogue, testing::ValuesIn(all_types()),
                         [](const auto& info) { return std::string(info.param->name); });

}  // namespace
}  // namespace cdot::test
