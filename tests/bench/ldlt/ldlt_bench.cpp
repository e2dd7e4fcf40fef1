// The direct solver against Eigen's SimplicialLDLT with its pattern reused, on the same K of the
// same islands. Prints a table of medians and ratios of this run.
//
//   ldlt_bench [--benchmark_filter=chain] [--benchmark_repetitions=9]
#include <Eigen/SparseCholesky>
#include <benchmark/benchmark.h>
#include <fmt/core.h>
#include <map>
#include <memory>

#include <cdot/jacobian.hpp>

#include "runtime/state/world_data.hpp"
#include "tests/runtime/mechanisms.hpp"

namespace cdot::test {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Library = Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::AMDOrdering<int>>;

// K without its exact zeros. At redundant rows Eigen would stop with a pivot of 0, so its K gets a small share on the
// diagonal.
Sparse sparse(const SystemMatrix& system) {
  const Eigen::Map<const Eigen::MatrixXd> K(system.K.data(), system.rows, system.rows);
  Sparse lower = K.sparseView();
  if (system.rank < system.rows)
    for (int i = 0; i < system.rows; ++i) lower.coeffRef(i, i) *= 1 + 1e-9;
  lower.makeCompressed();
  return lower;
}

template <class S>
struct Bench {
  BasicWorld<S> world;
  Island<S>* island = nullptr;
  Sparse K;
  Eigen::VectorXd b, x;
  std::vector<double> right_side;

  explicit Bench(const std::function<void(BasicWorld<S>&)>& add) : world(settings()) {
    add(world);
    for (int i = 0; i < 20; ++i) world.step(1e-3);
    island = &world.data().islands.at(0);
    const SystemMatrix system = system_matrix(world);
    K = sparse(system);
    // b = K x, so no redundant row contradicts the others.
    const Eigen::VectorXd forces = Eigen::VectorXd::LinSpaced(system.rows, -1, 2);
    b = K.selfadjointView<Eigen::Lower>() * forces;
    right_side.resize(forces.size());
    island->system.assemble(world.data().bodies);
    island->system.multiply(forces.data(), right_side.data());
  }
  static Settings settings() {
    Settings s;
    s.gravity_y = -9.81;
    return s;
  }
  void load() { island->system.b = right_side; }
};

template <class S>
void analyse(benchmark::State& state, Bench<S>& bench) {
  System<S> system;
  for (auto _ : state) {
    system.build(bench.island->segments, bench.world.data().bodies);
    benchmark::DoNotOptimize(system.rows());
  }
}

template <class S>
void assemble(benchmark::State& state, Bench<S>& bench) {
  for (auto _ : state) bench.island->system.assemble(bench.world.data().bodies);
}

template <class S>
void factor(benchmark::State& state, Bench<S>& bench) {
  for (auto _ : state) benchmark::DoNotOptimize(bench.island->system.factor());
}

template <class S>
void solve(benchmark::State& state, Bench<S>& bench) {
  bench.island->system.factor();
  for (auto _ : state) {
    bench.load();
    bench.island->system.solve();
    benchmark::ClobberMemory();
  }
}

template <class S>
void analyse_by_library(benchmark::State& state, Bench<S>& bench) {
  for (auto _ : state) {
    Library library;
    library.analyzePattern(bench.K);
    benchmark::ClobberMemory();
  }
}

template <class S>
void factor_by_library(benchmark::State& state, Bench<S>& bench) {
  Library library;
  library.analyzePattern(bench.K);
  for (auto _ : state) {
    library.factorize(bench.K);
    benchmark::ClobberMemory();
  }
  if (library.info() != Eigen::Success) state.SkipWithError("no factorisation");
}

template <class S>
void solve_by_library(benchmark::State& state, Bench<S>& bench) {
  Library library;
  library.compute(bench.K);
  for (auto _ : state) {
    bench.x = library.solve(bench.b);
    benchmark::ClobberMemory();
  }
}

// Median of each benchmark, by mechanism and stage.
class Table : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Aggregate || run.aggregate_name != "median") continue;
      const std::string name = run.run_name.function_name;
      const auto slash = name.find('/');
      rows_[name.substr(0, slash)] = static_cast<int>(run.counters.at("rows"));
      median_[name.substr(0, slash)][name.substr(slash + 1)] = run.GetAdjustedCPUTime();
    }
  }
  void print(const std::vector<std::string>& mechanisms) {
    fmt::print(
        "| mechanism | rows | analyse | Eigen | assemble | factor | Eigen | solve | Eigen | "
        "factor + solve: Eigen / ours | analyse: Eigen / ours |\n"
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
    for (const std::string& name : mechanisms) {
      const auto found = median_.find(name);
      if (found == median_.end()) continue;
      const auto ns = [&](const char* stage) {
        const auto at = found->second.find(stage);
        return at == found->second.end() ? std::nan("") : at->second;
      };
      fmt::print("| {} | {} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.2f} | {:.2f} |\n", name,
                 rows_[name], ns("analyse"), ns("analyse_eigen"), ns("assemble"), ns("factor"), ns("factor_eigen"),
                 ns("solve"), ns("solve_eigen"),
                 (ns("factor_eigen") + ns("solve_eigen")) / (ns("factor") + ns("solve")),
                 ns("analyse_eigen") / ns("analyse"));
    }
  }

 private:
  std::map<std::string, std::map<std::string, double>> median_;
  std::map<std::string, int> rows_;
};

