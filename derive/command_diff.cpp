// `cdot diff`: published derivations against the generated ones.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>

#include "derive/commands.hpp"
#include "derive/diff.hpp"

namespace cdot::derive {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> what;
  std::string specs_folder = "specs";
  bool json = false, all = false;
};

// A .hand file and the spec that it is about: the .joint of the same name beside it, or in the specs folder.
struct Pairing {
  fs::path hand, spec;
};

Pairing pair_of(const std::string& word, const SpecsFolder& folder) {
  fs::path path = word;
  if (path.extension() == ".hand") {
    if (!fs::exists(path)) throw NoSuchSpec(fmt::format("no such file: {}", word));
    fs::path spec = path;
    spec.replace_extension(".joint");
    if (!fs::exists(spec)) spec = folder.find(path.stem().string());
    return {path, spec};
  }
  const fs::path spec = folder.find(word);
  path = spec;
  path.replace_extension(".hand");
  if (!fs::exists(path)) {
    throw NoSuchSpec(fmt::format("no hand derivation beside {}: write {} (the language is in specs/README.md)",
                                 spec.string(), path.string()));
  }
  return {path, spec};
}

int run(const Options& options) {
  const SpecsFolder folder(options.specs_folder);
  std::vector<Pairing> pairs;
  for (const std::string& word : options.what) pairs.push_back(pair_of(word, folder));
  if (pairs.empty()) {
    for (fs::path spec : folder.all()) {
      fs::path hand = spec;
      hand.replace_extension(".hand");
      if (fs::exists(hand)) pairs.push_back({hand, spec});
    }
  }
  std::vector<DiffReport> reports;
  bool unreadable = false;
  int counts[4] = {};
  for (const Pairing& pair : pairs) {
    reports.push_back(judge(pair.hand, pair.spec, folder));
    const DiffReport& report = reports.back();
    std::cerr << render(*report.file, report.diagnostics);
    unreadable = unreadable || report.diagnostics.has_errors();
    for (const Judgement& j : report.judgements) ++counts[static_cast<int>(j.agreement)];
    const bool everything = options.all || !options.what.empty();
    if (!options.json) std::cout << to_text(report, everything) << std::flush;
  }
  if (options.json) {
    std::cout << to_json(reports);
  } else {
    fmt::print("{} agree, {} agree if a condition holds, {} differ, {} are listed without a verdict\n", counts[0],
               counts[1], counts[2], counts[3]);
  }
  return unreadable ? 2 : counts[2] > 0 ? 1 : 0;
}

}  // namespace

void add_diff_command(CLI::App& app, Command& selected) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "diff", "Compare hand derivations with the generated one: every entry, and what is missing, flipped, doubled or\n"
              "on the wrong body");
  command->add_option("SPEC", options->what,
                      "Specs by name or path (their .hand beside them), or .hand files; all if none is given");
  command->add_option("--specs", options->specs_folder, "Folder of specs")->type_name("DIR")->capture_default_str();
  command->add_flag("--all", options->all, "Also entries that agree (always shown for named specs)");
  command->add_flag("--json", options->json,
                    "An array with, per entry: id, joint, title, source, verdict (agrees, agrees-if, differs, listed),\n"
                    "condition or reason, remarks, and items: what, row, column, kind, generated, hand, difference,\n"
                    "sentence, confirmed");
  command->footer("Exit status: 0 nothing differs; 1 something does; 2 bad usage or input.");
  command->callback([options, &selected] { selected = [options] { return run(*options); }; });
}

}  // namespace cdot::derive
