// Judgements as text for people and as JSON for programs.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "derive/diff/diff.hpp"

namespace cdot::derive {

std::string to_text(const DiffReport& report, bool all) {
  std::string s;
  for (const Judgement& j : report.judgements) {
    if (!all && j.agreement != Agreement::differs) continue;
    s += fmt::format("{:<8} {:<10} {}\n", j.id, name_of(j.agreement), j.title);
    if (!j.condition.empty()) {
      s += fmt::format("         {} {}\n", j.agreement == Agreement::listed ? "not judged:" : "if", j.condition);
    }
    if (j.agreement == Agreement::differs) {
      s += fmt::format("         {}:{}, after {}\n", report.file->path, report.file->line(j.where.begin), j.source);
    }
    for (const Difference& d : j.differences) {
      s += fmt::format("         {}: {}\n", d.kind, d.sentence);
      if (!d.generated.empty()) s += fmt::format("           generated   {}\n", d.generated);
      s += fmt::format("           published   {}\n", d.hand);
      if (!d.difference.empty()) s += fmt::format("           difference  {}\n", d.difference);
      s += fmt::format("           {}\n", d.confirmed);
    }
    for (const std::string& remark : j.remarks) s += fmt::format("         note: {}\n", remark);
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
