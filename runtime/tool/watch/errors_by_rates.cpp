#include "runtime/tool/watch/errors_by_rates.hpp"

#include <algorithm>

#include <cdot/spaces.hpp>

#include "runtime/step/runge_kutta.hpp"

namespace cdot {
namespace {

using Vector = std::array<double, 3>;

// Of the ends, in steps.
constexpr double of_four[] = {14.0 / 45, 64.0 / 45, 24.0 / 45, 64.0 / 45, 14.0 / 45};  // Boole's rule
constexpr double of_six[] = {41.0 / 140, 216.0 / 140, 27.0 / 140, 272.0 / 140, 27.0 / 140, 216.0 / 140, 41.0 / 140};

template <class S>
constexpr int end_of_step = rk4<ExactNumber<typename S::Scalar>>.stages;  // its row in FlowState::rates

template <class T>
BodyError body_error(const planar::Pose<T>&, const double* d) {
  return {{d[0], d[1]}, {0, 0, d[2]}, {d[3], d[4]}, {0, 0, d[5]}};
}

// A small turn t changes a quaternion e by (0, t) e / 2.
template <class T>
BodyError body_error(const spatial::Pose<T>& at, const double* d) {
  const double* const e = d + 3;
  const Vector turn{2 * (at.e0 * e[1] - at.e1 * e[0] - e[2] * at.e3 + e[3] * at.e2),
                    2 * (at.e0 * e[2] - at.e2 * e[0] - e[3] * at.e1 + e[1] * at.e3),
                    2 * (at.e0 * e[3] - at.e3 * e[0] - e[1] * at.e2 + e[2] * at.e1)};
  return {{d[0], d[1], d[2]}, turn, {d[7], d[8], d[9]}, {d[10], d[11], d[12]}};
}

// One of the rates at the ends.
template <class S>
void add_rate(const Island<S>& island, double weight, int stage, std::vector<double>& sum) {
  const auto* rate = island.flow.rates.data() + static_cast<std::size_t>(stage) * island.flow.now.size();
  for (const int body : island.bodies) {
    double* const to = sum.data() + body * numbers_per_body<S>;
    for (int k = 0; k < numbers_per_body<S>; ++k) to[k] += weight * double(*rate++);
  }
}

}  // namespace

template <class S>
bool ErrorsByRates<S>::add(const WorldData<S>& world, int step, double h) {
  if (step == 0) {
    awake_.assign(world.awake.begin(), world.awake.end()), rescued_ = world.counts->rescued;
    end_.assign(static_cast<std::size_t>(world.bodies.count() * numbers_per_body<S>), 0);
  }
  const double* const weights = steps_ == most ? of_six : of_four;
  const auto whole = [&](int k) { return world.islands[k].flow.known && world.islands[k].flow.length == h; };
  if (world.counts->rescued != rescued_ || !std::ranges::equal(awake_, world.awake) ||
      !std::ranges::all_of(awake_, whole))
    return false;
  for (const int k : awake_) {
    const Island<S>& island = world.islands[k];
    const auto* start = island.flow.start.data();
    for (const int body : island.bodies)
      for (int n = 0; step == 0 && n < numbers_per_body<S>; ++n)
        end_[body * numbers_per_body<S> + n] = double(*start++);
    if (step == 0) add_rate(island, weights[0] * h, 0, end_);
    add_rate(island, weights[step + 1] * h, end_of_step<S>, end_);
  }
  return true;
}

template <class S>
void ErrorsByRates<S>::read(const WorldData<S>& world, std::vector<BodyError>& errors) const {
  std::ranges::fill(errors, BodyError{});
  for (const int k : awake_)
    for (const int body : world.islands[k].bodies) {
      typename S::Scalar now[numbers_per_body<S>];
      double off[numbers_per_body<S>];
      S::write(world.bodies.pose[body], now), S::write(world.bodies.velocity[body], now + S::pose_numbers);
      for (int n = 0; n < numbers_per_body<S>; ++n) off[n] = double(now[n]) - end_[body * numbers_per_body<S> + n];
      errors[body] = body_error(world.bodies.pose[body], off);
    }
}

#define CDOT_INSTANTIATE(S) template class ErrorsByRates<S>;
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
