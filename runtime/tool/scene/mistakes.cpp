// Places, causes and fixes -> the text of a report with carets.
#include "runtime/tool/scene/mistakes.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "runtime/text/excerpt.hpp"
#include "runtime/text/spelling.hpp"

namespace cdot {
namespace {

constexpr int most_shown = 50;

// Of a long line the report shows a window that starts a little before the mistake.
constexpr text::Look look{100,
                          "…",
                          "",
                          '^',
                          false,
                          [](int, int begin, int end) {
                            return std::max(end, begin + 1) <= look.columns ? 0 : std::max(0, begin - 20); }};

std::vector<std::string> split_lines(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

// The byte at which character number `character` begins; beyond the last one the end of the line.
std::size_t byte_of(std::string_view line, int character) {
  std::size_t at = 0;
  for (int k = 1; k < character && at < line.size(); ++k)
    at += static_cast<std::size_t>(text::character_at(line, at).length);
  return at;
}

bool same_start(std::string_view word, std::string_view candidate) {
  const auto [end, other] = std::mismatch(word.begin(), word.end(), candidate.begin(), candidate.end());
  const auto common = static_cast<std::size_t>(end - word.begin());
  return common >= 4 && 2 * common >= candidate.size();
}

// Words of other engines, and the words that a scene uses.
constexpr std::pair<std::string_view, std::string_view> words_elsewhere[] = {
    {"omega", "spin"},
    {"angular_velocity", "spin"},
    {"w", "spin"},
    {"rotation", "angle"},
    {"theta", "angle"},
    {"dt", "step"},
    {"timestep", "step"},
    {"h", "step"},
    {"time_step", "step"},
    {"time", "duration"},
    {"until", "duration"},
    {"t_end", "duration"},
    {"bodies", "body"},
    {"joints", "joint"},
    {"springs", "spring"},
    {"g", "gravity"},
    {"anchor", "at"},
    {"anchor_a", "pa"},
    {"anchor_b", "pb"},
    {"length", "l"},
    {"rest_length", "rest"},
    {"m", "mass"},
    {"I", "inertia"},
    {"kinematic", "static"},
    {"fixed", "static"},
    {"count", "repeat"},
    {"max_force", "max"},
    {"max_torque", "max"},
    {"break", "breaking"},
    {"radius", "shape"},
    {"weld", "fixed"},
    {"fixed", "weld"},
    {"lock", "weld"},
    {"lock", "fixed"},
    {"hinge", "revolute"},
    {"pin", "revolute"},
    {"slider", "prismatic"},
    {"piston", "prismatic"},
    {"ball", "spherical"},
    {"ball_socket", "spherical"},
    {"point_to_point", "spherical"},
    {"spherical", "revolute"},
    {"cardan", "universal"},
    {"rod", "distance"},
    {"line", "point_on_line"},
    {"point_on_line", "line"},
    {"mouse", "target"},
};

}  // namespace

Mistakes::Mistakes(std::string file, std::string_view text) : file_(std::move(file)), lines_(split_lines(text)) {}

void Mistakes::add(Span where, std::string cause, std::string fix) {
  found_.push_back({where, std::move(cause), std::move(fix)});
}

// Copies of an entry share their lines: the report shows a mistake of all copies once.
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
    if (reported++ == most_shown) break;
    text += paragraph("error", mistake.where, mistake.cause, mistake.fix);
  }
  if (count() > most_shown) text += fmt::format("{}: {} more\n", file_, count() - most_shown);
  return text;
}

std::string Mistakes::paragraph(std::string_view kind, Span where, std::string_view cause, std::string_view fix) const {
  const std::string last = fix.empty() ? "" : fmt::format("  fix: {}\n", fix);
  if (where.line < 1) return fmt::format("{}: {}: {}\n{}", file_, kind, cause, last);
  const std::string head = fmt::format("{}:{}:{}: {}: {}\n", file_, where.line, where.begin, kind, cause);
  if (where.line > static_cast<int>(lines_.size())) return head + last;

  std::string line = lines_[static_cast<std::size_t>(where.line - 1)];
  std::replace_if(
      line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 && c != '\t'; }, ' ');
  const int begin = static_cast<int>(byte_of(line, where.begin)), end = static_cast<int>(byte_of(line, where.end));
  return head + text::numbered(where.line, text::excerpt(line, {{begin, std::max(end, begin + 1)}}, look)) + last;
}

std::string called_here(std::string_view word, std::span<const std::string> known) {
  for (const auto& [elsewhere, here] : words_elsewhere)
    if (word == elsewhere && std::ranges::find(known, here) != known.end())
      return fmt::format("a scene calls it `{}`", here);
  return {};
}

std::string did_you_mean(std::string_view word, std::span<const std::string> known) {
  if (std::string here = called_here(word, known); !here.empty()) return here;
  // Words of one or two letters resemble everything.
  std::string best = text::nearest(word, known, word.size() < 2 ? 0 : word.size() < 3 ? 1 : 1 + word.size() / 4);
  for (auto k = known.begin(); best.empty() && k != known.end(); ++k)
    if (same_start(word, *k)) best = *k;
  if (!best.empty()) return fmt::format("did you mean `{}`?", best);
  if (known.empty()) return {};
  std::vector<std::string> names(known.begin(), known.end());
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return fmt::format("known are: {}", fmt::join(names, ", "));
}

}  // namespace cdot
