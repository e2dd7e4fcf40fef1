// Helpers for tests of `cdot diff`: the catalogue's folder and the judgement of one entry.
#pragma once

#include <filesystem>
#include <string>

#include "derive/diff/diff.hpp"

namespace cdot::test {

std::filesystem::path specs_folder();

// Writes a .hand file with one entry X-1 to a folder of its own.
std::filesystem::path write_hand(const std::string& joint, const std::string& items);

// Judges one entry against a joint of the catalogue ("line", "spatial/line") and prints the report.
derive::Judgement judged(const std::string& joint, const std::string& items);

}  // namespace cdot::test
