// `cdot derive`: specs to generated/, proved first, written whole or not at all; `--check` only compares.
#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <optional>
#include <sstream>

#include "derive/commands/commands.hpp"
#include "derive/pipeline/pipeline.hpp"
#include "derive/pipeline/process_pool.hpp"
#include "runtime/text/colour.hpp"
#include "runtime/text/files.hpp"

namespace cdot::derive {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Count, add, multiply, divide, root, compare, call)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(LedgerRow, space, joint, block, quantity, source, count)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(GeneratedJoint, space, name, kernel, ledger, is_effect)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ProofRow, space, joint, block, statement, proved, shown)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Outcome, proved, on_record, said, complaints, proofs, joint, hand_costs)

namespace {

namespace fs = std::filesystem;

constexpr const char* proofs_file = "proofs.csv";

struct Options {
  std::vector<std::string> specs;
  std::string specs_folder = "specs", output = "generated";
  bool check = false, fresh = false;
  int processes = usual_processes();
};

std::string content_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream all;
  all << in.rdbuf();
  return all.str();
}

// Each row once: two published derivations may describe the same quantity.
std::vector<LedgerRow> without_repetition(const std::vector<LedgerRow>& all) {
  std::vector<LedgerRow> rows;
  for (const LedgerRow& row : all) {
    if (std::find(rows.begin(), rows.end(), row) == rows.end()) rows.push_back(row);
  }
  return rows;
}

bool is_shown(const ProofRow& row) { return !row.shown.empty(); }

// Most expensive specs first, so that none runs alone at the end: those without a kernel, then by its size.
std::vector<std::size_t> most_expensive_first(const std::vector<fs::path>& paths, const fs::path& output) {
  std::vector<std::pair<std::uintmax_t, std::size_t>> sized;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    std::error_code missing;  // then the size is the greatest there is
    const fs::path space = paths[i].parent_path().filename();
    sized.emplace_back(fs::file_size(output / space / (paths[i].stem().string() + ".hpp"), missing), i);
  }
  std::stable_sort(sized.begin(), sized.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::size_t> order;
  for (const auto& [size, i] : sized) order.push_back(i);
  return order;
}

// The files of all specs, or none if any spec has an error. Reports the errors.
std::optional<Files> derive_all(const std::vector<fs::path>& paths, const SpecsFolder& folder, const Options& options) {
  const fs::path record_file = fs::path(options.output) / proofs_file;
  const ProofRecord record = options.fresh ? ProofRecord() : ProofRecord(content_of(record_file));
  std::vector<GeneratedJoint> joints;
  std::vector<LedgerRow> hand_costs;
  std::vector<ProofRow> proofs;
  std::size_t on_record = 0;
  std::ptrdiff_t shown = 0;  // row blocks; the record lists their laws, which would fill a page
  const auto take = [&](const Outcome& outcome) {
    text::print_messages(stderr, outcome.complaints);
    if (outcome.on_record && options.specs.empty()) shown += std::ranges::count_if(outcome.proofs, &is_shown);
    else fmt::print("{}", outcome.said);
    if (!outcome.proved) return;
    on_record += outcome.on_record ? 1 : 0;
    joints.push_back(outcome.joint);
    hand_costs.insert(hand_costs.end(), outcome.hand_costs.begin(), outcome.hand_costs.end());
    proofs.insert(proofs.end(), outcome.proofs.begin(), outcome.proofs.end());
  };
  in_processes(
      {paths.begin(), paths.end()}, most_expensive_first(paths, options.output), options.processes,
      [&](std::size_t i) { return derive_spec(paths[i], folder, record); }, take);
  if (on_record > 0) {
    fmt::print(stderr, "{} of {} specs are proved by the record {} (--fresh: prove all again)\n", on_record,
               paths.size(), record_file.string());
  }
  if (shown > 0) {
    fmt::print("row blocks with laws that are too expensive to prove, shown at {} random points, listed in {}: {}\n",
               exact_points, record_file.string(), shown);
  }
  if (joints.size() < paths.size()) return std::nullopt;
  Files files = collect(joints, without_repetition(hand_costs));
  files[proofs_file] = csv_of(std::move(proofs));
  return files;
}

// The files below `root` that `cdot derive` could have written.
Files present(const fs::path& root) {
  Files files;
  for (const char* table : {"ledger.csv", proofs_file}) {
    if (fs::exists(root / table)) files[table] = content_of(root / table);
  }
  for (const char* space : {"coordinate", "planar", "spatial"}) {
    std::error_code none;
    for (const fs::directory_entry& entry : fs::directory_iterator(root / space, none)) {
      files[std::string(space) + "/" + entry.path().filename().string()] = content_of(entry.path());
    }
  }
  return files;
}

