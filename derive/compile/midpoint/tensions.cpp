#include "derive/compile/midpoint/tensions.hpp"

#include <fmt/format.h>

#include "derive/kernel/factor.hpp"

namespace cdot::compile {
namespace {

using derive::element;
using derive::triangle_element;

// The functions of a kernel whose J is given: inputs "W_r_k_c" by row, body and column.
class KernelOfRows {
 public:
  KernelOfRows(const Mechanism& mechanism, const std::vector<std::string>& bodies, std::size_t rows)
      : mechanism_(mechanism), bodies_(bodies), rows_(rows) {}

  RowPrograms write() const {
    RowPrograms programs;
    for (std::size_t r = 0; r < rows_; ++r) programs.names.push_back(fmt::format("{}", r));
    programs.functions["velocity"] = of_each([&](derive::ProgramBuilder& b) { write_velocity(b); });
    programs.functions["dense"] = of_each([&](derive::ProgramBuilder& b) { write_dense(b); });
    programs.functions["effective_mass"] = of_each([&](derive::ProgramBuilder& b) { write_masses(b); });
    programs.functions["apply"] = of_each([&](derive::ProgramBuilder& b) { write_forces(b); });
    return programs;
  }

  static std::string name(std::size_t row, std::size_t body, std::size_t column) {
    return fmt::format("W_{}_{}_{}", row, body, column);
  }

 private:
  template <class F>
  static Program of_each(F f) {
    derive::ProgramBuilder builder;
    f(builder);
    return builder.finish();
  }
  static int input(derive::ProgramBuilder& b, const std::string& name) {
    Operation op;
    op.kind = OpKind::input, op.input = name;
    return b.leaf(op);
  }
  // f(body, column)
  template <class F>
  void each_column(F f) const {
    for (std::size_t k = 0; k < bodies_.size(); ++k)
      for (std::size_t c = 0; c < mechanism_.columns(); ++c) f(k, c);
  }
  std::string speed(std::size_t body, std::size_t c) const {
    const std::string column = mechanism_.column(c);
    if (column.front() != 'w') return fmt::format("v_{}_{}", bodies_[body], column);
    return fmt::format("w_{}{}", bodies_[body], mechanism_.spatial() ? "_" + column.substr(1) : "");
  }

  void write_velocity(derive::ProgramBuilder& b) const {
    for (std::size_t r = 0; r < rows_; ++r) {
      Summands terms;
      each_column([&](std::size_t k, std::size_t c) {
        terms.add(1, b.product({input(b, name(r, k, c)), input(b, speed(k, c))}, {1, 1}));
      });
      b.output(element("Jv", r), b.sum(terms));
    }
  }
  void write_dense(derive::ProgramBuilder& b) const {
    for (std::size_t r = 0; r < rows_; ++r)
      each_column([&](std::size_t k, std::size_t c) {
        b.output(element(element("D", r), mechanism_.columns() * k + c), input(b, name(r, k, c)));
      });
  }
  void write_masses(derive::ProgramBuilder& b) const {
    for (std::size_t r = 0; r < rows_; ++r)
      for (std::size_t s = 0; s <= r; ++s) {
        Summands terms;
        each_column([&](std::size_t k, std::size_t c) { add_masses(b, r, s, k, c, terms); });
        b.output(triangle_element("K", r, s), b.sum(terms));
      }
  }
  void add_masses(derive::ProgramBuilder& b, std::size_t r, std::size_t s, std::size_t k, std::size_t c,
                  Summands& terms) const {
    constexpr const char* axes = "xyz";
    const std::size_t first = mechanism_.linear();
    const auto add = [&](const std::string& inverse, std::size_t other) {
      terms.add(1, b.product({input(b, name(r, k, c)), input(b, name(s, k, other)), input(b, inverse)}, {1, 1, 1}));
    };
    if (c < first) return add("inv_m_" + bodies_[k], c);
    if (!mechanism_.spatial()) return add("inv_I_" + bodies_[k], c);
    for (std::size_t j = 0; j < 3; ++j)
      add(fmt::format("inv_I_{}_{}{}", bodies_[k], axes[std::min(c - first, j)], axes[std::max(c - first, j)]),
          first + j);
  }
  void write_forces(derive::ProgramBuilder& b) const {
    each_column([&](std::size_t k, std::size_t c) {
      Summands terms;
      for (std::size_t r = 0; r < rows_; ++r)
        terms.add(1, b.product({input(b, name(r, k, c)), input(b, fmt::format("lambda_{}", r + 1))}, {1, 1}));
      b.output(element("v", k) + "." + mechanism_.column(c), b.sum(terms));
    });
  }

