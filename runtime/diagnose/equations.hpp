// An island -> K of its joints at the present poses, factored. Effects and inactive inequalities are left out.
#pragma once

#include <cmath>

#include <cdot/diagnose.hpp>

#include "runtime/number/arbitrary.hpp"
#include "runtime/state/world_data.hpp"

namespace cdot {

template <class S>
class Equations {
 public:
  using T = typename S::Scalar;

  Equations(WorldData<S>& world, Island<S>& island) : world_(world) {
    for (const Segment<S>& segment : island.segments)
      if (is_joint(*segment.batch) && segment.batch->ops->rows > 0 && segment.begin < segment.end)
        segments_.push_back(segment);
    evaluate();
    system_.build(segments_, world.bodies);
    system_.choose(takes_part);
    joints_.resize(static_cast<size_t>(system_.rows()));
    C_.resize(joints_.size());
    system_.each_row([&](int row, const Batch<S>& batch, int i) {
      if (!out(row)) ++rows_;
      joints_[row] = {batch.joint[i / batch.ops->rows], i % batch.ops->rows};
      C_[row] = batch.kinds[i % batch.ops->rows] == RowKind::velocity ? 0.0 : double(batch.C[i]);
    });
    system_.assemble(world.bodies);
    dependent_ = system_.factor();
  }

  // [m, rad]: a smaller residual is no contradiction.
  static constexpr T resolution = T(by_precision<T>(1e-5, 1e-9));

  static bool takes_part(const Batch<S>& batch, int i) {
    return is_joint(batch) && (batch.kinds[i % batch.ops->rows] != RowKind::inequality || batch.C[i] <= resolution);
  }

  const std::vector<Segment<S>>& segments() const { return segments_; }
  int rows() const { return rows_; }
  int rank() const { return rows_ - dependent_; }
  size_t size() const { return joints_.size(); }
  Diagnosis::Row joint(size_t row) const { return joints_[row]; }
  double C(size_t row) const { return C_[row]; }
  bool out(size_t row) const { return system_.fixed[row] != System<S>::free; }
  bool dependent(size_t row) const { return !out(row) && system_.dependent(static_cast<int>(row)); }
  bool independent(size_t row) const { return !out(row) && !dependent(row); }
  // K_ii, before and after elimination.
  double diagonal(size_t row) const { return system_.diagonal(static_cast<int>(row)); }
  double pivot(size_t row) const { return system_.pivot(static_cast<int>(row)); }

  std::vector<double> multiply(const std::vector<double>& x) const {
    std::vector<double> y(size());
    if (rows_ > 0) system_.multiply(x.data(), y.data());
    return y;
  }
  // For the independent rows; the others are 0.
  std::vector<double> solve(std::vector<double> b) {
    for (size_t r = 0; r < size(); ++r)
      if (!independent(r)) b[r] = 0;
    if (rows_ > 0) system_.solve_factored(b.data());
    for (size_t r = 0; r < size(); ++r)
      if (!independent(r)) b[r] = 0;
    return b;
  }

  // C and J at the present poses.
  void evaluate() {
    for (const Segment<S>& segment : segments_)
      segment.batch->ops->evaluate(*segment.batch, segment.begin, segment.end, world_.bodies, T(world_.time));
  }
  // f(row, batch, i) as System::each_row.
  template <class F>
  void each_row(F f) {
    system_.each_row(f);
  }

 private:
  static bool is_joint(const Batch<S>& batch) { return !batch.law || batch.law->reported; }

  WorldData<S>& world_;
  std::vector<Segment<S>> segments_;
  System<S> system_;
  std::vector<Diagnosis::Row> joints_;
  std::vector<double> C_;
  int rows_ = 0, dependent_ = 0;
};

// [rad/s]
template <class S>
double spin_of(const typename S::Velocity& velocity) {
  typename S::Scalar numbers[S::freedom];
  S::write(velocity, numbers);
  double square = 0;
  for (int k = S::lengths; k < S::freedom; ++k) square += double(numbers[k]) * double(numbers[k]);
  return std::sqrt(square);
}

// h (d + h k) K of the stiffest row whose force has limits, within these; 0 without such rows. Above about 1 only a
// step that is implicit up to the limits ends where the force would.
template <class S>
double stiffest_limited_force(WorldData<S>& world, const Island<S>& island, typename S::Scalar h);

// The stiffest motion of the island in steps of h: the linearly implicit step reduces its stiffness.
template <class S>
Diagnosis::Stiffest stiffest_motion(WorldData<S>& world, Island<S>& island, Equations<S>& equations,
                                    typename S::Scalar h);

// The decay that limits explicit steps. The accelerations are linear in small changes of the velocities.
template <class S>
Diagnosis::Decay fastest_decay(WorldData<S>& world, Island<S>& island, Equations<S>& equations);

}  // namespace cdot
