#include "tests/bench/ulp/report.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace cdot::ulp {
namespace {

std::string short_number(double x) {
  if (x == 0) return "0";
  if (x < 0.05) return "<0.1";
  return x < 99.95 ? fmt::format("{:.1f}", x) : fmt::format("{:.2g}", x);
}

std::string cells(const Spread& s) {
  return fmt::format("{:.3g},{:.3g},{:.3g},{}", s.median, s.p99, s.worst, s.worst_family);
}

std::string name_of(const AnyBlock& block) { return fmt::format("{} {} {}", block.space(), block.joint, block.block); }

// A row per function: the worst kernel of all.
std::string by_function(const std::vector<Line>& lines) {
  std::string s =
      "| function | kernels | float: median | p99 | worst | of | double: median | p99 | worst | of |\n"
      "|---|--:|--:|--:|--:|---|--:|--:|--:|---|\n";
  for (std::size_t which = 0; which < static_cast<std::size_t>(Measured::impulse_fast); ++which) {
    std::vector<const Line*> of;
    for (const Line& line : lines) {
      if (static_cast<std::size_t>(line.which) == which && !line.form_of) of.push_back(&line);
    }
    s += fmt::format("| {} | {} ", info(static_cast<Measured>(which)).name, of.size());
    for (const auto member : {&Line::in_float, &Line::in_double}) {
      const auto middle = [&](double Spread::*number) {
        std::vector<double> all;
        for (const Line* line : of) all.push_back((line->*member).scale.*number);
        std::sort(all.begin(), all.end());
        return short_number(all[all.size() / 2]);
      };
      const Line& worst = **std::max_element(
          of.begin(), of.end(), [&](auto* a, auto* b) { return (a->*member).scale.worst < (b->*member).scale.worst; });
      s += fmt::format("| {} | {} | {} | {} ", middle(&Spread::median), middle(&Spread::p99),
                       short_number((worst.*member).scale.worst), name_of(*worst.block));
    }
    s += "|\n";
  }
  return s;
}

const Line* find(const std::vector<Line>& lines, const AnyBlock* block, Measured which) {
  const auto found = std::find_if(lines.begin(), lines.end(),
                                  [&](const Line& line) { return line.block == block && line.which == which; });
  return found == lines.end() ? nullptr : &*found;
}

// A row per kernel, a column for each function that a solver calls.
template <class Cell>
std::string by_kernel(const std::vector<Line>& lines, Cell cell) {
  using enum Measured;
  constexpr Measured shown[] = {position, jacobian, effective_mass, factor_and_solve,
                                velocity, apply,    gamma,          stiffness};
  std::string s = "| kernel |", rule = "|---|";
  for (const Measured which : shown) {
    s += fmt::format(" {} |", info(which).name);
    rule += "--:|";
  }
  s += '\n' + rule + '\n';
  const AnyBlock* before = nullptr;
  for (const Line& line : lines) {
    if (line.block == before || line.form_of) continue;
    before = line.block;
    s += fmt::format("| {} |", name_of(*before));
    for (const Measured which : shown) {
      const Line* const of = find(lines, before, which);
      s += of == nullptr ? " |" : ' ' + cell(*of) + " |";
    }
    s += '\n';
  }
  return s;
}

std::string worst_of_scale(const Line& line) {
  return fmt::format("{} / {}", short_number(line.in_float.scale.worst), short_number(line.in_double.scale.worst));
}

std::string cost(const Line& line) {
  return fmt::format("{}: {:.1f} / {:.1f}", line.operations, line.in_float.nanoseconds, line.in_double.nanoseconds);
}

// Other forms of C, each below the generated one.
std::string forms_of_C(const std::vector<Line>& lines) {
  std::string s =
      "| form | operations | float: ns | ulp: median | p99 | scale: p99 | worst | at | double: ns | "
      "ulp: median | p99 | scale: p99 | worst | at |\n"
      "|---|--:|--:|--:|--:|--:|--:|---|--:|--:|--:|--:|--:|---|\n";
  const auto add = [&](const Line& line) {
    s += fmt::format("| {} | {} ", name_of(*line.block), line.operations);
    for (const Accuracy* a : {&line.in_float, &line.in_double}) {
      s += fmt::format("| {:.1f} | {} | {} | {} | {} | {} ", a->nanoseconds, short_number(a->ulp.median),
                       short_number(a->ulp.p99), short_number(a->scale.p99), short_number(a->scale.worst),
                       a->scale.worst_family);
    }
    s += "|\n";
  };
  for (const Line& line : lines) {
    if (!line.form_of) continue;
    add(*find(lines, line.form_of, line.which));
    add(line);
  }
  return s;
}

// A row per kernel with several rows: fast, balanced, robust.
std::string forms_of_K(const std::vector<Line>& lines, Accuracy Line::*scalar) {
  constexpr Measured forms[] = {Measured::impulse_fast, Measured::impulse_balanced, Measured::impulse_robust};
  std::string s =
      "| kernel | fast: ns | p99 | worst | dropped | balanced: ns | p99 | worst | dropped | robust: ns | p99 | "
      "worst | dropped |\n"
      "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n";
  for (const Line& line : lines) {
    if (line.which != Measured::impulse_balanced || line.form_of) continue;
    s += fmt::format("| {} ", name_of(*line.block));
    for (const Measured which : forms) {
      const Line* const of = find(lines, line.block, which);
      if (of == nullptr) {
        s += "| | | | ";
        continue;
      }
      const Accuracy& a = of->*scalar;
      s += fmt::format("| {:.1f} | {} | {} | {} ", a.nanoseconds, short_number(a.scale.p99),
                       short_number(a.scale.worst), a.guarded);
    }
    s += "|\n";
  }
  return s;
}

}  // namespace

