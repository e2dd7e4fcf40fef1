// Every spec and every hand derivation of the catalogue is read without messages.
#include <gtest/gtest.h>

#include "derive/language/specs_folder.hpp"
#include "tests/derive/language/reading.hpp"

namespace cdot::derive {
namespace {

TEST(Catalogue, SpecsAreReadWithoutErrors) {
  const Library library = library_of(CDOT_SOURCE_DIR "/specs/planar");
  EXPECT_GE(library.size(), 20u);
  for (const auto& [name, file] : library) {
    const ReadResult r = read_joint(file, library);
    ASSERT_TRUE(r.joint) << render(*file, r.diagnostics);
    EXPECT_EQ(r.joint->name, name);
    EXPECT_FALSE(r.joint->title.empty()) << name;
    EXPECT_FALSE(r.joint->source.empty()) << name;
    EXPECT_FALSE(r.joint->comment.empty()) << name;
  }
}

TEST(Catalogue, SpecsHaveNothingUnused) {
  const Library library = library_of(CDOT_SOURCE_DIR "/specs/planar");
  for (const auto& [name, file] : library) EXPECT_EQ(render(*file, read_joint(file, library).diagnostics), "");
}

TEST(Catalogue, HandDerivationsAreReadWithoutErrors) {
  const Library library = library_of(CDOT_SOURCE_DIR "/specs/planar");
  int entries = 0;
  for (const auto& f : std::filesystem::directory_iterator(CDOT_SOURCE_DIR "/specs/planar")) {
    if (f.path().extension() != ".hand") continue;
    const auto joint = library.find(f.path().stem().string());
    std::filesystem::path effect = f.path();
    const auto spec = joint != library.end() ? joint->second : file_of(effect.replace_extension(".effect"));
    const std::string messages = messages_about_hand(file_of(f.path()), spec, library);
    EXPECT_EQ(messages.find(": error:"), std::string::npos) << messages;
    entries += static_cast<int>(read_hand(file_of(f.path())).entries.size());
  }
  EXPECT_GT(entries, 80);
}

// A folder with the name of a spec is no spec.
TEST(Catalogue, AFolderNamedAsASpecIsNone) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "cdot_folder_as_spec";
  std::filesystem::create_directories(folder / "planar" / "X.joint");
  std::filesystem::copy_file(CDOT_SOURCE_DIR "/specs/planar/line.joint", folder / "planar" / "line.joint",
                             std::filesystem::copy_options::overwrite_existing);
  const SpecsFolder specs(folder);
  EXPECT_EQ(specs.all(), std::vector{folder / "planar" / "line.joint"});
  EXPECT_TRUE(specs.read(specs.find("line")).joint);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace cdot::derive
