#include "tests/derive/diff/support.hpp"

#include <cstdio>
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

namespace cdot::test {

namespace fs = std::filesystem;

fs::path specs_folder() { return fs::path(CDOT_SOURCE_DIR) / "specs"; }

fs::path write_hand(const std::string& joint, const std::string& items) {
  // Tests run in parallel processes.
  const fs::path folder = fs::path(testing::TempDir()) / ("cdot_diff_" + std::to_string(getpid()));
  fs::create_directories(folder);
  const fs::path hand = folder / (fs::path(joint).filename().string() + ".hand");
  std::ofstream(hand) << "entry X-1 \"a person's own\"\n  source \"own\"\n" << items;
  return hand;
}

derive::Judgement judged(const std::string& joint, const std::string& items) {
  const derive::SpecsFolder folder(specs_folder());
  const fs::path hand = write_hand(joint, items);
  const derive::DiffReport report = judge(hand, folder.read(folder.find(joint)));
  fs::remove_all(hand.parent_path());
  EXPECT_FALSE(report.diagnostics.has_errors()) << render(*report.file, report.diagnostics);
  if (report.judgements.size() != 1) {
    ADD_FAILURE() << "the entry was not judged";
    return {};
  }
  std::printf("%s\n", to_text(report, {.all = true}).c_str());
  return report.judgements[0];
}

}  // namespace cdot::test
