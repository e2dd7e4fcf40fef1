// `cdot diff`: published derivations against the generated ones.
#include "derive/diff/diff.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <iostream>

#include "derive/commands/commands.hpp"
#include "derive/pipeline/process_pool.hpp"
#include "runtime/text/colour.hpp"

namespace cdot::derive {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> what;
  std::string specs_folder = "specs", page;
  bool json = false, all = false, full = false;
  int processes = usual_processes();
};

// A .hand file and its spec: the .joint of the same name beside it, or in the specs folder.
struct Pairing {
  fs::path hand, spec;
  std::string entry;  // the only one that is asked for; empty: all
};

fs::path hand_beside(fs::path spec) { return spec.replace_extension(".hand"); }

Pairing pair_of_hand(const fs::path& hand, const SpecsFolder& folder) {
  if (!fs::exists(hand)) throw NoSuchSpec(fmt::format("no such file: {}", hand.string()));
  fs::path spec = hand;
  for (const char* const extension : {".joint", ".effect"})
    if (spec.replace_extension(extension); fs::exists(spec)) break;
  if (!fs::exists(spec)) spec = folder.find(hand.stem().string());
  return {hand, spec, ""};
}

Pairing pair_of_spec(const std::string& word, const SpecsFolder& folder) {
  const fs::path spec = folder.find(word), hand = hand_beside(spec);
  if (fs::exists(hand)) return {hand, spec, ""};
  throw NoSuchSpec(fmt::format("no hand derivation beside {}: write {} (the language is in specs/README.md)",
                               spec.string(), hand.string()));
}

std::vector<Pairing> all_pairs(const SpecsFolder& folder) {
  std::vector<Pairing> pairs;
  for (const fs::path& spec : folder.all()) {
    if (fs::exists(hand_beside(spec))) pairs.push_back({hand_beside(spec), spec, ""});
  }
  return pairs;
}

// LIN-4, JO-12, L-n1: an entry of some .hand file. Several joints may have an entry of one name.
bool is_id(const std::string& word) {
  return !word.empty() && word[0] >= 'A' && word[0] <= 'Z' && word.find('-') != word.npos;
}

std::vector<Pairing> pairs_with_entry(const std::string& id, const SpecsFolder& folder) {
  std::vector<Pairing> pairs;
  std::vector<std::string> ids;
  for (Pairing& pair : all_pairs(folder)) {
    bool here = false;
    for (const HandEntryAst& entry : read_hand(load_source(pair.hand)).entries) {
      ids.push_back(entry.id);
      here = here || entry.id == id;
    }
    if (here) pairs.push_back({pair.hand, pair.spec, id});
  }
  if (!pairs.empty()) return pairs;
  const std::string near = nearest(id, ids);
  throw NoSuchSpec(fmt::format("no entry `{}` in any .hand file of the specs{}", id,
                               near.empty() ? "" : fmt::format("; did you mean `{}`?", near)));
}

std::vector<Pairing> pairs_of(const std::vector<std::string>& words, const SpecsFolder& folder) {
  if (words.empty()) return all_pairs(folder);
  std::vector<Pairing> pairs;
  for (const std::string& word : words) {
    if (fs::path(word).extension() == ".hand") {
      pairs.push_back(pair_of_hand(word, folder));
    } else if (is_id(word) && !fs::exists(word)) {
      for (Pairing& pair : pairs_with_entry(word, folder)) pairs.push_back(std::move(pair));
    } else {
      pairs.push_back(pair_of_spec(word, folder));
    }
  }
  return pairs;
}

}  // namespace

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Exhibit, id, joint, title, html, agreement)

namespace {

// Of one .hand file.
struct FileVerdict {
  std::string complaints, text;  // for stderr and stdout
  bool unreadable = false;
  std::array<int, 4> counts = {};  // by Agreement
  std::vector<Exhibit> exhibits;   // for a page
  NLOHMANN_DEFINE_TYPE_INTRUSIVE(FileVerdict, complaints, text, unreadable, counts, exhibits)
};

FileVerdict verdict_on(const Pairing& pair, const SpecsFolder& folder, const Options& options) {
  DiffReport report = judge(pair.hand, folder.read(pair.spec), !options.page.empty());
  if (!pair.entry.empty()) {
    std::erase_if(report.judgements, [&](const Judgement& j) { return j.id != pair.entry; });
  }
  const bool everything = options.all || !options.what.empty();
  FileVerdict verdict{render(*report.file, report.diagnostics),
                      options.json ? to_json(report) : to_text(report, {everything, options.full}),
                      report.diagnostics.has_errors(),
                      {},
                      {}};
  if (!options.page.empty()) verdict.exhibits = exhibits_of(report);
  for (const Judgement& j : report.judgements) ++verdict.counts[static_cast<std::size_t>(j.agreement)];
  return verdict;
}

int run(const Options& options) {
  const SpecsFolder folder(options.specs_folder);
  const std::vector<Pairing> pairs = pairs_of(options.what, folder);
  std::vector<std::string> names, entries;
  for (const Pairing& pair : pairs) names.push_back(pair.hand.string());
  FileVerdict total;
  const auto take = [&](const FileVerdict& verdict) {
    total.unreadable = total.unreadable || verdict.unreadable;
    for (std::size_t k = 0; k < total.counts.size(); ++k) total.counts[k] += verdict.counts[k];
    text::print_messages(stderr, verdict.complaints);
    std::ranges::copy(verdict.exhibits, std::back_inserter(total.exhibits));
    if (options.json) entries.push_back(verdict.text);
    else if (options.page.empty()) std::cout << verdict.text << std::flush;
  };
  const int failed = in_processes(
      names, {}, options.processes, [&](std::size_t i) { return verdict_on(pairs[i], folder, options); }, take);
  if (!options.page.empty()) write_file(options.page, page_of(total.exhibits));
  if (options.json) std::cout << joined_json(entries);
  else
    fmt::print(options.page == "-" ? stderr : stdout,
               "{} agree, {} agree if a condition holds, {} differ, {} are listed without a verdict\n", total.counts[0],
               total.counts[1], total.counts[2], total.counts[3]);
  return failed > 0 || total.unreadable ? 2 : total.counts[2] > 0 ? 1 : 0;
}

void add_options(Line& line, Options& options) {
  line.add("SPEC", &options.what,
           "Specs by name or path (with a .hand file beside them), .hand files, or ids of entries (LIN-4).\n"
           "Default: all");
  line.add("--all", &options.all, "Also show entries that agree (named specs always show them)");
  line.add("--full", &options.full, "Show whole formulas and their difference, however long");
  line.add("--json", &options.json,
           "An array with, per entry: id, joint, title, source, verdict (agrees, agrees-if, differs, listed),\n"
           "condition (of agrees-if; the reason of listed), remarks, and items: what, row, column, kind,\n"
           "generated, hand, difference, sentence, confirmed (the numbers that show it)");
  line.add("--html", &options.page,
           "Write one page that shows every entry: both formulas with the wrong entries marked, and each difference.\n"
           "It needs nothing else; #LIN-4 links to an entry, #differs shows what differs")
      .shown_as("PAGE")
      .excludes("--json")
      .excludes("--all")
      .excludes("--full");
  add_specs(line, options.specs_folder);
  add_jobs(line, options.processes);
  line.footer("Exit status: 0 no entry differs; 1 some entry differs; 2 bad usage or input.");
}

}  // namespace

Run diff_command(Line& line) { return with_options<Options>(line, add_options, run); }

}  // namespace cdot::derive
