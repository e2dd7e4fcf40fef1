// Two specs that differ only in names give kernels that differ only in names, for all clashes of names.
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "tests/kernels/law.hpp"

using namespace cdot;

std::string cdot::specs_folder() { return CDOT_SPECS; }

namespace {

std::vector<AnyBlock> blocks_of(const std::string& joint) {
  std::vector<AnyBlock> found;
  for (const AnyBlock& block : blocks<double>()) {
    if (block.joint == joint) found.push_back(block);
  }
  return found;
}

}  // namespace

TEST(Twins, compute_the_same) {
  const std::vector<AnyBlock> taken = blocks_of("clash"), plain = blocks_of("plain");
  ASSERT_EQ(taken.size(), plain.size());
  ASSERT_EQ(taken.size(), 6u) << "rows and one coordinate, each with two variants";
  for (std::size_t b = 0; b < taken.size(); ++b) {
    for (std::uint32_t seed = 1; seed <= samples; ++seed) {
      const Inputs in = random_inputs(plain[b], seed);
      const Outputs one = evaluate_one(taken[b], in), other = evaluate_one(plain[b], in);
      for (std::size_t f = 0; f < number_of_functions; ++f) {
        // Names determine the order of terms and of stored fields, so the last bits may differ.
        if (f == jacobian) continue;
        const Eigen::VectorXd expected = vector(other.of[f]);
        expect_near(taken[b], function_names[f], vector(one.of[f]), expected, 1e-9 * (1 + expected.norm()));
      }
    }
  }
}
