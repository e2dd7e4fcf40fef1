// The global system K lambda = b of one island: assembled from its row blocks, factored sparse,
// solved exactly.
#pragma once

#include <array>
#include <vector>

#include <cdot/detail/block.hpp>
#include <cdot/detail/state_array.hpp>

#include "runtime/direct/ldlt.hpp"

namespace cdot {

template <class S>
class System {
 public:
  using T = typename S::Scalar;
  using Real = ExactNumber<T>;

  // Analyses the pattern. Slots are told apart by their position in `segments`. tension_rows: how many each of
  // them has; none if empty.
  void build(const std::vector<Segment<S>>& segments, const Bodies<S>& bodies,
             const std::vector<int>& tension_rows = {});
  bool built() const { return built_; }
  int rows() const { return rows_; }

  // K from the present J and effective masses.
  void assemble(const Bodies<S>& bodies);

  // Rows have changed places, and those of a slot that is broken(batch, slot) are no more.
  template <class F>
  void find_rows(F broken_slot) {
    for (auto* list : {&blocks, &tensions})
      for (Block& block : *list) block.slot = block.batch->slot_of[block.home];
    for (const Block& block : blocks)
      std::fill_n(broken.begin() + block.first, block.rows, broken_slot(*block.batch, block.slot) ? 1 : 0);
  }
  // Rows have broken: others that seemed redundant for long may have been so beside these only.
  void doubt_redundant_rows() { ldlt_.doubt_lasting(); }

  // Some rows have softness or bounds.
  bool lawful() const { return lawful_; }

  // b of every row from value(batch, i), i numbering the batch's rows.
  template <class F>
  void load(F value) {
    each_row([&](int row, const Batch<S>& batch, int i) { b[row] = value(batch, i); });
    if (taut_) load_tensions(nullptr);
  }
  // Softness and bounds of the rows under a law.
  void load_laws();
  // Takes part only where wanted(batch, i); softness 0.
  template <class F>
  void choose(F wanted) {
    each_row([&](int row, const Batch<S>& batch, int i) {
      fixed[row] = wanted(batch, i) ? free : at_lower;
      softness[row] = lambda[row] = 0;
    });
  }
  // The same of rows that do not take part so far; the others stay. True if there is one more.
  template <class F>
  bool choose_more(F wanted) {
    bool any = false;
    each_row([&](int row, const Batch<S>& batch, int i) {
      if (!fixed[row] || !wanted(batch, i)) return;
      fixed[row] = free;
      softness[row] = lambda[row] = 0;
      any = true;
    });
    return any;
  }
  // lambda of the rows that do not take part.
  template <class F>
  void give(F force) {
    each_row([&](int row, const Batch<S>& batch, int i) {
      if (fixed[row]) lambda[row] = force(batch, i);
    });
  }
  // Hands lambda of every row to put(batch, i, lambda).
  template <class F>
  void store(F put) {
    each_row([&](int row, Batch<S>& batch, int i) { put(batch, i, lambda[row]); });
  }
  template <class F>
  void each_row(F f) {
    for (const Block& block : blocks)
      for (int r = 0; r < block.rows; ++r) f(block.first + r, *block.batch, block.slot * block.rows + r);
  }

  // Vectors over all rows, in the order of the blocks; the caller's to fill between the calls.
  std::vector<Real> b, lambda;
  std::vector<Real> softness, lower, upper;
  enum Hold : char { free = 0, at_lower = 1, at_upper = 2 };
  std::vector<char> fixed;   // Hold: where not free, lambda stays what it is
  std::vector<char> broken;  // 1: the row is no more: lambda = 0

  // Factors with the rows marked in `fixed` or `broken` taken out. Returns the number of dependent
  // rows.
  int factor();
  // lambda of the free rows from b and the lambda of the fixed ones. Rows that depend on others and contradict them are
  // met in the sense of least squares.
  void solve();
  // By how much the last solve() had to leave b unmet in a row; 0 where rows do not contradict each other.
  Real unmet(int row) const { return contradicted_ ? unmet_[static_cast<size_t>(row)] : Real(0); }
  // The share that a row has of K by itself: J M^-1 J^T of it alone.
  Real diagonal(int row) const { return ldlt_.diagonal(row); }
  // Of the last factor(): what it left of that; the row depends on others; x = K^-1 x of the rows that do not.
  Real pivot(int row) const { return ldlt_.pivot(row); }
  bool dependent(int row) const { return ldlt_.dependent(row); }
  void solve_factored(Real* x) { ldlt_.solve(x, x); }
  // y = K x of all rows.
  void multiply(const Real* x, Real* y) const { ldlt_.multiply(x, y); }
  // lambda within [lower, upper], by an active set: where a bound holds it back, J v + bias need
  // not vanish. Returns the number of dependent rows of the last factorisation.
  int solve_bounded();

