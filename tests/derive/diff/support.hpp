// What the tests of `cdot diff` share: the catalogue's folder, and one hand-made entry to be
// judged.
#pragma once

#include <filesystem>
#include <string>

#include "derive/diff/diff.hpp"

namespace cdot::test {

std::filesystem::path specs_folder();

// A .hand file with one entry X-1, in a folder of its own.
std::filesystem::path write_hand(const std::string& joint, const std::string& items);

// Judges one entry, written as a person would, against a joint of the catalogue ("line",
// "spatial/line"), and prints what is said of it.
derive::Judgement judged(const std::string& joint, const std::string& items);

}  // namespace cdot::test
