#include "runtime/tool/scene/text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>

namespace cdot {
namespace {

constexpr std::size_t longest_shown = 100;  // characters of a line that a message shows
constexpr int most_reported = 50;
constexpr std::size_t longest_word = 60;  // longer words are no misspelling of a name

bool starts_character(char byte) { return (static_cast<unsigned char>(byte) & 0xC0) != 0x80; }

// Characters (code points) of a line; bytes that are no UTF-8 count one each by their first byte.
std::vector<std::string> characters(std::string_view line) {
  std::vector<std::string> result;
  for (char byte : line) {
    if (starts_character(byte) || result.empty()) result.emplace_back();
    const bool printable = static_cast<unsigned char>(byte) >= 0x20 || byte == '\t';
    result.back() += printable ? byte : ' ';
  }
  return result;
}

std::vector<std::string> split_lines(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

// The number of single-letter edits (insert, delete, replace, swap of neighbours) from `from` to
// `to`.
std::size_t edits(std::string_view from, std::string_view to) {
  std::vector<std::vector<std::size_t>> d(from.size() + 1, std::vector<std::size_t>(to.size() + 1));
  for (std::size_t i = 0; i <= from.size(); ++i) d[i][0] = i;
  std::iota(d[0].begin(), d[0].end(), std::size_t{0});
  for (std::size_t i = 1; i <= from.size(); ++i) {
    for (std::size_t j = 1; j <= to.size(); ++j) {
      const std::size_t replaced = d[i - 1][j - 1] + (from[i - 1] != to[j - 1]);
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, replaced});
      const bool swapped = i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1];
      if (swapped) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[from.size()][to.size()];
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

bool same_start(std::string_view word, std::string_view candidate) {
  const auto [end, other] = std::mismatch(word.begin(), word.end(), candidate.begin(), candidate.end());
  const auto common = static_cast<std::size_t>(end - word.begin());
  return common >= 4 && 2 * common >= candidate.size();
}

// What other engines and other people call what a scene calls otherwise.
std::string_view called_here(std::string_view word) {
  constexpr std::pair<std::string_view, std::string_view> words[] = {
      {"omega", "spin"},       {"angular_velocity", "spin"},
      {"w", "spin"},           {"rotation", "angle"},
      {"theta", "angle"},      {"dt", "step"},
      {"timestep", "step"},    {"h", "step"},
      {"time_step", "step"},   {"time", "duration"},
      {"until", "duration"},   {"t_end", "duration"},
      {"bodies", "body"},      {"joints", "joint"},
      {"springs", "spring"},   {"g", "gravity"},
      {"anchor", "at"},        {"anchor_a", "pa"},
      {"anchor_b", "pb"},      {"axis", "t"},
      {"length", "l"},         {"rest_length", "rest"},
      {"m", "mass"},           {"I", "inertia"},
      {"kinematic", "static"}, {"fixed", "static"},
      {"count", "repeat"},     {"max_force", "max"},
      {"max_torque", "max"},   {"break", "breaking"},
      {"radius", "shape"}};
  for (const auto& [elsewhere, here] : words) {
    if (word == elsewhere) return here;
  }
  return {};
}

}  // namespace

Mistakes::Mistakes(std::string file, std::string_view text) : file_(std::move(file)), lines_(split_lines(text)) {}

void Mistakes::add(Span where, std::string cause, std::string fix) {
  found_.push_back({where, std::move(cause), std::move(fix)});
}

// The copies of a repeated entry share their lines: what is wrong in all of them is said once.
std::vector<Mistakes::Mistake> Mistakes::ordered() const {
  std::vector<Mistake> result = found_;
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

int Mistakes::count() const { return static_cast<int>(ordered().size()); }

std::string Mistakes::report() const {
  std::string text;
  int reported = 0;
  for (const Mistake& mistake : ordered()) {
    if (reported++ == most_reported) break;
    text += paragraph("error", mistake.where, mistake.cause, mistake.fix);
  }
  if (count() > most_reported) text += fmt::format("{}: {} more\n", file_, count() - most_reported);
  return text;
}

std::string Mistakes::paragraph(std::string_view kind, Span where, std::string_view cause, std::string_view fix) const {
  const std::string last = fix.empty() ? "" : fmt::format("  fix: {}\n", fix);
  if (where.line < 1) return fmt::format("{}: {}: {}\n{}", file_, kind, cause, last);
  const std::string head = fmt::format("{}:{}:{}: {}: {}\n", file_, where.line, where.begin, kind, cause);
  if (where.line > static_cast<int>(lines_.size())) return head + last;

  const std::vector<std::string> line = characters(lines_[static_cast<std::size_t>(where.line - 1)]);
  const std::size_t begin = std::min(static_cast<std::size_t>(std::max(where.begin, 1) - 1), line.size());
  const std::size_t end =
      std::clamp(static_cast<std::size_t>(std::max(where.end, 1) - 1), begin + 1, std::max(line.size(), begin + 1));
  // A long line is cut to a window that starts a little before the mistake.
  const std::size_t first = end <= longest_shown ? 0 : begin - std::min<std::size_t>(begin, 20);
  const std::size_t stop = std::min(line.size(), first + longest_shown);

  std::string shown = first > 0 ? "…" : "", carets = first > 0 ? " " : "";
  for (std::size_t k = first; k < stop; ++k) shown += line[k];
  if (stop < line.size()) shown += "…";
  for (std::size_t k = first; k < begin; ++k) carets += line[k] == "\t" ? '\t' : ' ';
  carets += std::string(std::min(end, first + longest_shown) - begin, '^');
  return head + fmt::format("{:5} | {}\n      | {}\n", where.line, shown, carets) + last;
}

std::string did_you_mean(std::string_view word, std::span<const std::string> known) {
  const std::string* best = nullptr;
  // Words of one or two letters resemble everything.
  std::size_t best_edits = word.size() < 2 ? 1 : word.size() < 3 ? 2 : 2 + word.size() / 4;
  const std::string_view elsewhere = called_here(word);
  for (const std::string& candidate : known) {
    if (candidate == elsewhere) return fmt::format("here that is `{}`", candidate);
    if (word.size() > longest_word) continue;
    const std::size_t distance = edits(lower(word), lower(candidate));
    if (distance < best_edits || (!best && same_start(word, candidate))) {
      best = &candidate;
      best_edits = std::min(distance, best_edits);
    }
  }
  if (best) return fmt::format("did you mean `{}`?", *best);
  if (known.empty()) return {};
  std::vector<std::string> names(known.begin(), known.end());
  std::sort(names.begin(), names.end());
  return fmt::format("known are: {}", fmt::join(names, ", "));
}

}  // namespace cdot