  // Its State.
  StateArray<char>& active_set() { return active_set_; }
  BasicLdlt<Real>& factors() { return ldlt_; }

  // One block: rows [first, first + rows) belong to a slot of a batch.
  struct Block {
    Batch<S>* batch;
    int home, slot;  // Batch::slot_of[home]
    int first, rows;
    int jacobian;                         // into jacobian_ and weighted_
    typename BasicLdlt<Real>::Place own;  // its square in K
  };
  std::vector<Block> blocks, tensions;

  // Rows that the tension of a slot adds (runtime/solve/tension.hpp): the impulse -stiffness W v along W^T, as soft
  // rows. They are no joint's, so each_row() leaves them out, and their b is 0 but after load_tensions(). Slack until
  // tightened.
  void slacken();
  // Takes over from the system of the same blocks without tensions what changed since both were built, and forgets the
  // rest.
  void follow(const System& other);
  void tighten(const Block& tension, int row, const double* w, double stiffness);
  // b = -W velocity
  void load_tensions(const typename S::Velocity* velocity);
  // to += M^-1 W^T lambda
  void pull(const Bodies<S>& bodies, typename S::Velocity* to) const;

  // J of one block times the weighted J of another over one body that they share.
  struct Product {
    void (*add)(const Product&, const Real* J, const Real* weighted, Real* K);
    int J, weighted;                // into jacobian_ and weighted_
    int J_stride, weighted_stride;  // between rows
    int rows, columns;
    typename BasicLdlt<Real>::Place to;
  };

 private:
  // The factor is that of K with every row softened (runtime/direct/regularise.cpp).
  enum class Softened : char { no, slightly, plainly };
  template <class F>
  void each_tension_row(F f) const {
    for (const Block& tension : tensions)
      for (int r = 0; r < tension.rows; ++r) f(tension, r, tension.first + r);
  }
  void assemble_tensions(const Bodies<S>& bodies);
  void order_rows(const Bodies<S>& bodies);
  void list_products(const Bodies<S>& bodies);
  std::vector<int> movable_bodies(const Block& block, const Bodies<S>& bodies) const;
  Real largest_b() const;
  bool revise_active_set(bool one_by_one);
  int find_active_set();
  bool part_contradicting_rows();
  void solve_rows();
  void solve_kept_rows();
  static Real slight(Real scale);
  bool misses_rows(std::vector<Real>& missed);
  void share_contradictions();
  bool drops_rows_by_round_off();
  void soften(Softened how);
  Real find_rest(const std::vector<Real>& wanted, std::vector<Real>& rest);
  Real refine(const std::vector<Real>& wanted, Real scale);
  void solve_softly();
  bool kept(int row) const { return !out_[static_cast<size_t>(row)] && !ldlt_.dependent(row); }
  void contract(std::vector<Real>& w);
  void expand(const std::vector<Real>& y, std::vector<Real>& to);

  bool built_ = false, lawful_ = false, taut_ = false, any_out_ = false, contradicted_ = false;
  Softened softened_ = Softened::no;
  int rows_ = 0, dependent_ = 0;
  BasicLdlt<Real> ldlt_;
  std::vector<Product> products_;
  std::vector<Real> jacobian_, weighted_;
  std::vector<Real> right_side_, product_;
  std::array<std::vector<Real>, 4> shared_;  // by row, while contradictions are shared out or rows refined
  std::vector<Real> unmet_;                  // by row
  std::vector<int> tension_of_;              // which of `blocks`
  std::vector<char> out_;
  StateArray<char> active_set_;  // State: Hold by row, of the last solve_bounded()
};

}  // namespace cdot
