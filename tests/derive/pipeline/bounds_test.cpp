// A bound that ends the search for short programs is told, and leaves a kernel that is right.
#include <gtest/gtest.h>
#include <regex>

#include "derive/pipeline/pipeline.hpp"

namespace {

using namespace cdot::derive;

constexpr const char* told = "that may have more operations than need be: ";

int functions_told(const std::string& complaints) {
  const std::size_t at = complaints.find(told);
  return at == std::string::npos ? 0 : std::stoi(complaints.substr(at + std::string(told).size()));
}

int operations(const GeneratedJoint& joint) {
  int total = 0;
  for (const LedgerRow& row : joint.ledger) total += row.count.total();
  return total;
}

TEST(SearchBounds, AreToldWhereTheyEndASearch) {
  const SpecsFolder folder(CDOT_SOURCE_DIR "/specs");
  const auto path = folder.find("planar/line");
  const Outcome usual = derive_spec(path, folder, {});
  EXPECT_EQ(usual.complaints, "");
  const Outcome each = derive_spec(path, folder, {}, {usual_bounds.kernel, 100});
  const Outcome all = derive_spec(path, folder, {}, {20000, usual_bounds.program});
  for (const Outcome* bounded : {&each, &all}) {
    EXPECT_TRUE(bounded->proved);
    EXPECT_GE(functions_told(bounded->complaints), 3) << bounded->complaints;
    EXPECT_TRUE(std::regex_search(bounded->complaints, std::regex("line\\.joint:[0-9]+:[0-9]+: warning: .*longest is "
                                                                  "[a-z_]+, with [1-9][0-9]* operations")))
        << bounded->complaints;
    EXPECT_GE(operations(bounded->joint), operations(usual.joint));
  }
  EXPECT_GT(operations(each.joint), operations(usual.joint));
  EXPECT_LT(functions_told(all.complaints), functions_told(each.complaints)) << "the first functions have work left";
  std::printf("%s", each.complaints.c_str());
}

}  // namespace
