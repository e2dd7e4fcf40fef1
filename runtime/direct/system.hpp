// The system K lambda = b of one island: assembled from its row blocks, factored as a sparse matrix, solved to
// round-off.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include <cdot/detail/block.hpp>
#include <cdot/detail/state_array.hpp>

#include "runtime/direct/ldlt.hpp"
#include "runtime/number/circle.hpp"

namespace cdot {

// Rows that ask for a rate and have no place to keep, as a motor or a clutch.
template <class S>
bool is_motor(const Batch<S>& batch) {
  return batch.law && !batch.law->error && !batch.law->spring;
}

// True if the force of such a row has no bound in one direction. Held rows have none at acceleration level, until they
// reach that of their guard.
template <class S>
bool is_unlimited(const Batch<S>& batch, int i) {
  Guard<typename S::Scalar> guards[most_rows];
  guards[0].lower = batch.lower[i], guards[0].upper = batch.upper[i];
  const int r = batch.law->guard ? i % batch.ops->rows : 0;
  if (batch.law->guard) batch.law->guard(batch, i / batch.ops->rows, guards);
  return std::isinf(guards[r].lower) || std::isinf(guards[r].upper);
}

template <class S>
class System {
 public:
  using T = typename S::Scalar;
  using Real = ExactNumber<T>;
  static constexpr double most_blur = 1e-9;

  // Analyses the pattern. tension_rows: the number of each slot in the order of `segments`; empty: none.
  void build(const std::vector<Segment<S>>& segments, const Bodies<S>& bodies,
             const std::vector<int>& tension_rows = {});
  bool built() const { return built_; }
  int rows() const { return rows_; }

  // K from the present J and effective masses.
  void assemble(const Bodies<S>& bodies);

  // Call after slots changed places. Rows of a slot with broken_slot(batch, slot) no longer take part.
  template <class F>
  void find_rows(F broken_slot) {
    for (auto* list : {&blocks, &tensions})
      for (Block& block : *list) block.slot = block.batch->slot_of[block.home];
    for (const Block& block : blocks)
      std::fill_n(broken.begin() + block.first, block.rows, broken_slot(*block.batch, block.slot) ? 1 : 0);
  }
  // Call after rows broke: rows that are redundant by design may have depended on the broken rows only.
  void doubt_redundant_rows() { ldlt_.doubt_lasting(); }
  // Call where rows contradict each other that did not: those that are redundant by design and missed in the last
  // solve() may have been redundant in one pose only, as at a dead centre. False if there are none.
  bool doubt_missed_rows();

  // Poses that miss C = 0 turn rows by about `angle` [rad], which makes redundant rows independent by its square. From
  // now on such rows are redundant; light bodies leave pivots of that size as well, but smaller ones are rare.
  void blur(double angle) { ldlt_.blur(std::min(angle * angle, most_blur)); }

  // Bounded rows that are redundant may miss this share of the largest b and so much more: it is no contradiction.
  void forgive(T share, T more) { forgiven_share_ = share, forgiven_ = more; }

  // True if there are rows with softness or bounds.
  bool lawful() const { return lawful_; }
  // From now on solve() shares forces among redundant rows: among equal motions the least sum of squares. So it does
  // anyhow while an end holds.
  void share_loads() { shares_loads_ = true; }
  bool shares_loads() const { return shares_loads_; }
  // True if the last solve_bounded() shared some.
  bool shared() const { return shared_some_; }
  // Where lambda adds to other impulses, it is their sum whose squares are least: from before(batch, i), until it is
  // forgotten.
  template <class F>
  void add_to(F before) {
    if (!shares_loads_) return;
    adds_ = true;
    each_row([&](int row, const Batch<S>& batch, int i) { before_[row] = before(batch, i); });
  }
  void forget_before() { adds_ = false; }

  // b of every row from value(batch, i), i numbering the batch's rows.
  template <class F>
  void load(F value) {
    each_row([&](int row, const Batch<S>& batch, int i) { b[row] = value(batch, i); });
    if (taut_) load_tensions(nullptr);
  }
  // Softness and bounds of the rows under a law.
  void load_laws();
  // Selects the rows with wanted(batch, i); softness 0.
  template <class F>
  void choose(F wanted) {
    each_row([&](int row, const Batch<S>& batch, int i) {
      fixed[row] = wanted(batch, i) ? free : at_lower;
      softness[row] = lambda[row] = 0;
    });
  }
  // Adds rows with wanted(batch, i) to the selection. True if there was one.
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
  // Sets lambda of the rows that are not selected.
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