std::string csv(const std::vector<Line>& lines) {
  std::string s =
      "space,joint,block,function,operations,scalar,nanoseconds,ulp_median,ulp_p99,ulp_worst,"
      "ulp_worst_at,scale_median,scale_p99,scale_worst,scale_worst_at,guarded\n";
  for (const Line& line : lines) {
    for (const auto& [scalar, a] : {std::pair{"float", &line.in_float}, {"double", &line.in_double}}) {
      s += fmt::format("{},{},{},{},{},{},{:.1f},{},{},{}\n", line.block->space(), line.block->joint, line.block->block,
                       info(line.which).name, line.operations, scalar, a->nanoseconds, cells(a->ulp), cells(a->scale),
                       a->guarded);
    }
  }
  return s;
}

std::string markdown(const std::vector<Line>& lines, int samples_per_family) {
  return fmt::format(
      "# Accuracy of the kernels\n\n"
      "Made by `bench_ulp`; [../README.md](../README.md) says how and what the words mean. {} inputs "
      "of each of {} families. Every number is in [accuracy.csv](accuracy.csv).\n\n"
      "## Every function, in units of its natural scale\n\n"
      "Median and p99 of the middle kernel; the worst input of the worst kernel.\n\n{}\n"
      "## Every kernel: the worst input, in units of the natural scale, float / double\n\n{}\n"
      "## Cost: operations, then nanoseconds in float / double\n\n{}\n"
      "## Other forms of C, each below the generated one\n\n{}\n"
      "## From J to the impulse by `kernels = \"fast\"`, `\"balanced\"`, `\"robust\"`: in float\n\n"
      "p99 and worst in units of the natural scale; dropped: inputs of which a row was taken for dependent.\n\n"
      "{}\n## The same in double\n\n{}",
      samples_per_family, families, by_function(lines), by_kernel(lines, worst_of_scale), by_kernel(lines, cost),
      forms_of_C(lines), forms_of_K(lines, &Line::in_float), forms_of_K(lines, &Line::in_double));
}

}  // namespace cdot::ulp
