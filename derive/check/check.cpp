#include "derive/check/check.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>

#include "derive/check/parts.hpp"
#include "runtime/text/stage.hpp"

namespace cdot::derive {
namespace {

void take_over(const Diagnostics& diagnostics, Findings& findings) {
  for (const Diagnostic& d : diagnostics.list) {
    const bool error = d.severity == Severity::error;
    findings.add(error ? Level::error : Level::warning, error ? "unreadable" : "reader", d.where, d.message, d.fix);
    findings.back().also = d.also;
  }
}

// Reports a broken law. A law about the derivation itself is named: the spec is not its cause.
void take_over(const Proved& proved, Findings& findings) {
  for (const Law& law : proved.proof.laws) {
    if (!is_broken(law)) continue;
    const std::string kind = law.id == LawId::momentum ? "momentum" : law.id == LawId::rank ? "dependent" : "law";
    const Span row = law.row != nullptr ? law.row->where : proved.where;
    findings.add(Level::error, kind, law.parts.empty() ? row : law.parts.front(),
                 kind == "law" ? fmt::format("{}: {}", name_of(law.id), law.text) : law.text, law.fix);
    if (!law.parts.empty()) findings.back().also.assign(law.parts.begin() + 1, law.parts.end());
  }
}

void check_constraints(const Subject& subject, Draw draw, CheckReport& report) {
  const text::Stage stage("searching for singular poses");
  check_rows(subject, report.findings);
  const bool drawn = draw == Draw::yes;
  std::vector<PoseToDraw> guarded;
  check_undefined(subject, report.findings, drawn ? &guarded : nullptr);
  check_defaults(subject, report.findings);
  check_mass(subject, report.findings, drawn ? &report.poses : nullptr);
  if (std::ranges::any_of(report.findings, [](const Finding& f) { return f.level == Level::error; })) return;
  if (report.poses.empty() && !guarded.empty()) report.poses.push_back({{}, "A regular pose", subject.usual});
  std::ranges::move(guarded, std::back_inserter(report.poses));
}

}  // namespace

Span place_of(const Block& coordinate, const Joint& joint) {
  for (const Coordinate& c : joint.coordinates) {
    if (c.name == coordinate.name) return c.where;
  }
  return {};
}

bool CheckReport::clean() const {
  return std::all_of(findings.begin(), findings.end(), [](const Finding& f) { return f.level == Level::note; });
}

std::vector<PoseToDraw> poses_to_draw(const Derivation& derivation) {
  CheckReport report;
  if (!derivation.joint.law) check_constraints(subject_of(derivation), Draw::yes, report);
  return report.poses;
}

CheckReport check(const ReadResult& read, Draw draw) {
  CheckReport report;
  take_over(read.diagnostics, report.findings);
  report.readable = read.joint.has_value();
  if (!report.readable) return report;
  const Joint& joint = *read.joint;
  const text::Stage stage("deriving");
  try {
    const Derivation derivation = derive(joint);
    const Subject subject = subject_of(derivation);
    const text::Stage proving("proving");
    report.proofs = prove_blocks(derivation);
    for (const Proved& proved : report.proofs) take_over(proved, report.findings);
    // The rest is about constraints: C = 0, their defaults and their K.
    if (joint.law) check_law(derivation, report.proofs.front().proof, report.findings);
    else check_constraints(subject, draw, report);
  } catch (const NotLinear& e) {
    report.findings.add(Level::error, "linear", joint.rows.front().where, e.what(),
                        "a velocity row is a sum of velocities times what does not contain them");
  } catch (const NumberTooLarge& e) {
    report.findings.add(Level::error, "number", joint.rows.front().where, e.what());
  }
  std::stable_sort(report.findings.begin(), report.findings.end(), [](const Finding& a, const Finding& b) {
    if (a.where.begin != b.where.begin) return a.where.begin < b.where.begin;
    return a.level > b.level;
  });
  return report;
}

namespace {

// The end of the word that begins here; short brackets stay together.
std::size_t end_of_word(const std::string& text, std::size_t begin, std::size_t end) {
  constexpr std::size_t longest_bracket = 60;
  const std::size_t plain = std::min(text.find(' ', begin + 1), end);
  int depth = 0;
  for (std::size_t at = begin + 1; at < std::min(end, begin + longest_bracket); ++at) {
    depth += text[at] == '(' ? 1 : text[at] == ')' ? -1 : 0;
    if (depth <= 0 && text[at] == ' ') return at;
  }
  return depth <= 0 && end < begin + longest_bracket ? end : plain;
}

// The first line of a message in lines of at most 120 columns.
std::string wrapped(const std::string& text) {
  constexpr std::size_t widest = 120;
  const std::size_t end = text.find('\n');
  std::string lines, line;
  for (std::size_t at = 0; at < end;) {
    const std::size_t next = end_of_word(text, at, end);
    const std::string word = text.substr(at, next - at);
    if (!line.empty() && line.size() + word.size() > widest) {
      lines += line + "\n";
      line = "   ";
    }
    line += word;
    at = next;
  }
  return lines + line + text.substr(end);
}

}  // namespace

std::string_view name_of(Level level) {
  switch (level) {
    case Level::note: return "note";
    case Level::warning: return "warning";
    case Level::error: return "error";
  }
  return "";
}

// Renders a finding like the reader's messages. The reader has no notes, so the level is replaced.
std::string render(const SourceFile& file, const Finding& f) {
  std::string text = render(file, Diagnostic{Severity::warning, f.where, f.also, f.message, f.fix});
  const std::string said = ": warning: ";
  text.replace(text.find(said, file.path.size()), said.size(), fmt::format(": {}: ", name_of(f.level)));
  return f.level == Level::note ? wrapped(text) : text;
}

}  // namespace cdot::derive
