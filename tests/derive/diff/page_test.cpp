// `cdot diff --html`: one page with an anchor for each entry and a mark at each wrong entry of a formula.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <sstream>
#include <unistd.h>

#include "tests/derive/diff/support.hpp"

namespace cdot::test {
namespace {

namespace fs = std::filesystem;

class Page : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  std::string content_of(const fs::path& file) const {
    std::ostringstream all;
    all << std::ifstream(file, std::ios::binary).rdbuf();
    return all.str();
  }

  std::string written(const std::string& arguments) const {
    const fs::path file = folder_ / "page.html";
    fs::remove(file);
    const std::string command = std::string(CDOT) + " diff --specs '" + specs_folder().string() + "' " + arguments +
                                " --html '" + file.string() + "' >/dev/null 2>&1";
    status_ = std::system(command.c_str());
    return content_of(file);
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / ("cdot_page_" + std::to_string(getpid()));
  mutable int status_ = 0;
};

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != text.npos; at += part.size()) ++n;
  return n;
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != text.npos; }

std::string article(const std::string& page, const std::string& anchor) {
  const std::size_t begin = page.find("<article id=\"" + anchor + "\"");
  if (begin == page.npos) return "";
  return page.substr(begin, page.find("</article>", begin) - begin);
}

// The first element that is closed wrongly, or the last that stays open; empty if there is none. Each attribute stands
// in quotes, and `<` and `>` only in tags, as in XML.
std::string misnested(const std::string& page) {
  std::vector<std::string> open;
  for (std::size_t at = page.find("<html"); (at = page.find('<', at)) != page.npos;) {
    const std::size_t end = page.find('>', at);
    if (end == page.npos) return "a tag without end";
    const std::string tag = page.substr(at + 1, end - at - 1), name = tag.substr(0, tag.find_first_of(" \n"));
    if (count(tag, "\"") % 2 != 0 || has(tag, "<")) return tag;
    if (tag.front() == '/') {
      if (open.empty() || "/" + open.back() != name) return tag;
      open.pop_back();
    } else if (tag.back() != '/') {
      open.push_back(name);
    }
    at = end;
  }
  return open.empty() ? "" : open.back();
}

// The ids of the .hand files, and how often each occurs.
std::map<std::string, int> ids_of_catalogue() {
  std::map<std::string, int> ids;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(specs_folder())) {
    if (entry.path().extension() != ".hand") continue;
    std::ifstream in(entry.path());
    for (std::string word, line; std::getline(in, line);) {
      std::istringstream words(line);
      if (line.starts_with("entry ")) words >> word >> word, ++ids[word];
    }
  }
  return ids;
}

TEST_F(Page, ShowsEachEntryWithItsVerdictItsFormulasAndItsDifferences) {
  const std::string page = written("line planar/angle");
  EXPECT_EQ(WEXITSTATUS(status_), 1) << "some entry differs";
  EXPECT_EQ(misnested(page), "");
  const std::string differs = article(page, "LIN-4"), agrees = article(page, "LIN-1");
  ASSERT_NE(differs, "");
  EXPECT_TRUE(has(page, "href=\"#LIN-4\""));
  EXPECT_TRUE(has(differs, "class=\"entry differs\"")) << differs;
  EXPECT_TRUE(has(differs, "dyn4j.org, Line Constraint, 2010")) << differs;
  EXPECT_TRUE(has(differs, "<math>")) << differs;
  EXPECT_TRUE(has(differs, "it has -inv_m_b - inv_I_b*cross(rb + u, t)^2 where")) << differs;
  EXPECT_TRUE(has(differs, "central differences of C at 12 poses")) << differs;
  EXPECT_TRUE(has(differs, "  K = 1/m(a) + cross(ra, t)^2 * 1/I(a) - 1/m(b)")) << differs;
  EXPECT_TRUE(has(agrees, "class=\"entry agrees\"")) << agrees;
  EXPECT_TRUE(has(agrees, "saved: the spec's t, by default")) << agrees;
  EXPECT_EQ(count(agrees, "class=\"wrong\""), 0u) << agrees;
  EXPECT_TRUE(has(article(page, "ANG-8"), "belongs beside the spatial joint"));
}

