// Rules that no joint of the catalogue needs, or few: their derivations obey the laws as well.
#include <gtest/gtest.h>

#include "derive/language/read.hpp"
#include "derive/proof/prove.hpp"

namespace cdot::derive {
namespace {

struct OneRule {
  const char* what;
  const char* space;
  const char* row;
};

const OneRule rules[] = {
    {"atan2 of numbers", "planar", "atan2(dot(t, u), norm(u)) = 1 [rad]"},
    {"the angle of a vector of any length", "planar", "angle(u, t) = 1 [rad]"},
    {"the angle of vectors in space", "spatial", "angle(u, t) = 1 [rad]"},
    {"perp in a sum", "planar", "norm(perp(u) + 1 [m] * t) = 2 [m]"},
    {"r x s + s x u, as one product", "planar", "dot(s, u) = 0"},
    {"t x z + e x t, as one product", "planar", "dot(t, e) + 1 [m] * dot(t, z) = 0"},
};

TEST(Rules, EachObeysTheLaws) {
  for (const OneRule& rule : rules) {
    const std::string text = std::string("joint own ") + rule.space +
                             "\n  \"own\"\n  point pa on a\n  point pb on b\n  unit t on b\n  unit z on a\n"
                             "  vector s [m] on b\n  let u = pa - pb\n  let e = pa - x(b)\n  " +
                             rule.row + "\n";
    const ReadResult read = read_joint(std::make_shared<SourceFile>("own.joint", text), {});
    ASSERT_TRUE(read.joint) << render(*read.file, read.diagnostics);
    const Proof proof = prove(*read.joint, derive_rows(*read.joint));
    for (const Law& law : proof.laws) EXPECT_FALSE(is_broken(law)) << rule.what << ": " << law.text;
    EXPECT_TRUE(proof.holds()) << rule.what;
  }
}

}  // namespace
}  // namespace cdot::derive
