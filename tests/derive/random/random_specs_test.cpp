// Random specs end with an answer: a derivation and a report, or an error with its place. CDOT_SEEDS="FIRST COUNT"
// tries other seeds.
#include "tests/derive/random/random_specs.hpp"

#include <algorithm>
#include <cstdlib>
#include <regex>
#include <set>
#include <vector>

#include "tests/derive/commands/command.hpp"

namespace {

using cdot::test::random_spec;
using cdot::test::RandomSpec;

constexpr std::size_t most_letters = 400000;  // of a lecture

constexpr std::size_t longest_message = 600;  // in a line of a report

// Its laws take seconds to prove (README.md).
const std::set<std::uint64_t> slow = {14};

struct Seeds {
  std::uint64_t first = 1, count = 0;
  bool chosen = false;
};

Seeds seeds(std::uint64_t count) {
  Seeds seeds;
  seeds.count = count;
  const char* const asked = std::getenv("CDOT_SEEDS");
  if (asked == nullptr) return seeds;
  std::istringstream(asked) >> seeds.first >> seeds.count;
  seeds.chosen = true;
  return seeds;
}

class RandomSpecs : public Derive {
 protected:
  ShellResult answer(const std::string& command, const RandomSpec& spec) const {
    write(spec.name + ".joint", spec.text);
    return cdot(command + " --specs " CDOT_SOURCE_DIR "/specs " + spec.name + ".joint");
  }
};

// An error names the line, the column and the reason. No number is infinite or none at all.
void expect_a_clear_answer(const RandomSpec& spec, const ShellResult& result) {
  static const std::regex placed("spec_[0-9]+\\.joint:[0-9]+:[0-9]+: error: [^\n]{10,}"), broken("\\b(nan|inf)\\b");
  EXPECT_TRUE(result.status >= 0 && result.status <= 2) << result.status << "\n" << spec.text;
  EXPECT_TRUE(result.status != 2 || std::regex_search(result.text, placed)) << result.text << spec.text;
  EXPECT_FALSE(std::regex_search(result.text, broken)) << spec.text;
  EXPECT_EQ(result.text.find("killed by"), std::string::npos) << spec.text;
  EXPECT_EQ(result.text.find("failed:"), std::string::npos) << result.text << spec.text;
}

std::size_t longest_line(const std::string& text) {
  std::istringstream lines(text);
  std::size_t longest = 0;
  for (std::string line; std::getline(lines, line);) longest = std::max(longest, line.size());
  return longest;
}

TEST_F(RandomSpecs, AreExplainedOrRefused) {
  const Seeds all = seeds(100);
  std::uint64_t accepted = 0, mistakes = 0;
  for (std::uint64_t seed = all.first; seed < all.first + all.count; ++seed) {
    const RandomSpec spec = random_spec(seed);
    EXPECT_LE(std::ranges::count(spec.text, '\n'), 40) << spec.text;
    const ShellResult result = answer("explain", spec);
    expect_a_clear_answer(spec, result);
    EXPECT_LT(result.text.size(), most_letters) << spec.text;
    accepted += result.status == 0 ? 1 : 0;
    mistakes += spec.mistake.empty() ? 0 : 1;
    EXPECT_TRUE(spec.mistake.empty() || result.status == 2) << spec.mistake << "\n" << spec.text;
  }
  std::printf("%ju of %ju random specs are explained; %ju have a mistake put in\n", std::uintmax_t(accepted),
              std::uintmax_t(all.count), std::uintmax_t(mistakes));
  EXPECT_GE(2 * accepted, all.count);
}

TEST_F(RandomSpecs, AreChecked) {
  const Seeds all = seeds(40);
  int status[3] = {0, 0, 0}, given_up = 0;
  for (std::uint64_t seed = all.first; seed < all.first + all.count; ++seed) {
    const RandomSpec spec = random_spec(seed);
    if (!all.chosen && slow.contains(seed)) continue;
    const ShellResult result = answer("check -j1", spec);
    expect_a_clear_answer(spec, result);
    EXPECT_LT(longest_line(result.text), longest_message) << spec.text;
    EXPECT_EQ(result.text.find("but not proved"), std::string::npos) << "a right joint is refused:\n" << spec.text;
    if (result.status >= 0 && result.status <= 2) ++status[result.status];
    given_up += result.text.find("note: the search for poses at which K is singular was given up: too long") !=
                std::string::npos;
  }
  std::printf("clean: %d, with problems: %d, unreadable: %d; %d with a search given up\n", status[0], status[1],
              status[2], given_up);
  EXPECT_TRUE(all.chosen || given_up > 0) << "the bound of the search is tried";
}

}  // namespace
