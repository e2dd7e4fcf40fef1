// A temporary folder with specs, in which `cdot` runs.
#pragma once

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <sstream>
#include <string>
#include <unistd.h>

#include "tests/shell.hpp"

namespace fs = std::filesystem;

inline std::string content_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream all;
  all << in.rdbuf();
  return all.str();
}

using cdot::test::ShellResult;

class Derive : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
    place_ = fs::temp_directory_path() / ("cdot_" + std::to_string(getpid()) + test.name());
    for (const char* joint : {"line", "angle"}) take("planar/" + std::string(joint) + ".joint");
  }
  void TearDown() override { fs::remove_all(place_); }

  // Copies a spec of the catalogue.
  void take(const std::string& spec) const {
    fs::create_directories((place_ / "specs" / spec).parent_path());
    fs::copy(fs::path(CDOT_SOURCE_DIR "/specs") / spec, place_ / "specs" / spec);
  }

  ShellResult run(const std::string& command) const {
    return cdot::test::shell("cd '" + place_.string() + "' && " + command + " 2>&1");
  }
  ShellResult cdot(const std::string& arguments) const { return run(CDOT " " + arguments); }

  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((place_ / name).parent_path());
    std::ofstream(place_ / name, std::ios::binary) << text;
  }
  std::string read(const std::string& name) const { return content_of(place_ / name); }

  std::map<std::string, std::string> files(const std::string& folder) const {
    std::map<std::string, std::string> found;
    if (!fs::exists(place_ / folder)) return found;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(place_ / folder)) {
      if (entry.is_regular_file()) {
        found[fs::relative(entry.path(), place_ / folder).string()] = content_of(entry.path());
      }
    }
    return found;
  }

  fs::path place_;
};