  const Mechanism& mechanism_;
  const std::vector<std::string>& bodies_;
  const std::size_t rows_;
};

}  // namespace

Tensions::Tensions(const RowBlocks& blocks, const JointRows& joints, Constants& constants) : blocks_(blocks) {
  const auto note = [&](std::size_t block, const RowBlock& of, int rows) {
    if (rows == 0) return;
    const auto count = static_cast<std::size_t>(rows);
    Taut& taut = taut_.emplace_back(Taut{block, of, count, rows_, numbers_, {}});
    taut.of.name += "_tension", taut.of.holds = -1, taut.of.motor = nullptr;
    taut.programs = KernelOfRows(blocks.mechanism(), of.spec->bodies, count).write();
    taut.of.rows = &taut.programs;
    rows_ += count, numbers_ += count * places(of).size();
  };
  const std::size_t count = joints.system().blocks().size();
  for (std::size_t k = 0; k < count; ++k)
    note(k, joints.system().blocks()[k], joints.system().blocks()[k].joint->tensions);
  for (std::size_t b = 0; b < blocks.mechanism().bounded.size(); ++b)
    note(count + b, blocks.bounded(b), blocks.mechanism().bounded[b].tensions);
  for (std::size_t n = 0; n < numbers_; ++n) constants.at_start[element("N.w", n)] = 0;
  for (std::size_t n = 0; n < rows_; ++n) constants.at_start[element("N.d", n)] = 0;
}

std::vector<Tensions::Place> Tensions::places(const RowBlock& block) const {
  std::vector<Place> places;
  for (std::size_t k = 0; k < block.bodies->size(); ++k)
    for (std::size_t c = 0; c < blocks_.mechanism().columns(); ++c)
      if (blocks_.mechanism().bodies[static_cast<std::size_t>((*block.bodies)[k])].moves) places.push_back({k, c});
  return places;
}

void Tensions::write(Algebra& algebra, std::size_t block, std::vector<std::vector<int>>& A) const {
  if (!has(block)) return;
  const auto taut = std::ranges::find(taut_, block, &Taut::block);
  const std::size_t columns = blocks_.mechanism().columns();
  std::vector<std::size_t> all;
  for (const Place& place : places(taut->of)) all.push_back(columns * place.body + place.column);
  const int zero = algebra.value(0);
  for (std::size_t r = 0; r < taut->count; ++r) {
    int most = zero;
    std::vector<int> row(all.size(), zero), w(all.size());
    std::vector<int> seen;
    for (const std::size_t held : all) {
      if (held % columns >= blocks_.mechanism().linear() || std::ranges::count(seen, A[held][held]) > 0) continue;
      seen.push_back(A[held][held]);
      const int more = algebra.sum({{A[held][held], most}, {1, -1}});
      for (std::size_t j = 0; j < all.size(); ++j)
        row[j] = algebra.function(Fn::select, {more, A[held][all[j]], row[j]});
      most = algebra.function(Fn::select, {more, A[held][held], most});
    }
    const int inverse = algebra.function(Fn::inverse, {most});
    for (std::size_t j = 0; j < all.size(); ++j) {
      w[j] = algebra.times(row[j], inverse);
      algebra.output(element("B.w", taut->first_number + r * all.size() + j), w[j]);
    }
    algebra.output(element("B.d", taut->first_row + r), most);
    for (std::size_t i = 0; i < all.size(); ++i)
      for (std::size_t j = 0; j < all.size(); ++j)
        A[all[i]][all[j]] =
            algebra.sum({{A[all[i]][all[j]], algebra.times(row[std::min(i, j)], w[std::max(i, j)])}, {1, -1}});
  }
}

std::vector<RowBlock> Tensions::blocks() const {
  std::vector<RowBlock> blocks;
  for (const Taut& taut : taut_) blocks.push_back(taut.of);
  return blocks;
}

Values Tensions::inputs(Algebra& algebra, const RowBlocks& blocks, std::size_t number) const {
  const Taut& taut = taut_[number];
  Values in = blocks.inputs(algebra, taut.of);
  const std::vector<Place> all = places(taut.of);
  for (std::size_t r = 0; r < taut.count; ++r) {
    for (std::size_t k = 0; k < taut.of.bodies->size(); ++k)
      for (std::size_t c = 0; c < blocks_.mechanism().columns(); ++c)
        in[KernelOfRows::name(r, k, c)] = algebra.value(0);
    for (std::size_t j = 0; j < all.size(); ++j)
      in[KernelOfRows::name(r, all[j].body, all[j].column)] =
          algebra.input(element("N.w", taut.first_number + r * all.size() + j));
  }
  return in;
}

std::vector<int> Tensions::share(Algebra& algebra, std::size_t number) const {
  std::vector<int> share;
  const Taut& taut = taut_[number];
  for (std::size_t r = 0; r < taut.count; ++r) {
    const int D = algebra.input(element("N.d", taut.first_row + r));
    share.push_back(
        algebra.function(Fn::sqrt, {algebra.product({algebra.value(0.25), algebra.input("h"), D}, {1, 1, 1})}));
  }
  return share;
}

}  // namespace cdot::compile