std::vector<std::string> mechanisms;

template <class S>
void add(const std::string& name, const std::function<void(BasicWorld<S>&)>& build) {
  static std::map<std::string, std::unique_ptr<Bench<S>>> built;  // built at the first measurement
  mechanisms.push_back(name);
  const auto stage = [&](const char* of, void (*run)(benchmark::State&, Bench<S>&)) {
    benchmark::RegisterBenchmark((name + "/" + of).c_str(), [=](benchmark::State& state) {
      auto& bench = built[name];
      if (!bench) bench = std::make_unique<Bench<S>>(build);
      run(state, *bench);
      state.counters["rows"] = bench->island->system.rows();
    });
  };
  stage("analyse", analyse<S>);
  stage("analyse_eigen", analyse_by_library<S>);
  stage("assemble", assemble<S>);
  stage("factor", factor<S>);
  stage("factor_eigen", factor_by_library<S>);
  stage("solve", solve<S>);
  stage("solve_eigen", solve_by_library<S>);
}

void add_all() {
  using Plane = Planar<double>;
  using Space = Spatial<double>;
  add<Plane>("slider_crank", add_slider_crank);
  add<Plane>("four_bar", add_four_bar);
  for (int links : {10, 30, 100, 300, 1000})
    add<Plane>(fmt::format("chain_{}", links), [links](World<double>& world) { add_zigzag(world, links); });
  add<Plane>("ragdoll", add_ragdoll);
  for (int n : {3, 5, 8})
    add<Plane>(fmt::format("squares_{}x{}", n, n), [n](World<double>& world) { add_rotating_squares(world, n, 0.3); });
  for (const char* joint : {"spherical", "hinge", "fixed"})
    for (int links : {3, 10, 30})
      add<Space>(fmt::format("{}_chain_{}", joint, links),
                 [=](SpatialWorld<double>& world) { add_spatial_chain(world, links, joint); });
  add<Space>("hinge_loop", add_hinge_loop);
}

}  // namespace
}  // namespace cdot::test

int main(int count, char** arguments) {
  std::vector<char*> given(arguments, arguments + count);
  std::string defaults[] = {"--benchmark_repetitions=9", "--benchmark_min_time=0.01",
                            "--benchmark_enable_random_interleaving=true"};
  for (std::string& one : defaults) given.insert(given.begin() + 1, one.data());
  int all = static_cast<int>(given.size());
  benchmark::Initialize(&all, given.data());
  if (benchmark::ReportUnrecognizedArguments(all, given.data())) return 2;
  cdot::test::add_all();
  cdot::test::Table table;
  benchmark::RunSpecifiedBenchmarks(&table);
  table.print(cdot::test::mechanisms);
}
