// The limit: chains in the plane in minimal coordinates, by the same method of order 8.
#include <memory>

#include "tests/bench/peers/engines/minimal_chain.hpp"

namespace cdot::peers {
namespace {

// True for pins alone, each of which hangs a body on the one before.
bool is_chain(const Problem& problem) {
  bool chain = problem.planar && problem.joints.size() == problem.bodies.size();
  for (int k = 0; chain && k < int(problem.joints.size()); ++k) {
    const Joint& joint = problem.joints[std::size_t(k)];
    const Body& body = problem.bodies[std::size_t(k)];
    chain = joint.kind == JointKind::revolute && joint.a == (k == 0 ? world : k - 1) && joint.b == k && !joint.motor &&
            !joint.stops && !joint.spring && !joint.soft && body.moves && body.turns && body.damping == 0 &&
            body.torque == Vec3{};
  }
  return chain;
}

std::vector<Series> series(const Problem& problem) {
  const auto by = [&](auto start) { return std::vector<Series>{{"dop853", "", "h", fine_steps(problem), start}}; };
  if (!is_chain(problem) || problem.reference.empty()) return {};
  if (problem.bodies.size() == 2) return by([&](double h) { return std::make_unique<ChainRun<2>>(problem, h); });
  if (problem.bodies.size() == 3) return by([&](double h) { return std::make_unique<ChainRun<3>>(problem, h); });
  if (problem.bodies.size() == 10) return by([&](double h) { return std::make_unique<ChainRun<10>>(problem, h); });
  return {};
}

const Registration registration{{.name = "Minimal by hand",
                                 .version = "",
                                 .number = "double",
                                 .colour = "#57606a",
                                 .changed = "no engine: this chain in minimal coordinates, written by hand",
                                 .series = series,
                                 .is_limit = true}};

}  // namespace
}  // namespace cdot::peers
