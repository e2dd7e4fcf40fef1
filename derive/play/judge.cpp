// A .hand file -> messages with places, from the verdicts of `cdot diff`.
#include "derive/play/judge.hpp"

#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "derive/derivation/derivation.hpp"
#include "derive/diff/diff.hpp"
#include "derive/language/specs_folder.hpp"
#include "derive/play/spec.hpp"

namespace cdot::play {
namespace {

using namespace derive;
using nlohmann::json;
namespace fs = std::filesystem;

std::string with_remarks(std::string words, const Judgement& j) {
  for (const std::string& remark : j.remarks) words += "\nnote: " + remark;
  return words;
}

// One message for what agrees, and one for each difference, with the generated formula.
void add_messages(const SourceFile& file, const Judgement& j, json& messages) {
  const auto add = [&](derive::Span where, const char* severity, const std::string& message) {
    messages.push_back(message_json(file, where, severity, message, ""));
  };
  switch (j.agreement) {
    case Agreement::agrees: return add(j.where, "agrees", with_remarks(j.id + " agrees", j));
    case Agreement::agrees_if:
      return add(j.where, "agrees", with_remarks(fmt::format("{} agrees if {}", j.id, j.condition), j));
    case Agreement::listed: return add(j.where, "warning", fmt::format("{} is not judged: {}", j.id, j.condition));
    case Agreement::differs: break;
  }
  for (const Difference& d : j.differences) {
    const std::string words = fmt::format("{}: {}", d.kind, d.sentence);
    add(d.where, "error", &d == &j.differences.back() ? with_remarks(words, j) : words);
    messages.back()["generated"] = d.generated;
  }
}

ReadResult read_readable(const fs::path& spec) {
  ReadResult read = SpecsFolder().read(spec);
  if (!read.joint) throw std::runtime_error(render(*read.file, read.diagnostics));
  return read;
}

}  // namespace

json judge_hand(const std::string& hand) {
  fs::path spec = hand;
  if (!fs::exists(spec.replace_extension(".joint"))) spec.replace_extension(".effect");
  const DiffReport report = judge(hand, read_readable(spec));
  json messages = messages_json(*report.file, report.diagnostics);
  int agree = 0, differ = 0;
  for (const Judgement& j : report.judgements) {
    add_messages(*report.file, j, messages);
    agree += j.agreement == Agreement::agrees || j.agreement == Agreement::agrees_if;
    differ += j.agreement == Agreement::differs;
  }
  return {{"messages", messages}, {"agree", agree}, {"differ", differ}};
}

json first_entry(const std::string& spec) {
  const Derivation derivation = derive::derive(*read_readable(spec).joint);
  std::vector<std::string> columns;
  for (const std::string& body : derivation.joint.bodies) columns.insert(columns.end(), {"v_" + body, "w_" + body});
  const std::vector<std::string> zeros(columns.size(), "0");
  const std::vector<std::string> rows(derivation.rows.rows.size(), fmt::format("{}", fmt::join(zeros, ", ")));
  const std::string J = fmt::format("  # One row for each row of C; the columns are {}.\n  J = [ {} ]\n",
                                    fmt::join(columns, ", "), fmt::join(rows, " ;\n        "));
  return {{"text", fmt::format("entry MINE-1 \"My own derivation\"\n  source \"me\"\n{}",
                               derivation.joint.law ? "  force = 0\n" : J)}};
}

}  // namespace cdot::play
