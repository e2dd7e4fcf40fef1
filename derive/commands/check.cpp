// `cdot check`: errors and risks of specs, for people or as JSON.
#include "derive/check/check.hpp"

#include <fmt/format.h>

#include "derive/commands/commands.hpp"
#include "derive/language/operators.hpp"
#include "derive/language/specs_folder.hpp"
#include "derive/pipeline/process_pool.hpp"
#include "runtime/text/colour.hpp"
#include "runtime/text/json.hpp"

namespace cdot::derive {
namespace {

using text::Json;

struct Options {
  std::vector<std::string> specs;
  std::string specs_folder = "specs", page;
  bool json = false;
  int processes = usual_processes();
};

Json place(const SourceFile& file, Span span) {
  return {{"line", file.line(span.begin)},
          {"column", file.column(span.begin)},
          {"text",
           file.text.substr(static_cast<std::size_t>(span.begin), static_cast<std::size_t>(span.end - span.begin))}};
}

Json as_json(const SourceFile& file, const Finding& f) {
  Json also = Json::array();
  for (const Span& span : f.also) also.push_back(place(file, span));
  return {{"level", name_of(f.level)}, {"kind", f.kind},       {"at", place(file, f.where)},
          {"also", std::move(also)},   {"message", f.message}, {"fix", f.fix}};
}

Json as_json(const Proved& proved) {
  Json laws = Json::array();
  for (const Law& law : proved.proof.laws) {
    laws.push_back({{"law", name_of(law.id)}, {"verdict", name_of(law.verdict)}, {"text", law.text}});
  }
  return {{"coordinate", proved.name}, {"laws", std::move(laws)}};
}

std::string status(const CheckReport& report) {
  return !report.readable ? "unreadable" : report.clean() ? "clean" : "problems";
}

Json as_json(const SourceFile& file, const CheckReport& report) {
  Json findings = Json::array(), proofs = Json::array();
  for (const Finding& f : report.findings) findings.push_back(as_json(file, f));
  for (const Proved& p : report.proofs) proofs.push_back(as_json(p));
  return {{"spec", file.path},
          {"status", status(report)},
          {"findings", std::move(findings)},
          {"proofs", std::move(proofs)}};
}

std::string counted(const CheckReport& report, Level level) {
  const auto n =
      std::count_if(report.findings.begin(), report.findings.end(), [&](const Finding& f) { return f.level == level; });
  return n == 0 ? "" : fmt::format(", {} {}{}", n, name_of(level), n == 1 ? "" : "s");
}

std::string as_text(const SourceFile& file, const CheckReport& report) {
  std::string text;
  for (const Finding& f : report.findings) text += render(file, f);
  std::size_t proved = 0, shown = 0, laws = 0;
  for (const Proved& p : report.proofs) {
    for (const Law& law : p.proof.laws) {
      if (law.verdict == Verdict::does_not_apply) continue;
      ++laws;
      if (law.verdict == Verdict::holds) ++proved;
      if (law.verdict == Verdict::shown) ++shown;
    }
  }
  text += fmt::format("{}: {}", file.path, status(report));
  if (report.readable) text += fmt::format(", {} of {} laws proved", proved, laws);
  if (shown > 0) text += fmt::format(", {} shown at {} random points", shown, exact_points);
  return text + counted(report, Level::error) + counted(report, Level::warning) + counted(report, Level::note) + "\n";
}

// Of one spec.
struct Checked {
  int status = 0;
  std::string text, pictures;
  NLOHMANN_DEFINE_TYPE_INTRUSIVE(Checked, status, text, pictures)
};

int run(const Options& options) {
  const SpecsFolder folder(options.specs_folder);
  std::vector<std::filesystem::path> paths;
  for (const std::string& spec : options.specs) paths.push_back(folder.find(spec));
  std::vector<std::string> all;
  std::string pictures;
  int exit_status = 0;
  std::FILE* const verdicts = options.page == "-" ? stderr : stdout;
  const auto check_one = [&](std::size_t i) {
    const ReadResult read = folder.read(paths[i]);
    const bool drawn = !options.page.empty();
    const CheckReport report = check(read, drawn ? Draw::yes : Draw::no);
    return Checked{!report.readable ? 2
                   : report.clean() ? 0
                                    : 1,
                   options.json ? as_json(*read.file, report).dump(2) : as_text(*read.file, report),
                   drawn ? pictures_html(read, report) : ""};
  };
  const auto take = [&](const Checked& answer) {
    exit_status = std::max(exit_status, answer.status);
    pictures += answer.pictures;
    if (options.json) all.push_back(answer.text);
    else text::print_messages(verdicts, answer.text);
  };
  const int failed = in_processes({paths.begin(), paths.end()}, {}, options.processes, check_one, take);
  if (options.json) fmt::print(verdicts, "{}\n", text::array_of_printed(all));
  if (!options.page.empty()) write_file(options.page, pictures_page(pictures));
  return failed > 0 ? 2 : exit_status;
}

void add_options(Line& line, Options& options) {
  line.add("SPEC", &options.specs, "Specs, by path or by name; - is standard input").required();
  line.add("--json", &options.json,
           "An array with, per spec: spec, status (clean, problems, unreadable), findings\n"
           "(level, kind, at, also, message, fix) and proofs (coordinate, laws)");
  line.add("--html", &options.page,
           "Also write one page that shows each joint at the poses where K is singular, beside a regular pose;\n"
           "- is standard output")
      .shown_as("PAGE");
  add_specs(line, options.specs_folder);
  add_jobs(line, options.processes);
  line.footer(
      "An error forbids a kernel. A warning is a likely mistake. A note says where the joint is singular or\n"
      "undefined, and what the kernel computes there.\n"
      "Exit status: 0 nothing but notes; 1 problems; 2 a spec cannot be read.\n\n"
      "Operators\n" +
      operators_help());
}

}  // namespace

Run check_command(Line& line) { return with_options<Options>(line, add_options, run); }

}  // namespace cdot::derive
