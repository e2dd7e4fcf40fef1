// bench_ulp FOLDER [--samples n] [--only joint] [--at-most u]: writes FOLDER/accuracy.csv and FOLDER/accuracy.md; the
// exit status is 1 if a generated function has an error above u units of its natural scale.
#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>

#include "tests/bench/ulp/ledger.hpp"
#include "tests/bench/ulp/report.hpp"

namespace {

int report_worse_than(double at_most, const std::vector<cdot::ulp::Line>& lines) {
  int worse = 0;
  for (const cdot::ulp::Line& line : lines) {
    for (const auto& [scalar, worst] :
         {std::pair{"float", line.in_float.scale.worst}, {"double", line.in_double.scale.worst}}) {
      if (worst <= at_most || line.form_of || line.which >= cdot::ulp::Measured::impulse_fast) continue;
      std::cout << line.block->space() << ' ' << line.block->joint << ' ' << line.block->block << ": "
                << info(line.which).name << " in " << scalar << " is off by " << worst << " units of its scale\n";
      ++worse;
    }
  }
  return worse == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace cdot::ulp;
  CLI::App app{"Measures every generated kernel against CLN at 60 digits."};
  std::string folder, only;
  int samples = 100;
  double at_most = 0;
  app.add_option("FOLDER", folder, "where accuracy.csv and accuracy.md go")->required();
  app.add_option("--samples", samples, "inputs of each family")->capture_default_str();
  app.add_option("--at-most", at_most, "units of the natural scale that no kernel may be off by");
  app.add_option("--only", only, "this joint alone");
  CLI11_PARSE(app, argc, argv);

  std::vector<Line> lines;
  const auto& blocks = measured_blocks<double>();
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const cdot::AnyBlock& block = blocks[i].shape;
    if (!only.empty() && block.joint != only) continue;
    std::cerr << block.space() << ' ' << block.joint << ' ' << block.block << std::endl;
    const std::vector<Accuracy> in_float = measure<float>(i, samples), in_double = measure<double>(i, samples);
    for (std::size_t f = 0; f < in_double.size(); ++f) {
      const Measured which = blocks[i].functions[f].which;
      const cdot::AnyBlock* const form_of = block.general == i ? nullptr : &blocks[block.general].shape;
      lines.push_back({&block, form_of, which, operations(blocks[i], which), in_float[f], in_double[f]});
    }
  }
  std::ofstream(folder + "/accuracy.csv") << csv(lines);
  std::ofstream(folder + "/accuracy.md") << markdown(lines, samples);
  return at_most > 0 ? report_worse_than(at_most, lines) : 0;
}
