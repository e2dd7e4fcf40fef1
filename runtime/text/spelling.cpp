#include "runtime/text/spelling.hpp"

#include <algorithm>
#include <vector>

namespace cdot::text {
namespace {

constexpr std::size_t longest_word = 64;  // longer words are no misspelling of a name

std::size_t edits(std::string_view from, std::string_view to) {
  std::vector<std::vector<std::size_t>> d(from.size() + 1, std::vector<std::size_t>(to.size() + 1));
  for (std::size_t i = 0; i <= from.size(); ++i)
    for (std::size_t j = 0; j <= to.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (from[i - 1] != to[j - 1])});
      const bool swapped = i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1];
      if (swapped) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[from.size()][to.size()];
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

}  // namespace

std::string nearest(std::string_view word, std::span<const std::string> candidates, std::size_t most_edits) {
  if (word.size() > longest_word) return {};
  const std::string lower = lower_case(word);
  std::string best;
  std::size_t fewest = most_edits + 1;
  for (const std::string& candidate : candidates) {
    if (candidate.size() > longest_word) continue;
    const std::size_t distance = edits(lower, lower_case(candidate));
    if (distance >= fewest) continue;
    best = candidate;
    fewest = distance;
  }
  return best;
}

std::string did_you_mean(std::string_view word, std::span<const std::string> candidates) {
  const std::string near = nearest(word, candidates, word.size() < 5 ? 1 : 1 + word.size() / 4);
  return near.empty() ? near : "; did you mean `" + near + "`?";
}

}  // namespace cdot::text
