#include "derive/compile/readings/readings.hpp"

#include "derive/kernel/factor.hpp"

namespace cdot::compile {
namespace {

using derive::element;

// A motor without a largest force is an equation on the coordinate of another one.
bool is_of_scene(const Joint& joint) { return joint.coordinate.empty(); }

// The joint's bodies and numbers with the row of a coordinate, which is there after the joint has broken, too.
RowBlock on_coordinate(const RowBlock& joint, const std::string& coordinate) {
  RowBlock block = joint;
  block.name += "_" + coordinate, block.rows = &joint.spec->coordinates.at(coordinate), block.holds = -1;
  return block;
}

}  // namespace

std::vector<std::string> coordinates_of(const Mechanism& mechanism) {
  std::vector<std::string> names;
  for (const Joint& joint : mechanism.joints)
    for (const std::string& coordinate : joint.coordinates) names.push_back(joint.name + "." + coordinate);
  return names;
}

std::vector<std::string> joints_of(const Mechanism& mechanism, const Names& names) {
  std::vector<std::string> joints;
  for (std::size_t j = 0; j < mechanism.joints.size(); ++j)
    if (is_of_scene(mechanism.joints[j])) joints.push_back(names.joints[j]);
  return joints;
}

Program read_coordinates(const RowBlocks& blocks, Constants& constants) {
  Algebra algebra(constants);
  std::size_t number = 0;
  for (std::size_t j = 0; j < blocks.mechanism().joints.size(); ++j)
    for (const std::string& coordinate : blocks.mechanism().joints[j].coordinates) {
      const RowBlock block = on_coordinate(blocks.joint(j), coordinate);
      const Values in = blocks.inputs_with_jacobian(algebra, block);
      Summands rate{{blocks.call(algebra, block, "velocity", in).at("Jv[0]")}, {1}};
      if (block.rows->has_rates || block.in_time)
        rate.add(1, blocks.call(algebra, block, "time_derivative", in).at("C_t[0]"));
      algebra.output(element("value", number), blocks.call(algebra, block, "position", in).at("C[0]"));
      algebra.output(element("rate", number++), algebra.sum(rate));
    }
  return algebra.finish();
}

Program read_reactions(const RowBlocks& blocks, const JointRows& joints, Constants& constants) {
  Algebra algebra(constants);
  const Mechanism& all = blocks.mechanism();
  std::size_t number = 0;
  for (std::size_t k = 0; k < joints.system().blocks().size(); ++k) {
    const RowBlock& block = joints.system().blocks()[k];
    if (!is_of_scene(*block.joint)) continue;
    std::vector<int> lambda;
    for (std::size_t r = 0; r < block.rows->count(); ++r)
      lambda.push_back(algebra.input(element("lambda", joints.system().first_row(k) + r)));
    Forces forces;
    blocks.add_forces(algebra, block, blocks.inputs_with_jacobian(algebra, block), lambda, forces);
    for (std::size_t c = 0; c < all.columns(); ++c)
      algebra.output(element("load", number) + "." + all.column(c), algebra.sum(forces[{block.bodies->back(), c}]));
    ++number;
  }
  return algebra.finish();
}

}  // namespace cdot::compile
