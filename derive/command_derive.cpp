// `cdot derive`: specs to generated/, proved first, written whole or not at all; `--check` only compares.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <iostream>
#include <sstream>

#include "derive/commands.hpp"
#include "derive/diff.hpp"
#include "derive/generate.hpp"
#include "derive/held.hpp"
#include "derive/prove.hpp"
#include "derive/specs_folder.hpp"

namespace cdot::derive {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> specs;
  std::string specs_folder = "specs", output = "generated";
  bool check = false;
};

std::string content_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream all;
  all << in.rdbuf();
  return all.str();
}

// Reads and proves; says everything that is wrong with every spec. Empty if anything is.
std::vector<Joint> read_and_prove(const std::vector<fs::path>& paths, const SpecsFolder& folder) {
  std::vector<Joint> joints;
  bool failed = false;
  for (const fs::path& path : paths) {
    const ReadResult read = folder.read(path);
    std::cerr << render(*read.file, read.diagnostics);
    if (!read.joint) {
      failed = true;
      continue;
    }
    for (const Coordinate& held : held_coordinates(*read.joint)) {
      failed = true;
      std::cerr << render(*read.file, held_error(held));
    }
    const Proof proof = prove(*read.joint, derive_rows(*read.joint));
    for (const Law& law : proof.laws) {
      if (law.verdict == Verdict::shown) {
        fmt::print("{}: shown at {} random points, too much to prove: {}\n", read.joint->name, exact_points,
                   name_of(law.id));
      }
      if (law.verdict != Verdict::fails && law.verdict != Verdict::undecided) continue;
      failed = true;
      Diagnostics said;
      const Span where = law.row ? law.row->where : Span{};
      said.error(where, fmt::format("{}: {}", name_of(law.id), law.text), law.fix, law.parts);
      std::cerr << render(*read.file, said);
    }
    joints.push_back(*read.joint);
  }
  if (failed) joints.clear();
  return joints;
}

// The costs of the published derivations beside these specs, as far as they are right. Two of them
// may be about the same that the ledger does not have otherwise.
std::vector<LedgerRow> hand_costs(const std::vector<fs::path>& specs, const SpecsFolder& folder) {
  std::vector<LedgerRow> rows;
  for (const fs::path& spec : specs) {
    fs::path hand = spec;
    hand.replace_extension(".hand");
    if (!fs::exists(hand)) continue;
    const DiffReport report = judge(hand, spec, folder);
    std::cerr << render(*report.file, report.diagnostics);
    for (const Judgement& j : report.judgements) {
      for (const LedgerRow& cost : j.costs) {
        if (std::find(rows.begin(), rows.end(), cost) == rows.end()) rows.push_back(cost);
      }
    }
  }
  return rows;
}

// What stands below `root` and is ours: everything that `cdot derive` could have written.
Files present(const fs::path& root) {
  Files files;
  if (fs::exists(root / "ledger.csv")) files["ledger.csv"] = content_of(root / "ledger.csv");
  for (const char* space : {"planar", "spatial"}) {
    std::error_code none;
    for (const fs::directory_entry& entry : fs::directory_iterator(root / space, none)) {
      files[std::string(space) + "/" + entry.path().filename().string()] = content_of(entry.path());
    }
  }
  return files;
}

// Through a temporary file, so that nobody ever reads half of one; untouched if it is right already.
void write_file(const fs::path& path, const std::string& content) {
  fs::create_directories(path.parent_path());
  fs::path temporary = path;
  temporary += ".new";
  {
    std::ofstream out(temporary, std::ios::binary);
    out << content;
    if (!out.flush()) throw std::runtime_error(fmt::format("cannot write {}", temporary.string()));
  }
  fs::rename(temporary, path);
}

// The first line in which two texts differ, for a person to see what changed.
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

int compare(const Files& wanted, const fs::path& root, const std::string& command) {
  const Files found = present(root);
  int differences = 0;
  for (const auto& [name, content] : wanted) {
    const auto at = found.find(name);
    if (at != found.end() && at->second == content) continue;
    ++differences;
    fmt::print("  {}: {}\n{}", (root / name).string(), at == found.end() ? "missing" : "differs",
               at == found.end() ? "" : first_difference(at->second, content));
  }
  for (const auto& [name, content] : found) {
    if (wanted.contains(name)) continue;
    ++differences;
    fmt::print("  {}: no spec makes it\n", (root / name).string());
  }
  if (differences == 0) {
    fmt::print("{} is current: {} files\n", root.string(), wanted.size());
    return 0;
  }
  fmt::print("{} is not current: {} of {} files. To mend it: {}\n", root.string(), differences, wanted.size(),
             command);
  return 1;
}

void write(const Files& wanted, const fs::path& root) {
  const Files found = present(root);
  int written = 0, removed = 0;
  for (const auto& [name, content] : wanted) {
    const auto at = found.find(name);
    if (at != found.end() && at->second == content) continue;
    write_file(root / name, content);
    ++written;
  }
  for (const auto& [name, content] : found) {
    if (!wanted.contains(name)) fs::remove(root / name), ++removed;
  }
  fmt::print("{}: {} files, {} written, {} removed\n", root.string(), wanted.size(), written, removed);
}

// What writes what `options` ask to check.
std::string command_line(const Options& options) {
  const Options usual;
  std::string command = "cdot derive";
  for (const std::string& spec : options.specs) command += " " + spec;
  if (options.specs_folder != usual.specs_folder) command += " --specs " + options.specs_folder;
  if (options.output != usual.output) command += " -o " + options.output;
  return command;
}

int run(const Options& options) {
  const SpecsFolder folder(options.specs_folder);
  std::vector<fs::path> paths;
  for (const std::string& spec : options.specs) paths.push_back(folder.find(spec));
  if (paths.empty()) paths = folder.all();
  const std::vector<Joint> joints = read_and_prove(paths, folder);
  if (joints.empty()) {
    fmt::print(stderr, "nothing was written\n");
    return 2;
  }
  const Files wanted = generate(joints, hand_costs(paths, folder));
  if (options.check) return compare(wanted, options.output, command_line(options));
  write(wanted, options.output);
  return 0;
}

}  // namespace

void add_derive_command(CLI::App& app, Command& selected) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "derive", "Prove every spec and write its kernel, the registry and the ledger of operation counts");
  command->add_option("SPEC", options->specs,
                      "Specs, by path or by name; all of the specs folder if none is given. With some given, DIR "
                      "holds\njust these afterwards, so it should not be the folder of all");
  command->add_option("-o,--output", options->output, "Folder to write to")->type_name("DIR")->capture_default_str();
  command->add_option("--specs", options->specs_folder, "Folder of specs")->type_name("DIR")->capture_default_str();
  command->add_flag("--check", options->check,
                    "Write nothing; exit 1 unless DIR has exactly the files that would be written");
  command->callback([options, &selected] { selected = [options] { return run(*options); }; });
}

}  // namespace cdot::derive
