// A .hand file to its judgements.
#include "derive/diff/diff.hpp"

#include "derive/diff/entry.hpp"
#include "runtime/text/stage.hpp"

namespace cdot::derive {
namespace {

// The anchors of an entry that differ from the spec's.
std::map<std::string, std::string> changed(const std::map<std::string, std::string>& anchors, const Joint& joint) {
  std::map<std::string, std::string> other;
  for (const auto& [name, body] : anchors) {
    for (const Parameter& p : joint.parameters) {
      const std::string fixed_in = p.body < 0 ? "world" : joint.bodies[static_cast<std::size_t>(p.body)];
      if (p.name == name && fixed_in != body) other[name] = body;
    }
  }
  return other;
}

}  // namespace

std::string_view name_of(Agreement agreement) {
  switch (agreement) {
    case Agreement::agrees: return "agrees";
    case Agreement::agrees_if: return "agrees-if";
    case Agreement::differs: return "differs";
    case Agreement::listed: return "listed";
  }
  return "";
}

DiffReport judge(const std::filesystem::path& hand, const ReadResult& plain, bool with_sheets) {
  const text::Stage stage("deriving");
  const HandFile file = read_hand(load_source(hand));
  DiffReport report{file.file, {}, file.diagnostics};
  if (!plain.joint) throw NoSuchSpec(render(*plain.file, plain.diagnostics));
  for (const HandEntryAst& ast : file.entries) {
    // Every entry has a pool of its own: names given in one never show in another.
    ReadResult read = read_anchored(plain, ast.anchors);
    if (!read.joint) {
      report.diagnostics.error(
          ast.where, "with what this entry assumes, the spec cannot be read: " + render(*read.file, read.diagnostics));
      continue;
    }
    const text::Stage stage("comparing hand derivations");
    read.joint = derive(*read.joint).joint;  // without the coordinates that its rows determine
    const std::size_t before = report.diagnostics.list.size();
    Entry entry = read_entry(ast, file, read, changed(ast.anchors, *plain.joint), report.diagnostics);
    entry.with_sheets = with_sheets;
    if (report.diagnostics.list.size() == before) report.judgements.push_back(judge(std::move(entry)));
  }
  return report;
}

}  // namespace cdot::derive
