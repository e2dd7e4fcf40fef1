// K = J M^-1 J^T of several row blocks as operations: assembled, factored and solved in a fixed order of elimination.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "derive/compile/rows/row_blocks.hpp"

namespace cdot::compile {

class RowSystem {
 public:
  // Blocks without rows take no part.
  RowSystem(const RowBlocks& rows, std::vector<RowBlock> blocks);

  std::size_t size() const { return names_.size(); }
  const std::vector<RowBlock>& blocks() const { return blocks_; }
  std::size_t first_row(std::size_t block) const { return first_[block]; }
  const std::vector<std::string>& names() const { return names_; }  // "hinge_pin_x"

  // --- in the Algebra of the factor ---

  // The part of K of one block; J is among `in`.
  void add_block(Algebra& algebra, std::size_t block, const Values& in);
  // The rows of blocks that share bodies.
  void couple(Algebra& algebra);
  // Row and column times `by`, and 1 on the diagonal.
  void soften(Algebra& algebra, std::size_t row, int by);
  // K = L D L^T, U = L D. In the plane a block of two rows is one of D; L_1_0 is then the number of its inverse beside
  // inv_D_0 and inv_D_1. The numbers in names are places in the order. store("L_5_4", operation) gives what solve()
  // reads. A row that depends on others at the start is redundant by design, as in the World: it takes no part until
  // its pivot exceeds a share of its diagonal, else round-off of its pivot would magnify that of C.
  using Store = std::function<void(const std::string& name, int op)>;
  void factor(Algebra& algebra, const Store& store);

  // 1/D of the place j in the order, in this factor or in one of a matrix beside K, where its diagonal entry is that.
  int inverse_pivot(Algebra& algebra, std::size_t j, int D, int diagonal) const;
  // The same of two places at once, those from which a block begins: of (a b; c d), row by row.
  bool begins_block(std::size_t j) const { return j + 1 < is_second_.size() && is_second_[j + 1]; }
  std::array<int, 4> inverse_block(Algebra& algebra, std::size_t j, const std::array<int, 4>& block,
                                   const std::array<int, 2>& diagonal) const;

  // --- in that Algebra or another one ---

  // lambda from b, both by rows. read("L_5_4") is the operation that was stored.
  using Read = std::function<int(const std::string& name)>;
  std::vector<int> solve(Algebra& algebra, const std::vector<int>& b, const Read& read) const;
  // d = M^-1 J^T lambda as outputs "d[rod].x"; `inputs` gives those of a block, with J.
  void write_changes(Algebra& algebra, const std::vector<int>& lambda,
                     const std::function<Values(std::size_t block)>& inputs) const;
  const std::vector<std::size_t>& order() const { return order_; }
  // After factor(), by places in the order: whether L has this number, and whether a row is redundant at the start.
  bool has_L(std::size_t i, std::size_t j) const { return L_[i][j]; }
  bool is_redundant(std::size_t place) const { return redundant_[place]; }
  bool has_redundant_rows() const { return std::ranges::find(redundant_, true) != redundant_.end(); }

 private:
  // A row that pulls along the constant u at a point p of a body: +-A (p x A^T u) is its part that turns, with p in the
  // axes of the body. The first numbers of p and u are positive.
  struct Pull {
    std::array<double, 3> point, along;
    int sign;
  };

  void order_rows(const Algebra& algebra);
  bool is_constant(const Algebra& algebra, std::size_t block) const;
  bool share_a_body(std::size_t i, std::size_t k) const;
  void note_pulls(const Algebra& algebra, std::size_t block);
  std::optional<Pull> pull_of(const Algebra& algebra, std::size_t block, std::size_t row, std::size_t body) const;
  bool of_rotation(const Algebra& algebra, std::size_t block, std::size_t row, std::size_t body, std::size_t axis,
                   double (&m)[3][3]) const;
  bool has_pulls(std::size_t block, std::size_t row) const;
  int turning(Algebra& algebra, int body, const Pull& x, const Pull& y) const;
  int entry(Algebra& algebra, std::size_t i, std::size_t r, std::size_t k, std::size_t s) const;
  void couple(Algebra& algebra, std::size_t i, std::size_t k);
  // U = L D, of which L is found place by place; noise: of the pivots at the start.
  struct Factoring {
    Algebra& algebra;
    const Store& store;
    std::vector<std::vector<int>> U, L;
    std::vector<double> noise;
  };
  int reduced(Factoring& f, std::size_t i, std::size_t j, std::size_t m, const std::string& name) const;
  bool is_noise(Factoring& f, std::size_t j, double pivot, double noise) const;
  bool begins_pair(Factoring& f, std::size_t j, int D) const;
  void eliminate(Factoring& f, std::size_t j, int D);
  void eliminate_pair(Factoring& f, std::size_t j, int D);
  int K(std::size_t i, std::size_t j) const { return K_[std::max(i, j)][std::min(i, j)]; }

  const RowBlocks& rows_;
  std::vector<RowBlock> blocks_;
  std::vector<std::size_t> first_;
  std::vector<std::string> names_;
  std::vector<std::size_t> order_;                    // of elimination, from factor() on
  std::vector<Values> dense_;                         // by block
  std::map<std::array<std::size_t, 3>, Pull> pulls_;  // by block, row and body of the block
  std::vector<std::vector<int>> K_;                   // lower triangle; -1: zero
  std::vector<std::vector<bool>> L_;                  // which entries are not zero
  std::vector<bool> redundant_;                       // at the start, by places in the order
  std::vector<bool> is_second_;                       // places whose block of D has two rows, the one before included
};

}  // namespace cdot::compile
