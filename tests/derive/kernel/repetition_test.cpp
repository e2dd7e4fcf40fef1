// generated/ has no two equal kernels under different names. This test reads the committed files.
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <map>
#include <regex>
#include <string>

namespace {

// The code of a header without the joint's name and title.
std::string kernel_without_names(const std::filesystem::path& header) {
  std::ifstream file(header);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  text.erase(0, text.find("#pragma once"));
  text.erase(text.find(" title ="), text.find(" body_names ") - text.find(" title ="));
  return std::regex_replace(text, std::regex("\\b" + header.stem().string() + "\\b"), "joint");
}

}  // namespace

TEST(Repetition, no_joint_is_another_by_a_second_name) {
  int kernels = 0;
  for (const char* space : {"planar", "spatial"}) {
    std::map<std::string, std::string> joint_of;
    for (const auto& entry : std::filesystem::directory_iterator(std::string(CDOT_SOURCE_DIR "/generated"
                                                                                             "/") +
                                                                 space)) {
      if (entry.path().stem() == "registry") continue;
      const std::string name = entry.path().stem().string();
      const auto [same, first] = joint_of.emplace(kernel_without_names(entry.path()), name);
      EXPECT_TRUE(first) << space << ": " << name << " has the kernel of " << same->second
                         << "; a spec of its own must add something";
      ++kernels;
    }
  }
  EXPECT_GT(kernels, 50);
}
