// A thousand rods in chains or trees without loops: the joints are as exact as with ten.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::long_chains_and_trees {
namespace {

constexpr int rods = 1000;

struct Kind {
  int branches;       // rods that hang from each rod
  const char* joint;  // their joint
};
constexpr Kind pin_chain{1, "revolute"}, pin_tree{2, "revolute"}, ball_chain{1, "spherical"},
    cross_tree{2, "universal"};

// Angle to the vertical at the start [rad].
double slant_of(int rod) { return rod % 2 == 0 ? 0.4 : -0.3; }

// Places a rod below its joint, in the plane of x and the vertical.
void place(SceneBody& rod, Dimension dimension, const Vec3& top, double slant) {
  const double x = top[0] + std::sin(slant) / 2, up = top[1] - std::cos(slant) / 2;
  if (dimension == Dimension::planar) {
    rod.definition.x = x, rod.definition.y = up;
    rod.definition.angle = slant - pi / 2;
  } else {
    rod.spatial.x = x, rod.spatial.z = up;
    rod.spatial.e0 = std::cos((pi / 2 - slant) / 2);
    rod.spatial.e2 = std::sin((pi / 2 - slant) / 2);
  }
}

void add_joint(Trial& t, const Kind& kind, int a, int b, double slant) {
  const double end = a == world_body ? 0 : 0.5;
  SceneJoint joint;
  if (t.scene.dimension == Dimension::planar)
    joint.definition = {kind.joint, {a, b}, {{"pa", {end, 0}}, {"pb", {-0.5, 0}}}, {}};
  else joint.definition = {kind.joint, {a, b}, {{"pa", {end, 0, 0}}, {"pb", {-0.5, 0, 0}}}, {}};
  if (kind.joint == cross_tree.joint) {  // shafts along the rods
    const Vec3 shaft = a == world_body ? Vec3{std::sin(slant), 0, -std::cos(slant)} : Vec3{1, 0, 0};
    joint.definition.parameters.push_back({"fa", {shaft[0], shaft[1], shaft[2], 0, 1, 0}});
  }
  t.scene.joints.push_back(joint);
}

// Returns the potential energy above the vertical pose [J].
double hang(Trial& t, const Kind& kind, bool slanting) {
  const SceneBody one = t.scene.bodies[0];
  std::vector<Vec3> ends;
  std::vector<int> depth;
  double above = 0;
  t.scene.bodies.clear();
  for (int k = 0; k < rods; ++k) {
    const int from = k == 0 ? world_body : (k - 1) / kind.branches;
    const double slant = slanting ? slant_of(k) : 0;
    const Vec3 top = k == 0 ? Vec3{} : ends[static_cast<std::size_t>(from)];
    depth.push_back(k == 0 ? 0 : depth[static_cast<std::size_t>(from)] + 1);
    ends.push_back({top[0] + std::sin(slant), top[1] - std::cos(slant), 0});
    above += g * (top[1] - std::cos(slant) / 2 + depth.back() + 0.5);
    SceneBody rod = one;
    place(rod, t.scene.dimension, top, slant);
    t.scene.bodies.push_back(rod);
    add_joint(t, kind, from, k, slant);
  }
  return above;
}

void rest(Trial& t, const Kind& kind) {
  hang(t, kind, false);
  t.start();
  const Watch w = t.run(0.1);
  t.at_most("gap [m]", w.gap, 1e-6, 1e-3);
  t.near("force of the top joint, relative to their weight", t.force(0) / (rods * g), 1, 1e-9, 1e-3);
}

void sway(Trial& t, const Kind& kind) {
  const double above = hang(t, kind, true);
  t.start();
  const Watch w = t.run(0.25);
  t.at_most("gap [m]", w.gap, 1e-6, 1e-3);
  t.at_most("energy gained, of the fall's", w.rise / above, 1e-2);
  if (t.way.integrator == Integrator::rattle || t.way.integrator == Integrator::rk4)
    t.at_most("energy off by second or fourth order", w.drift() / above, 1e-3);
  if (t.way.integrator == Integrator::dop853) t.at_most("energy off by eighth order", w.drift() / above, 1e-8, 1e-5);
}

Case resting(const char* scene, const Ways& ways, const Kind& kind, const std::string& variant) {
  return {"long_chains_and_trees", scene, ways, [kind](Trial& t) { rest(t, kind); }, variant + " at rest", true};
}
Case swaying(const char* scene, const Kind& kind, const std::string& variant) {
  return {"long_chains_and_trees", scene, direct(), [kind](Trial& t) { sway(t, kind); }, variant, true};
}

// A thousand metres down the spacing of floats is 6e-5 m: RATTLE's drift does not converge there.
Ways but_rattle_in_float() { return without(direct(), {Integrator::rattle}) + in_double(direct()); }

const Register all[] = {Register(resting("planar", direct(), pin_chain, "chain")),
                        Register(swaying("planar", pin_chain, "chain")),
                        Register(resting("planar", direct(), pin_tree, "tree")),
                        Register(swaying("planar", pin_tree, "tree")),
                        Register(resting("spatial", but_rattle_in_float(), ball_chain, "chain")),
                        Register(swaying("spatial", ball_chain, "chain")),
                        Register(resting("spatial", direct(), cross_tree, "tree")),
                        Register(swaying("spatial", cross_tree, "tree"))};

}  // namespace
}  // namespace cdot::hard::long_chains_and_trees
