// Random specs of up to 40 lines, each from a seed: any part of the language, names nested in names, long sums, deep
// products, up to four bodies. One in six has a mistake put in.
#pragma once

#include <cstdint>
#include <string>

namespace cdot::test {

struct RandomSpec {
  std::string name;  // of the joint: spec_17
  std::string text;
  std::string theme;    // the special part: "plain", "nested numbers", ...
  std::string mistake;  // empty: none was put in
};

RandomSpec random_spec(std::uint64_t seed);

}  // namespace cdot::test
