// All judgements as one page, a museum of mistakes: an index by joint, filters without scripts, an anchor an entry.
#include <array>
#include <filesystem>
#include <fmt/format.h>
#include <map>

#include "derive/diff/diff.hpp"
#include "derive/explain/formats/mathml.hpp"
#include "runtime/text/html.hpp"

namespace cdot::derive {
namespace {

// A link to #differs shows only what differs: the empty element of this id precedes the rest and is the :target.
constexpr const char* museum_style = R"(
:root { --wrong: #b3261e; --right: #1b6e3c; --if: #7a5200; --listed: #5a5a62; }
@media (prefers-color-scheme: dark) {
  :root { --wrong: #ff8a80; --right: #7fd6a0; --if: #e8b95a; --listed: #a0a0a8; }
}
body { max-width: 76rem; overflow-wrap: break-word; }
a { color: inherit; }
article { border-top: 1px solid var(--line); padding: .2rem 0 1rem; }
article:target { outline: 2px solid var(--soft); outline-offset: .4rem; }
h3 { font-size: 1.1rem; margin: .8rem 0 .2rem; }
h4 { font-size: 1rem; margin: .8rem 0 .2rem; }
.verdict { font-size: .85rem; font-weight: bold; white-space: nowrap; }
.differs .verdict, a.differs { color: var(--wrong); }
.agrees .verdict, a.agrees { color: var(--right); }
.agrees-if .verdict, a.agrees-if { color: var(--if); }
.listed .verdict, a.listed { color: var(--listed); }
.source, figcaption { color: var(--soft); font-size: .88rem; }
.source { margin: 0; }
.filters a, .ids a { display: inline-block; padding: .15rem .35rem; }
.ids { margin: .1rem 0 .5rem; font-size: .95rem; }
.pair { display: flex; flex-wrap: wrap; gap: .6rem 2rem; }
figure { margin: 0; min-width: 0; max-width: 100%; overflow-x: auto; }
table.sheet { border-collapse: collapse; margin: .2rem 0; white-space: nowrap; }
.filter { scroll-margin-top: 8rem; }
.sheet td, .sheet th { border: 1px solid var(--line); padding: .3rem .5rem; text-align: center; }
.sheet th { color: var(--soft); font-size: .82rem; font-weight: normal; }
.sheet td.wrong { border: 2px solid var(--wrong); }
.sheet td.right { border: 2px solid var(--right); }
.sheet td.wrong::before { content: "\2717\a0"; color: var(--wrong); }
.sheet td.right::before { content: "\2713\a0"; color: var(--right); }
.names { overflow-x: auto; }
.mistakes { border-left: 3px solid var(--wrong); padding-left: 1.2rem; list-style: none; }
.numbers { color: var(--soft); }
pre { overflow-x: auto; background: var(--block); padding: .6rem; font-size: .85rem; }
summary { color: var(--soft); font-size: .88rem; cursor: pointer; }
#differs:target ~ main .entry:not(.differs), #agrees:target ~ main .entry:not(.agrees),
#agrees-if:target ~ main .entry:not(.agrees-if), #listed:target ~ main .entry:not(.listed) { display: none; }
#differs:target ~ main section:not(:has(.entry.differs)), #agrees:target ~ main section:not(:has(.entry.agrees)),
#agrees-if:target ~ main section:not(:has(.entry.agrees-if)),
#listed:target ~ main section:not(:has(.entry.listed)) { display: none; }
)";

constexpr const char* introduction =
    "<p>Published formulas of joints beside those that are derived from C. \xe2\x9c\x97 marks a wrong entry of a "
    "published formula, \xe2\x9c\x93 what belongs there. Each verdict is computed, and finite "
    "differences confirm each mistake. Bodies are a, b, …: x is a centre of mass, v and w are its velocity and the "
    "angular velocity, r is an arm from x to a point p = x + r.</p>\n";

std::string spoken(Agreement agreement) {
  switch (agreement) {
    case Agreement::agrees: return "agrees";
    case Agreement::agrees_if: return "agrees if";
    case Agreement::differs: return "differs";
    case Agreement::listed: return "listed, not judged";
  }
  return "";
}

// The lines of an entry in its file, without the comments before the next one.
std::string lines_of(const SourceFile& file, const Judgement& j) {
  const std::string& all = file.text;
  const auto at = static_cast<std::size_t>(j.where.begin);
  const std::size_t before = all.rfind('\n', at), begin = before == all.npos ? 0 : before + 1;
  std::string text = all.substr(begin, all.find("\nentry ", at) - begin);
  for (std::size_t last; (last = text.find_last_not_of(" \n")) != text.npos;) {
    text.resize(last + 1);
    const std::size_t line = text.rfind('\n');
    if (line == text.npos || text[line + 1] != '#') break;
    text.resize(line);
  }
  return text;
}

// "planar/line"
std::string place_of(const SourceFile& file) {
  const std::filesystem::path path = file.path;
  const std::string folder = path.parent_path().filename().string(), name = path.stem().string();
  return folder.empty() ? name : folder + "/" + name;
}

std::string figure(const char* caption, const std::string& table) {
  return fmt::format("<figure><figcaption>{}</figcaption>{}</figure>\n", caption, table);
}

std::string html_of(const Sheet& sheet) {
  const bool claim = sheet.what.starts_with("claim");
  std::string out = fmt::format("<h4>{}</h4>\n<div class=\"pair\">\n", text::html_escaped(sheet.what));
  if (sheet.published == sheet.generated) return out + figure("published and generated", sheet.published) + "</div>\n";
  out += figure(claim ? "published, left side" : "published", sheet.published);
  if (!sheet.generated.empty()) out += figure(claim ? "right side" : "generated", sheet.generated);
  return out + "</div>\n";
}

std::string html_of(const Difference& d) {
  std::string out = fmt::format("<li><b>{}</b>: {}", text::html_escaped(d.kind), html_prose(d.sentence));
  if (!d.confirmed.empty()) out += fmt::format("<br /><span class=\"numbers\">{}</span>", html_prose(d.confirmed));
  return out + "</li>\n";
}

std::string html_of(const Judgement& j, const SourceFile& file) {
  std::string out = fmt::format("<p class=\"source\">{}</p>\n", text::html_escaped(j.source));
  if (!j.condition.empty())
    out +=
        fmt::format("<p>{} {}</p>\n",
                    j.agreement == Agreement::listed ? "Not judged:" : "Under the condition:", html_prose(j.condition));
  if (!j.note.empty()) out += fmt::format("<p>{}</p>\n", html_prose(j.note));
  for (const Sheet& sheet : j.sheets) out += html_of(sheet);
  if (!j.names.empty()) out += fmt::format("<p class=\"names\">where {}</p>\n", fmt::join(j.names, ", "));
  if (!j.differences.empty()) out += "<ul class=\"mistakes\">\n";
  for (const Difference& d : j.differences) out += html_of(d);
  if (!j.differences.empty()) out += "</ul>\n";
  for (const std::string& remark : j.remarks) out += fmt::format("<p>Note: {}</p>\n", html_prose(remark));
  return out + fmt::format("<details><summary>as it stands in {}.hand, line {}</summary><pre>{}</pre></details>\n",
                           text::html_escaped(place_of(file)), file.line(j.where.begin),
                           text::html_escaped(lines_of(file, j)));
}

// LIN-4, or ANG-8-planar-angle where several joints have an entry of this name.
std::vector<std::string> anchors_of(const std::vector<Exhibit>& exhibits) {
  std::map<std::string, int> times;
  for (const Exhibit& e : exhibits) ++times[e.id];
  std::map<std::string, int> taken;
  std::vector<std::string> anchors;
  for (const Exhibit& e : exhibits) {
    std::string anchor = times[e.id] > 1 ? e.id + "-" + e.joint : e.id;
    for (char& c : anchor) c = c == '/' || c == ' ' ? '-' : c;
    const int same = ++taken[anchor];
    anchors.push_back(text::html_escaped(same > 1 ? fmt::format("{}-{}", anchor, same) : anchor));
  }
  return anchors;
}

constexpr std::array verdicts = {Agreement::differs, Agreement::agrees_if, Agreement::agrees, Agreement::listed};

std::string filters(const std::vector<Exhibit>& exhibits) {
  std::map<Agreement, int> counts;
  for (const Exhibit& e : exhibits) ++counts[e.agreement];
  std::string out = "<nav class=\"filters\"><p>Show ";
  for (const Agreement a : verdicts)
    out += fmt::format("<a class=\"{0}\" href=\"#{0}\">{1}: {2}</a> ", name_of(a), spoken(a), counts[a]);
  return out + fmt::format("<a href=\"#all\">all: {}</a></p></nav>\n", exhibits.size());
}

}  // namespace

std::vector<Exhibit> exhibits_of(const DiffReport& report) {
  std::vector<Exhibit> exhibits;
  for (const Judgement& j : report.judgements) {
    exhibits.push_back({j.id, place_of(*report.file), j.title, html_of(j, *report.file), j.agreement});
  }
  return exhibits;
}

std::string page_of(const std::vector<Exhibit>& exhibits) {
  const std::vector<std::string> anchors = anchors_of(exhibits);
  std::string index, articles, joint;
  for (std::size_t i = 0; i < exhibits.size(); ++i) {
    const Exhibit& e = exhibits[i];
    const std::string name = text::html_escaped(e.joint), title = text::html_escaped(e.title);
    if (joint != e.joint) {
      index += fmt::format("{}<section class=\"ids\"><a href=\"#{}\"><b>{}</b></a> ",
                           index.empty() ? "" : "</section>\n", name, name);
      articles += fmt::format("{}<section><h2 id=\"{}\">{}</h2>\n", articles.empty() ? "" : "</section>\n", name, name);
      joint = e.joint;
    }
    index += fmt::format("<a class=\"entry {}\" href=\"#{}\" title=\"{}\">{}</a> ", name_of(e.agreement), anchors[i],
                         title, text::html_escaped(e.id));
    articles += fmt::format(
        "<article id=\"{0}\" class=\"entry {1}\">\n<h3><a href=\"#{0}\">{2}</a> {3} "
        "<span class=\"verdict\">{4}</span></h3>\n{5}</article>\n",
        anchors[i], name_of(e.agreement), text::html_escaped(e.id), title, spoken(e.agreement), e.html);
  }
  const std::string end = exhibits.empty() ? "" : "</section>\n";
  std::string out = html_head("A museum of mistakes", museum_style);
  for (const Agreement a : verdicts) out += fmt::format("<span class=\"filter\" id=\"{}\"></span>", name_of(a));
  return out + "<span class=\"filter\" id=\"all\"></span>\n" + introduction + filters(exhibits) + "<main>\n" + index +
         end + articles + end + "</main>\n" + html_foot;
}

}  // namespace cdot::derive