// The first line in which two texts differ, for people.
std::string first_difference(const std::string& old_text, const std::string& new_text) {
  std::istringstream a(old_text), b(new_text);
  std::string left, right;
  for (int line = 1;; ++line) {
    const bool more_a = static_cast<bool>(std::getline(a, left));
    const bool more_b = static_cast<bool>(std::getline(b, right));
    if (!more_a && !more_b) return "";
    if (!more_a) left = "(end)";
    if (!more_b) right = "(end)";
    if (left != right) return fmt::format("    line {}\n    - {}\n    + {}\n", line, left, right);
  }
}

bool is_in(const Files& files, const std::string& name, const std::string& content) {
  const auto at = files.find(name);
  return at != files.end() && at->second == content;
}

int compare(const Files& wanted, const fs::path& root, const std::string& command) {
  const Files found = present(root);
  int differences = 0;
  for (const auto& [name, content] : wanted) {
    if (is_in(found, name, content)) continue;
    ++differences;
    const bool differs = found.contains(name);
    fmt::print("  {}: {}\n{}", (root / name).string(), differs ? "differs" : "missing",
               differs ? first_difference(found.at(name), content) : "");
  }
  for (const auto& [name, content] : found) {
    if (wanted.contains(name)) continue;
    ++differences;
    fmt::print("  {}: no spec generates it\n", (root / name).string());
  }
  if (differences == 0) fmt::print("{} is current: {} files\n", root.string(), wanted.size());
  else fmt::print("{} is not current: {} of {} files. Fix: {}\n", root.string(), differences, wanted.size(), command);
  return differences == 0 ? 0 : 1;
}

void write(const Files& wanted, const fs::path& root) {
  const Files found = present(root);
  int written = 0, removed = 0;
  for (const auto& [name, content] : wanted) {
    if (!is_in(found, name, content)) write_file(root / name, content), ++written;
  }
  for (const auto& [name, content] : found) {
    if (!wanted.contains(name)) fs::remove(root / name), ++removed;
  }
  fmt::print("{}: {} files, {} written, {} removed\n", root.string(), wanted.size(), written, removed);
}

// The command that writes the files of these options.
std::string command_line(const Options& options) {
  const Options usual;
  std::string command = "cdot derive";
  for (const std::string& spec : options.specs) command += " " + spec;
  if (options.specs_folder != usual.specs_folder) command += " --specs " + options.specs_folder;
  if (options.output != usual.output) command += " -o " + options.output;
  if (options.fresh) command += " --fresh";
  return command;
}

int run(const Options& options) {
  const SpecsFolder folder(options.specs_folder);
  std::vector<fs::path> paths;
  for (const std::string& spec : options.specs) paths.push_back(folder.find(spec));
  if (paths.empty() && !fs::is_directory(options.specs_folder))
    throw NoSuchSpec(fmt::format("no folder {}: run from the folder that holds it, say --specs DIR, or name the specs",
                                 options.specs_folder));
  if (paths.empty()) paths = folder.all();
  const std::optional<Files> wanted = derive_all(paths, folder, options);
  if (!wanted) {
    fmt::print(stderr, "nothing was written\n");
    return 2;
  }
  if (options.check) return compare(*wanted, options.output, command_line(options));
  write(*wanted, options.output);
  return 0;
}

void add_options(Line& line, Options& options) {
  line.add("SPEC", &options.specs,
           "Specs, by path or by name (default: all in the specs folder). DIR will hold only these specs:\n"
           "give another DIR for a part of all specs");
  line.add("-o,--output", &options.output, "Folder to write to").shown_as("DIR").shows_default();
  line.add("--check", &options.check, "Write nothing; exit 1 unless DIR has exactly the files that would be written");
  line.add("--fresh", &options.fresh, "Ignore the record of proofs and prove everything again");
  add_specs(line, options.specs_folder);
  add_jobs(line, options.processes);
  line.footer(
      "DIR/proofs.csv records all proofs by content: a spec is proved again only if its derivation changed.\n"
      "Exit status: 0 written, or current; 1 not current; 2 bad usage or input.");
}

}  // namespace

Run derive_command(Line& line) { return with_options<Options>(line, add_options, run); }

void add_specs(Line& line, std::string& folder) {
  line.add("--specs", &folder, "Folder of specs").shown_as("DIR").shows_default();
}

void write_file(const fs::path& path, const std::string& content) {
  if (path.has_parent_path()) fs::create_directories(path.parent_path());
  text::write_file(path.string(), content);
}

void add_jobs(Line& line, int& processes) {
  line.add("-j,--jobs", &processes, "Number of specs at once, each in its own process")
      .shown_as("N")
      .positive()
      .shows_default();
}

}  // namespace cdot::derive
