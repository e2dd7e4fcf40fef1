// The ledger counts published formulas beside the generated ones if they agree at every pose. The ledger's tests check
// the counts.
#include <algorithm>
#include <gtest/gtest.h>

#include "tests/derive/diff/support.hpp"

using namespace cdot::derive;
using cdot::test::judged;

namespace {

// "K X-1 with t on a", one per row, sorted.
std::vector<std::string> rows_of(const Judgement& judgement) {
  std::vector<std::string> rows;
  for (const LedgerRow& row : judgement.costs) {
    rows.push_back(row.block + " " + row.quantity + " " + row.source);
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

using Rows = std::vector<std::string>;

}  // namespace

TEST(Cost, IsNotCountedOfWhatNeedsAnAssumption) {
  // On u = 0 the term of the turning normal is 0 and costs nothing.
  const Judgement judgement = judged("line", R"(
  assume pa = pb
  K = 1/m(a) + 1/m(b) + cross(ra, t)^2/I(a) + cross(rb, t)^2/I(b)
  C = dot(t, u)
)");
  EXPECT_EQ(judgement.agreement, Agreement::agrees_if);
  EXPECT_EQ(rows_of(judgement), (Rows{"rows C X-1"})) << "C needs nothing to be assumed";
}

TEST(Cost, IsNotCountedOfWhatNeedsAlignedFrames) {
  const Judgement judgement = judged("spatial/hinge", R"(
  assume fb.x = fa.x
  rows angle
  J = [ 0, -fa.x', 0, fa.x' ]
  K = dot(fa.x, I(a)^-1 * fa.x) + dot(fa.x, I(b)^-1 * fa.x)
)");
  EXPECT_EQ(judgement.agreement, Agreement::agrees_if);
  EXPECT_EQ(rows_of(judgement), Rows{});
}

TEST(Cost, IsNotCountedOfWhatDiffers) {
  const Judgement judgement = judged("line", R"(
  J = [ t', cross(ra, t), -t', -cross(rb, t) ]
  C = dot(t, u)
)");
  EXPECT_EQ(judgement.agreement, Agreement::differs);
  EXPECT_EQ(rows_of(judgement), (Rows{"rows C X-1"}));
}

TEST(Cost, OfSomeRowsOrOtherDirectionsStandsBesideWhatIsGeneratedOfThem) {
  const Judgement some = judged("prismatic", R"(
  assume t on a
  rows line
  C = dot(t, u)
)");
  EXPECT_EQ(rows_of(some), (Rows{"rows C X-1 of line with t on a", "rows C generated of line with t on a"}));
  const Judgement fixed = judged("spatial/hinge", R"(
  assume fa on b
  assume fb on a
  assume b immovable
  rows angle
  J = J
)");
  EXPECT_EQ(rows_of(fixed), (Rows{"angle J X-1 with fa on b and fb on a and b immovable",
                                  "angle J generated with fa on b and fb on a and b immovable"}));
  for (const Judgement* judgement : {&some, &fixed}) {
    ASSERT_EQ(judgement->costs.size(), 2u);
    EXPECT_EQ(judgement->costs[0].count, judgement->costs[1].count);
    EXPECT_GT(judgement->costs[0].count.total(), 0);
  }
}
