// Pages of scenes in a real browser, for the tests of planar and of spatial pages.
#pragma once

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/runtime/tool/support.hpp"

namespace cdot::test {

// The frames in a page of the scene.
std::vector<Frame> film_of(const Scene& scene);

// Foreign parts of a page: outside addresses, and placeholders of the template.
std::vector<std::string> foreign_to(std::string page);

class PageTest : public testing::Test {
 protected:
  void SetUp() override;
  // The page's document after its script ran for three seconds of its own time.
  std::string rendered(const std::string& page, const std::string& fragment) const;
  // The object `seen`, filled by the test's script half-way through that time.
  nlohmann::json seen_by(std::string page, const std::string& script, const std::string& fragment = "") const;
  // A picture of the page, as the file's bytes.
  std::string screenshot(const std::string& page, const std::string& fragment) const;

 private:
  std::string browse(const std::string& page, const std::string& fragment, const std::string& options) const;
  TemporaryFolder folder_;
};

}  // namespace cdot::test
