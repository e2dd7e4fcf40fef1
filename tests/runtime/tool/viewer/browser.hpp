// Pages of scenes in a real browser. Apart because two files look at pages, one in the plane, one in space.
#pragma once

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/runtime/tool/support.hpp"

namespace cdot::test {

// The frames that a page of the scene shows.
std::vector<Frame> film_of(const Scene& scene);

// What in a page is not its own: addresses of elsewhere, places in its template that nobody filled.
std::vector<std::string> foreign_to(std::string page);

class PageTest : public testing::Test {
 protected:
  void SetUp() override;
  // The page's document after its script ran for three seconds of its own time.
  std::string rendered(const std::string& page, const std::string& fragment) const;
  // What a script of the test's, half way through that time, has put into the object `seen`.
  nlohmann::json seen_by(std::string page, const std::string& script, const std::string& fragment = "") const;
  // A picture of the page, as the file's bytes.
  std::string screenshot(const std::string& page, const std::string& fragment) const;

 private:
  std::string browse(const std::string& page, const std::string& fragment, const std::string& options) const;
  TemporaryFolder folder_;
};

}  // namespace cdot::test