  // Of motors that others hold, as a share of their diagonals. With 1 they would push with what brings the bodies to
  // their speeds, and a blow would throw the bodies back off the ends on which they press.
  static constexpr double usual_softness = 0.1;
  double softness_of_motors = usual_softness;

  // Vectors over all rows, in the order of the blocks; the caller's to fill between the calls.
  std::vector<Real> b, lambda;
  std::vector<Real> softness, lower, upper;
  enum Hold : char { free = 0, at_lower = 1, at_upper = 2 };
  std::vector<char> fixed;   // Hold: unless free, lambda is given
  std::vector<char> broken;  // 1: the joint is broken, lambda = 0

  // Factors K without the rows marked in `fixed` or `broken`. Returns the number of redundant rows.
  int factor();
  // True if it would find the factor that there is: K, the softness of the rows and the selection are those of the last
  // factor(), and no row was redundant, as these are counted each time.
  bool factored_as_selected() const;
  // lambda of the free rows from b and from lambda of the fixed rows. Contradicting rows are satisfied in the sense of
  // least squares.
  void solve();
  // After solve() at acceleration level, where joints may break: shares the forces among redundant rows, held ones
  // under a law within [lower, upper]. True if some of these are in `fixed` now, so that the factor is of fewer rows.
  bool share_held_loads();
  // The error of a row after the last solve(); 0 unless rows contradict each other.
  Real unmet(int row) const { return contradicted_ ? unmet_[static_cast<size_t>(row)] : Real(0); }
  // Of the last solve() or solve_bounded(): a motor of unlimited force without its rate, since another one has a
  // different rate, or, if there is no other, since joints hold it; -1: none.
  struct Rivals {
    int row = -1, other = -1;
  };
  Rivals rivals() const;
  // Looks for them: call where a row misses more than `slight`, and before motors yield.
  void find_rivals(Real slight);
  // K_rr = J M^-1 J^T of the row alone.
  Real diagonal(int row) const { return ldlt_.diagonal(row); }
  // Treats the nearly redundant row that moves the bodies most in the last solve() as redundant, until it becomes
  // clearly independent, and factors again. False if no nearly redundant row does that.
  bool drop_dominant_row();
  // Results of the last factor(): the pivot of K_rr; whether the row is redundant; x = K^-1 x of the independent rows.
  Real pivot(int row) const { return ldlt_.pivot(row); }
  bool dependent(int row) const { return ldlt_.dependent(row); }
  void solve_factored(Real* x) { ldlt_.solve(x, x); }
  // J v + bias after the forces of the last solve_bounded(): find_excess() first.
  void find_excess() { ldlt_.multiply(lambda.data(), product_.data()); }
  // True if that is 0, to round-off.
  bool has_rate(int row) const { return std::abs(excess(row)) <= slight(largest_b(Of::all_rows)); }
  Real excess(int row) const { return product_[row] + softness[row] * lambda[row] - b[row]; }
  // y = K x over all rows.
  void multiply(const Real* x, Real* y) const { ldlt_.multiply(x, y); }
  // lambda within [lower, upper], by an active set: at a bound J v + bias need not vanish. Returns the number of
  // redundant rows of the last factorisation.
  int solve_bounded();
  // Factorisations of the last solve_bounded().
  int rounds() const { return rounds_; }

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

  // Soft rows for the tension of a slot (runtime/solve/tension.hpp): the impulse -stiffness W v along W^T. They belong
  // to no joint, so each_row() skips them; load_tensions() sets their b. They are inactive until tighten().
  void slacken();
  // Copies the changes since both were built from the system of the same blocks without tensions; resets everything
  // else.
  void follow(const System& other);
  void tighten(const Block& tension, int row, const double* w, double stiffness);
  // b = -W velocity
  void load_tensions(const typename S::Velocity* velocity);
  // to += M^-1 W^T lambda
  void pull(const Bodies<S>& bodies, typename S::Velocity* to) const;

