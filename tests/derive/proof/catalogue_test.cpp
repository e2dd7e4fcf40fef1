// One test per spec of the catalogue: its rows and coordinates obey the laws, and the check reports notes only.
#include <gtest/gtest.h>

#include "derive/check/check.hpp"
#include "derive/language/specs_folder.hpp"

namespace cdot::derive {
namespace {

SpecsFolder specs() { return SpecsFolder(std::filesystem::path(CDOT_SOURCE_DIR) / "specs"); }

class CatalogueSpec : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(CatalogueSpec, ObeysTheLawsAndIsClean) {
  const ReadResult read = specs().read(GetParam());
  ASSERT_TRUE(read.joint) << render(*read.file, read.diagnostics);
  const CheckReport report = check(read);
  EXPECT_EQ(report.proofs.size(), 1 + derive(*read.joint).joint.coordinates.size());
  // force, slopes, opposite; slopes alone where all rows have bounds
  const std::size_t of_law = !read.joint->law ? 0 : read.joint->law->inputs.empty() ? 1 : 3;
  for (const Proved& proved : report.proofs) {
    EXPECT_EQ(proved.proof.laws.size(), static_cast<std::size_t>(number_of_laws) + (proved.name.empty() ? of_law : 0));
    EXPECT_TRUE(proved.proof.holds()) << proved.name;
  }
  for (const Finding& f : report.findings) {
    EXPECT_EQ(f.level, Level::note) << render(*read.file, f);
  }
}

std::string name_of_spec(const testing::TestParamInfo<std::filesystem::path>& info) {
  return info.param.parent_path().filename().string() + "_" + info.param.stem().string();
}

INSTANTIATE_TEST_SUITE_P(Specs, CatalogueSpec, testing::ValuesIn(specs().all()), name_of_spec);

}  // namespace
}  // namespace cdot::derive
