// Writes the inputs of a folder of cases as files, the start of a fuzzer: split_cases FOLDER OUTPUT.
#include <cstdio>
#include <exception>
#include <fstream>

#include "tests/cases/cases.hpp"

int main(int count, char** arguments) {
  if (count != 3) return std::fputs("usage: split_cases FOLDER OUTPUT\n", stderr), 2;
  try {
    for (const cdot::test::Theme& theme : cdot::test::themes_in(arguments[1])) {
      for (const cdot::test::BrokenInput& c : theme.cases) {
        std::ofstream file(std::filesystem::path(arguments[2]) / c.name, std::ios::binary);
        if (!(file << c.input).flush()) return std::fprintf(stderr, "cannot write %s\n", c.name.c_str()), 1;
      }
    }
  } catch (const std::exception& error) {
    return std::fprintf(stderr, "%s\n", error.what()), 1;
  }
}