  // J of one block times the weighted J of another, over one shared body.
  struct Product {
    void (*add)(const Product&, const Real* J, const Real* weighted, Real* K);
    int J, weighted;                // into jacobian_ and weighted_
    int J_stride, weighted_stride;  // between rows
    int rows, columns;
    typename BasicLdlt<Real>::Place to;
  };

 private:
  // Whether the factor is that of K with softness in every row (runtime/direct/regularise.cpp).
  enum class Softened : char { no, slightly, plainly };
  template <class F>
  void each_tension_row(F f) const {
    for (const Block& tension : tensions)
      for (int r = 0; r < tension.rows; ++r) f(tension, r, tension.first + r);
  }
  void assemble_tensions(const Bodies<S>& bodies);
  void order_rows(const Bodies<S>& bodies);
  void list_products(const Bodies<S>& bodies);
  bool has_light_bodies(const Bodies<S>& bodies) const;
  bool has_loops(const Bodies<S>& bodies) const;
  std::vector<int> movable_bodies(const Block& block, const Bodies<S>& bodies) const;
  enum class Of : char { all_rows, free_rows };
  Real largest_b(Of rows) const;
  Real largest_term() const;
  char bound_for(int row, Real excess, Real tolerance) const;
  bool revise_active_set(bool one_by_one);
  int find_active_set();
  int end_turns();
  int part_and_settle();
  bool part_contradicting_rows();
  bool let_bounds_decide();
  void solve_rows();
  void solve_kept_rows();
  void load_softness();
  static Real slight(Real scale);
  bool misses_rows(std::vector<Real>& missed);
  bool misses_rate(int row) const;
  void share_contradictions();
  enum class Bounds : char { unknown, known };
  Real whole(int row) const { return adds_ ? before_[row] + lambda[row] : lambda[row]; }
  const std::vector<Real>& idle_loads();
  int share_redundant_loads(Bounds bounds);
  void load_held_bounds();
  int row_beyond_bounds() const;
  void free_idle_rows();
  void stiffen();
  bool leaves_bound();
  void stay_at_bounds();
  void share_within_bounds();
  struct Part {
    Real share;
    int row;
  };
  Part part_within_bounds(const std::vector<Real>& image) const;
  void divide_by_null_space(std::vector<Real>& rest, std::vector<Real>& y);
  bool drops_rows_by_round_off();
  void soften(Softened how);
  Real find_rest(const std::vector<Real>& wanted, std::vector<Real>& rest);
  Real refine(const std::vector<Real>& wanted, Real scale);
  void solve_softly();
  bool kept(int row) const { return !out_[static_cast<size_t>(row)] && !ldlt_.dependent(row); }
  void contract(std::vector<Real>& w);
  void expand(const std::vector<Real>& y, std::vector<Real>& to);

  bool built_ = false, shares_loads_ = false, lawful_ = false, taut_ = false, any_out_ = false, contradicted_ = false;
  bool adds_ = false, shared_some_ = false;
  bool multiplies_own_ = false;  // blocks of K on its diagonal, rather than take those of the kernels
  Real forgiven_share_ = 0, forgiven_ = 0;
  bool yields_ = false, eased_ = false;  // within solve_bounded(): part_and_settle()
  Softened softened_ = Softened::no;
  int rows_ = 0, dependent_ = 0, rounds_ = 0;
  BasicLdlt<Real> ldlt_;
  std::vector<Product> products_;
  std::vector<Real> jacobian_, weighted_;
  std::vector<Real> right_side_, product_;
  std::array<std::vector<Real>, 4> shared_;  // by row, scratch of least_squares.cpp and regularise.cpp
  std::vector<Real> unmet_;                  // by row
  std::vector<Real> before_;                 // by row, while adds_
  Rivals rivals_;                            // before they are known to miss their rates
  std::vector<int> tension_of_;              // index into `blocks`
  std::vector<char> out_, passing_;          // passing_: rows under a law, which may leave
  Circle circle_;                            // of active sets, within find_active_set()
  StateArray<char> active_set_;              // State: Hold by row, of the last solve_bounded()
};

}  // namespace cdot
