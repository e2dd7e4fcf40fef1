// Mechanisms that rest without gravity: all their energy is round-off, or what the local error lets them move beside
// stiff springs and dampers, and no run fails by it.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <string>

#include "runtime/text/files.hpp"
#include "tests/runtime/tool/followed_advice.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::rest_test {
namespace {

std::string body(const std::string& name, double mass, double x) {
  return fmt::format("[[body]]\nname = \"{}\"\nmass = {}\nshape = {{ box = [1, 0.1, 0.2] }}\nposition = [{}, 0, 0]\n",
                     name, mass, x);
}
std::string joint(const std::string& type, const std::string& bodies, double x, const std::string& more) {
  return fmt::format("[[joint]]\ntype = \"{}\"\nbodies = [{}]\nat = [{}, 0, 0]\n{}", type, bodies, x, more);
}
std::string spring(double x, double y, double stiffness, double damping) {
  return fmt::format(
      "[[spring]]\nbodies = [\"world\", \"rod\"]\npa = [{}, {}, 0]\npb = [0.5, 0, 0]\nstiffness = {}\ndamping = {}\n",
      x, y, stiffness, damping);
}

void expect_rest(const std::string& name, const std::string& text) {
  const TemporaryFolder folder;
  const std::string file = (folder / "rest.toml").string();
  text::write_file(file, "dimension = 3\ngravity = [0, 0, 0]\nduration = 1.5\n" + text);
  const Ran ran = simulated(file, "");
  EXPECT_TRUE(ran.silent()) << name << "\n" << ran.summary.dump(2);
}

TEST(Rest, IsNoFailure) {
  const std::string along_z = "fa = { world = [0, 0, 1] }\n";
  expect_rest("a stiff spring at its length",
              body("rod", 5, 0.5) + body("middle", 0.5, 1.5) + body("end", 5, 2.5) +
                  joint("spherical", "\"world\", \"rod\"", 0, "") +
                  joint("cylindrical", "\"rod\", \"middle\"", 1, along_z + "slide.damper = 0.3\n") +
                  joint("cylindrical", "\"middle\", \"end\"", 2, along_z) + spring(0.84, 1.49, 2000, 0));
  expect_rest("a stiff damper", body("rod", 0.5, 0.5) +
                                    joint("cylindrical", "\"world\", \"rod\"", 0, along_z + "slide.friction = 0.2\n") +
                                    spring(1.53, 0.78, 20, 20));
  expect_rest("a motor that a rope holds",
              body("rod", 0.5, 0.5) +
                  joint("slider", "\"world\", \"rod\"", 0,
                        "fa = { world = [0, 0.6, 0.8] }\nslide.motor = { speed = -1.49, max = 3 }\n"
                        "slide.load = \"1.8 [N] * sin(2*time / 1 [s])\"\n") +
                  spring(-0.07, 0.93, 20, 1) +
                  "[[joint]]\ntype = \"max_distance\"\nbodies = [\"world\", \"rod\"]\npa = [1.49, 0.77, 0]\n"
                  "pb = [0.25, 0, 0]\n");
}

}  // namespace
}  // namespace cdot::test::rest_test
