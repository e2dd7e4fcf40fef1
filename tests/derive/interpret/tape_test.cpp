// Tapes give the bits of compiled kernels: C and the stored numbers of J of every joint and coordinate.
#include "derive/interpret/tape.hpp"

#include <cstring>
#include <filesystem>
#include <gtest/gtest.h>
#include <map>

#include "derive/kernel/plan.hpp"
#include "derive/language/specs_folder.hpp"
#include "tests/kernels/sample.hpp"

namespace cdot::derive {
namespace {

// The inputs by the names that programs have for them.
std::map<std::string, double> named(const Joint& joint, const AnyBlock& block, const Inputs& in) {
  std::map<std::string, double> values = {{"time", in.time[0]}};
  const std::vector<std::string> planar = {"x", "y", "c", "s", "angle"},
                                 spatial = {"x",  "y",  "z",  "e0", "e1", "e2", "e3", "xx",
                                            "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"};
  const std::vector<std::string>& pose = block.planar() ? planar : spatial;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    for (std::size_t k = 0; k < pose.size(); ++k) {
      const double value = in.q[b * pose.size() + k];
      values[joint.bodies[b] + "." + pose[k]] = value;
      values["x_" + joint.bodies[b] + "_" + pose[k]] = value;
    }
    values["theta_" + joint.bodies[b]] = in.q[b * pose.size() + 4];
  }
  std::size_t at = 0;
  for (const Parameter& parameter : joint.parameters)
    for (const std::string& field : fields_of(joint, parameter)) {
      values["p." + field] = in.p[at];
      values[field] = in.p[at++];
    }
  return values;
}

// The number of outputs that were compared.
std::size_t expect_same_bits(const Joint& joint, const KernelBlock& kernel, const AnyBlock& block) {
  const Inputs in = random_inputs(block, 7);
  const std::map<std::string, double> values = named(joint, block, in);
  const Outputs compiled = block.evaluate(std::span(&in, 1))[0];
  std::size_t compared = 0;
  for (const KernelFunction& f : kernel.functions) {
    const auto number = std::ranges::find(function_names, f.name) - function_names.begin();
    if (f.isotropic || (number != position && number != jacobian)) continue;
    const NamedTape tape(f.program);
    std::vector<double> inputs, to(tape.outputs().size()), registers = tape.registers();
    for (const std::string& name : tape.inputs()) inputs.push_back(values.at(name));
    tape.run(inputs, registers, to);
    const std::vector<double>& expected = compiled.of[static_cast<std::size_t>(number)];
    EXPECT_EQ(expected.size(), to.size()) << joint.name << " " << f.name;
    for (std::size_t k = 0; k < std::min(to.size(), expected.size()); ++k, ++compared)
      EXPECT_EQ(std::memcmp(&to[k], &expected[k], sizeof(double)), 0)
          << block.joint << " " << block.block << " " << tape.outputs()[k] << ": " << to[k] << ", " << expected[k];
  }
  return compared;
}

class OfSpace : public testing::TestWithParam<int> {};

TEST_P(OfSpace, TapesGiveTheBitsOfCompiledKernels) {
  const SpecsFolder folder(CDOT_SOURCE_DIR "/specs");
  std::size_t compared = 0;
  std::map<std::string, Kernel> kernels;
  std::map<std::string, Derivation> derivations;
  for (const AnyBlock& block : blocks<double>()) {
    if (block.dimension != GetParam() || block.immovable >= 0) continue;
    const std::string joint = std::string(block.space()) + "/" + block.joint;
    if (!kernels.contains(joint)) {
      const std::string spec = CDOT_SOURCE_DIR "/specs/" + joint;
      const ReadResult read = folder.read(spec + (std::filesystem::exists(spec + ".effect") ? ".effect" : ".joint"));
      const Derivation& derivation = derivations.emplace(joint, derive(*read.joint)).first->second;
      kernels.emplace(joint, simplified(plan(derivation)));
    }
    const Kernel& kernel = kernels.at(joint);
    if (!block.is_coordinate) compared += expect_same_bits(kernel.derivation->joint, kernel.rows, block);
    for (const KernelBlock& coordinate : kernel.coordinates)
      if (coordinate.name == block.block) compared += expect_same_bits(kernel.derivation->joint, coordinate, block);
  }
  EXPECT_GT(compared, 100u);
}

INSTANTIATE_TEST_SUITE_P(Tape, OfSpace, testing::Values(2, 3));

// A run changes neither constants nor other runs.
TEST(Tape, RunsRepeatTheirBits) {
  Pool pool;
  const Expr x = pool.symbol("x", Role::given);
  const std::vector<NamedExpr> outputs = {{"y", Rational(1, 3) * call(Fn::sin, x) - pow(x, 3) + pool.number(2)}};
  const NamedTape tape(assemble(outputs));
  std::vector<double> registers = tape.registers();
  for (const double at : {0.7, -1.2, 0.7}) {
    double y = 0;
    tape.run(std::span(&at, 1), registers, {&y, 1});
    EXPECT_NEAR(y, std::sin(at) / 3 - at * at * at + 2, 1e-15) << at;
  }
}

}  // namespace
}  // namespace cdot::derive
