// Every broken file of the corpus gives exactly the messages that stand beside it. CDOT_UPDATE=1
// rewrites them: read each as the person who made the mistake.
#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>

#include "tests/reader/reading.hpp"

namespace cdot::derive {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> corpus() {
  std::vector<fs::path> files;
  for (const auto& f : fs::directory_iterator(CDOT_BROKEN))
    if (f.path().extension() == ".joint" || f.path().extension() == ".hand") files.push_back(f.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::string messages(const fs::path& path) {
  Library library = library_of(fs::path(CDOT_BROKEN) / "parts");
  const auto file = file_of(path);
  if (path.extension() == ".hand") return messages_about_hand(file, library.at("slider"), library);
  library[path.stem().string()] = file;
  return render(*file, read_joint(file, library).diagnostics);
}

class Broken : public testing::TestWithParam<fs::path> {};

TEST_P(Broken, GivesItsMessages) {
  const std::string given = messages(GetParam());
  fs::path expected_path = GetParam();
  expected_path += ".expected";
  if (std::getenv("CDOT_UPDATE")) std::ofstream(expected_path, std::ios::binary) << given;
  ASSERT_TRUE(fs::exists(expected_path)) << "run with CDOT_UPDATE=1, and read what it writes";
  EXPECT_EQ(given, load_source(expected_path)->text);
  EXPECT_FALSE(given.empty()) << "nothing is wrong with this file";
}

INSTANTIATE_TEST_SUITE_P(Corpus, Broken, testing::ValuesIn(corpus()), [](const auto& info) {
  std::string name = info.param.filename().string();
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
});

TEST(Corpus, IsLargeAndComplete) {
  int joints = 0, hands = 0;
  for (const fs::path& path : corpus()) ++(path.extension() == ".joint" ? joints : hands);
  EXPECT_GE(joints, 60);
  EXPECT_GE(hands, 10);
  for (const auto& f : fs::directory_iterator(CDOT_BROKEN))
    if (f.path().extension() == ".expected") {
      EXPECT_TRUE(fs::exists(fs::path(f.path()).replace_extension())) << f.path() << " is left over";
    }
}

}  // namespace
}  // namespace cdot::derive
