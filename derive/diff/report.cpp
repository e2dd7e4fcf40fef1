// Judgements as text for people and as JSON for programs.
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "derive/diff/diff.hpp"

namespace cdot::derive {

namespace {

constexpr std::size_t widest = 120;
const std::string indent(9, ' '), further(11, ' ');

// The text in lines of at most `widest` characters, at most `most` of them; the last one tells of more.
std::vector<std::string> in_lines(const std::string& first, const std::string& text, std::size_t most) {
  std::vector<std::string> lines;
  std::string line = first;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    const bool empty = line.find_first_not_of(' ') == line.npos;
    if (!empty && line.size() + 1 + word.size() > widest) {
      lines.push_back(line);
      line = further;
    }
    line += (line.find_first_not_of(' ') == line.npos ? "" : " ") + word;
    at = end + 1;
  }
  lines.push_back(line);
  bool cut = lines.size() > most;
  lines.resize(std::min(lines.size(), most));
  for (std::string& one : lines) {
    if (one.size() <= widest) continue;
    one.resize(widest - 4);
    cut = true;
  }
  if (cut) lines.back() = lines.back().substr(0, widest - 4) + " ...";
  return lines;
}

// All of a text in lines.
std::string lines_of(const std::string& first, const std::string& text) {
  return fmt::format("{}\n", fmt::join(in_lines(first, text, std::string::npos), "\n"));
}

// The place, the kind and what belongs there, then the formulas if a line holds them, and the numbers: three lines.
std::string brief(const Difference& d) {
  constexpr std::size_t most = 3;
  std::vector<std::string> lines = in_lines(indent, fmt::format("{}: {}", d.kind, d.sentence), most - 1);
  const std::string formulas = fmt::format("{}generated {}; published {}", further, d.generated, d.hand);
  if (lines.size() + 1 < most && !d.generated.empty() && formulas.size() <= widest) lines.push_back(formulas);
  if (!d.confirmed.empty()) lines.push_back(in_lines(further, d.confirmed, 1).front());
  return fmt::format("{}\n", fmt::join(lines, "\n"));
}

std::string full(const Difference& d) {
  std::string s = fmt::format("{}{}: {}\n", indent, d.kind, d.sentence);
  if (!d.generated.empty()) s += fmt::format("{}generated   {}\n", further, d.generated);
  s += fmt::format("{}published   {}\n", further, d.hand);
  if (!d.difference.empty()) s += fmt::format("{}difference  {}\n", further, d.difference);
  return s + fmt::format("{}{}\n", further, d.confirmed);
}

}  // namespace

std::string to_text(const DiffReport& report, const ReportOptions& options) {
  std::string s;
  for (const Judgement& j : report.judgements) {
    if (!options.all && j.agreement != Agreement::differs) continue;
    s += lines_of(fmt::format("{:<8} {:<10}", j.id, name_of(j.agreement)), j.title);
    if (!j.condition.empty())
      s += lines_of(indent, (j.agreement == Agreement::listed ? "not judged: " : "if ") + j.condition);
    if (j.agreement == Agreement::differs)
      s += lines_of(indent,
                    fmt::format("{}:{}, after {}", report.file->path, report.file->line(j.where.begin), j.source));
    for (const Difference& d : j.differences) s += options.full ? full(d) : brief(d);
    for (const std::string& remark : j.remarks) s += lines_of(indent, "note: " + remark);
  }
  return s;
}

std::string to_json(const DiffReport& report) {
  nlohmann::ordered_json array = nlohmann::ordered_json::array();
  for (const Judgement& j : report.judgements) {
    nlohmann::ordered_json entry = {{"id", j.id},
                                    {"joint", j.joint},
                                    {"title", j.title},
                                    {"source", j.source},
                                    {"verdict", name_of(j.agreement)},
                                    {"condition", j.condition}};
    entry["items"] = nlohmann::ordered_json::array();
    for (const Difference& d : j.differences) {
      entry["items"].push_back({{"what", d.what},
                                {"row", d.row},
                                {"column", d.column},
                                {"kind", d.kind},
                                {"generated", d.generated},
                                {"hand", d.hand},
                                {"difference", d.difference},
                                {"sentence", d.sentence},
                                {"confirmed", d.confirmed}});
    }
    entry["remarks"] = j.remarks;
    array.push_back(std::move(entry));
  }
  return array.dump();
}

std::string joined_json(const std::vector<std::string>& arrays) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const std::string& array : arrays) {
    for (const auto& entry : nlohmann::ordered_json::parse(array)) all.push_back(entry);
  }
  return all.dump(2) + "\n";
}

}  // namespace cdot::derive
