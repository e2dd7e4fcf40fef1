// Writes random specs as files: random_specs FOLDER SEED COUNT.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/derive/random/random_specs.hpp"

int main(int count, char** arguments) {
  if (count != 4) return std::fputs("usage: random_specs FOLDER SEED COUNT\n", stderr), 2;
  const auto first = std::strtoull(arguments[2], nullptr, 0), last = first + std::strtoull(arguments[3], nullptr, 0);
  for (auto seed = first; seed < last; ++seed) {
    const cdot::test::RandomSpec spec = cdot::test::random_spec(seed);
    const auto file = std::filesystem::path(arguments[1]) / (spec.name + ".joint");
    if (!(std::ofstream(file, std::ios::binary) << spec.text)) return std::perror(file.c_str()), 1;
    std::printf("%s: %s%s%s\n", spec.name.c_str(), spec.theme.c_str(), spec.mistake.empty() ? "" : ", ",
                spec.mistake.c_str());
  }
}
