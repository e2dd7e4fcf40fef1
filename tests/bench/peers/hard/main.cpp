// cdot-peers-hard: results of Cdot and of today's engines on the hard cases, in one table.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fstream>
#include <sys/resource.h>

#include "tests/bench/peers/hard/spoilt.hpp"
#include "tests/bench/peers/hard/table.hpp"

namespace {

using namespace cdot::peers;
namespace hard = cdot::hard;

constexpr int finer_parts = 100;  // of a step, if every setting fails
constexpr std::size_t too_many_to_refine = 50, too_many_bodies = 150;
constexpr double longest_of_all = 60;  // CPU seconds of an engine and a case after which no further setting starts

double cpu_seconds() {
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  return double(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         1e-6 * double(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

std::size_t bodies_of(const hard::Case& hard_case) {
  try {
    return spoilt(hard_case) ? 1 : problem_of(hard_case).bodies.size();
  } catch (const CannotSay&) {
    return 0;
  }
}

Cell ask(const Question& question, bool slow) {
  Cell cell;
  Asked asked{question.engine};
  if (question.hard_case == nullptr) {
    cell.settings.emplace_back();
    cell.settings[0].message = "knows the plane only";
    return cell;
  }
  const std::size_t bodies = bodies_of(*question.hard_case);
  const bool many = bodies > too_many_bodies;
  const double from = cpu_seconds();
  for (Outcome outcome; judge(*question.hard_case, asked, outcome); ++asked.setting) {
    cell.settings.push_back(outcome);
    const bool holds = outcome.kind == Outcome::survives, died_at_once = outcome.setting.empty();
    if (outcome.kind == Outcome::cannot_say || died_at_once || (holds && (slow || many))) return cell;
    if (cpu_seconds() - from > longest_of_all) break;
  }
  const int best = int(cell.best());
  if (bodies > too_many_to_refine || cell.settings[cell.best()].kind == Outcome::survives) return cell;
  asked.finer = finer_parts;
  for (const int setting : {best, 0}) {
    Outcome outcome;
    asked.setting = setting;
    judge(*question.hard_case, asked, outcome);
    if (setting == best || outcome < cell.finer) cell.finer = outcome;
    if (cell.finer.kind == Outcome::survives || best == 0) break;
  }
  return cell;
}

nlohmann::json read(const std::string& file) {
  std::ifstream in(file);
  return in ? nlohmann::json::parse(in) : nlohmann::json::object();
}

void write(const std::string& folder, const nlohmann::json& found) {
  std::ofstream out(folder + "/hard_cases.json");  // a cell a line
  const char* row_end = "";
  out << "{";
  for (const auto& [row, cells] : found.items()) {
    out << row_end << "\n " << nlohmann::json(row).dump() << ": {";
    const char* cell_end = "";
    for (const auto& [column, cell] : cells.items()) {
      out << cell_end << "\n  " << nlohmann::json(column).dump() << ": " << cell.dump();
      cell_end = ",";
    }
    out << "}";
    row_end = ",";
  }
  out << "\n}\n";
  std::ofstream(folder + "/hard_cases.md") << page(found);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Runs the hard cases with Cdot and today's engines."};
  std::string only, engine, output;
  bool pages = false;
  app.add_option("--only", only, "Only cases whose name begins with this");
  app.add_option("--engine", engine, "Only the column of this title");
  app.add_option("-o,--output", output, "Folder of hard_cases.json, which is completed, and hard_cases.md");
  app.add_flag("--page", pages, "Ask nobody: write hard_cases.md of hard_cases.json");
  CLI11_PARSE(app, argc, argv);
  nlohmann::json found = output.empty() ? nlohmann::json::object() : read(output + "/hard_cases.json");
  for (const Row& row : rows()) {
    if (pages || !row.name.starts_with(only)) continue;
    for (const Column& column : columns()) {
      if (!engine.empty() && engine != column.title) continue;
      const double from = cpu_seconds();
      found[row.name][column.title] = json_of(ask(question(row, column), column.slow));
      fmt::print(stderr, "{}, {}: {:.1f} s\n", row.name, column.title, cpu_seconds() - from);
      if (!output.empty()) write(output, found);
    }
  }
  if (output.empty()) fmt::print("{}", page(found));
  else write(output, found);
}