TEST_F(Page, MarksTheWrongEntriesAndNoOthers) {
  const std::string page = written("line prismatic");
  // J of LIN-7 is wrong in w_b; v_a, w_a and v_b are right.
  const std::string one = article(page, "LIN-7");
  EXPECT_EQ(count(one, "class=\"wrong\""), 1u) << one;
  EXPECT_EQ(count(one, "class=\"right\""), 1u) << one;
  const std::size_t mark = one.find("class=\"wrong\"");
  const std::string marked = one.substr(mark, one.find("</td>", mark) - mark);
  EXPECT_TRUE(has(marked, ">axis<")) << marked;
  EXPECT_EQ(count(one.substr(0, mark), "<td"), 4u) << "the fourth cell is marked, w_b";
  for (const char* id : {"LIN-1", "LIN-2", "LIN-8", "PRI-1", "PRI-2"}) {
    ASSERT_NE(article(page, id), "") << id;
    EXPECT_EQ(count(article(page, id), "class=\"wrong\""), 0u) << id;
  }
}

TEST_F(Page, OfAllHasEveryEntryOnceAndNeedsNothingFromElsewhere) {
  const std::string page = written("");
  EXPECT_EQ(misnested(page), "");
  std::size_t entries = 0;
  for (const auto& [id, times] : ids_of_catalogue()) {
    entries += static_cast<std::size_t>(times);
    if (times == 1) EXPECT_EQ(count(page, "<article id=\"" + id + "\""), 1u) << id;
    else EXPECT_EQ(count(page, "<article id=\"" + id + "-"), static_cast<std::size_t>(times)) << id;
  }
  EXPECT_GT(entries, 150u);
  EXPECT_EQ(count(page, "<article "), entries);
  for (const char* anchor : {"ANG-8-planar-angle", "ANG-8-spatial-revolute_n1"})
    EXPECT_EQ(count(page, "id=\"" + std::string(anchor) + "\""), 1u) << anchor;
  for (const char* elsewhere : {"<script", "<link", "src=", "href=\"http", "@import"})
    EXPECT_EQ(count(page, elsewhere), 0u) << elsewhere;
  EXPECT_EQ(count(page, "url("), count(page, "url(data:")) << "its font is in the page";
  // Each entry that differs shows where.
  for (std::size_t at = 0; (at = page.find("class=\"entry differs\">", at)) != page.npos; ++at) {
    const std::string shown = page.substr(at, page.find("</article>", at) - at);
    EXPECT_TRUE(has(shown, "class=\"wrong\"")) << shown.substr(0, 200);
  }
}

TEST_F(Page, HasTheSameBytesHoweverManyAtOnce) {
  const std::string page = written("line planar/angle gear_on_base --jobs 1");
  ASSERT_NE(page, "");
  EXPECT_EQ(written("line planar/angle gear_on_base --jobs 1"), page);
  EXPECT_EQ(written("line planar/angle gear_on_base --jobs 2"), page);
}

TEST_F(Page, IsWrittenWholeOrNotAtAll) {
  const fs::path file = folder_ / "page.html";
  std::ofstream(file) << "old";
  const std::string command = std::string(CDOT) + " diff --specs '" + specs_folder().string() +
                              "' no_such_joint --html '" + file.string() + "' >/dev/null 2>&1";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 2);
  EXPECT_EQ(content_of(file), "old");
  EXPECT_TRUE(has(written("line"), "</html>"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1) << "no other file stays";
}

// As a device or a pipe stays: a rename would put a file in its place.
TEST_F(Page, ALinkStaysALink) {
  const fs::path file = folder_ / "page.html", link = folder_ / "link.html";
  std::ofstream(file) << "old";
  fs::create_symlink(file, link);
  const std::string command = std::string(CDOT) + " diff --specs '" + specs_folder().string() + "' line --html '" +
                              link.string() + "' >/dev/null 2>&1";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_TRUE(has(content_of(file), "</html>"));
}

}  // namespace
}  // namespace cdot::test
