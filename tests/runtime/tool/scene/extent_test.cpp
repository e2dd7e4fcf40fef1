// The size of a mechanism, to which accuracies are relative.
#include "runtime/tool/scene/extent.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "runtime/tool/scene/scene.hpp"

namespace cdot::test {
namespace {

TEST(Extent, IsOfEachMechanism) {
  const Scene scene = read_scene(std::string_view(R"(
[[body]]
name = "near"
mass = 1
inertia = 1
position = [0.3, 0.4]
[[body]]
name = "far"
mass = 1
shape = { rod = 2 }
position = [1000, 0]
[[body]]
name = "wall"
static = true
position = [500, 0]
[[body]]
name = "alone"
mass = 1
inertia = 1
[[body]]
name = "partner"
mass = 1
inertia = 1
position = [0, 0.4]
[[spring]]
bodies = ["near", "partner"]
stiffness = 1
[[joint]]
type = "revolute"
bodies = ["near", "wall"]
at = [0, 0]
[[joint]]
type = "revolute"
bodies = ["far", "wall"]
at = [999, 0]
)"),
                                 "extent.toml");
  const Extents extents = extents_of(scene);
  EXPECT_EQ(extents.mechanisms, 3);
  EXPECT_NEAR(extents.of_body[0], 0.5, 1e-12);
  EXPECT_NEAR(extents.of_body[1], std::hypot(2, 0.12), 1e-12);  // the rod's width is 0.06 of its length
  EXPECT_EQ(extents.of_body[3], 0);
  EXPECT_EQ(extents.of_body[4], extents.of_body[0]);
  EXPECT_EQ(extents.bodies, (std::vector<int>{2, 1, 0, 1, 2}));
}

}  // namespace
}  // namespace cdot::test
