#include "runtime/own/check_own.hpp"

#include <cmath>
#include <fmt/format.h>
#include <map>
#include <random>

#include <cdot/planar.hpp>
#include <cdot/spatial.hpp>

#include "runtime/own/own_rows.hpp"

namespace cdot {
namespace {

constexpr int poses = 16;
constexpr double difference_step = 1e-5, tolerance = 1e-6;

class Random {
 public:
  double number() { return 2 * static_cast<double>(source_()) / 4294967296.0 - 1; }  // in [-1, 1)

 private:
  std::mt19937 source_{20240229};
};

// An orthonormal triad, axis by axis, from two random vectors.
void write_triad(Random& random, double* to) {
  double x[3], y[3];
  for (double& number : x) number = random.number();
  for (double& number : y) number = random.number();
  const auto normalise = [](double(&v)[3]) {
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (double& number : v) number /= length;
  };
  normalise(x);
  const double along = x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
  for (int k = 0; k < 3; ++k) y[k] -= along * x[k];
  normalise(y);
  for (int k = 0; k < 3; ++k) {
    to[k] = x[k], to[3 + k] = y[k];
    to[6 + k] = x[(k + 1) % 3] * y[(k + 2) % 3] - x[(k + 2) % 3] * y[(k + 1) % 3];
  }
}

std::vector<double> random_parameters(const OwnKernel& kernel, Random& random) {
  std::vector<double> numbers(static_cast<std::size_t>(kernel.parameter_size()));
  for (const OwnParameter& parameter : kernel.parameters) {
    double* const to = numbers.data() + parameter.offset;
    for (int k = 0; k < parameter.size; ++k) to[k] = random.number();
    const auto kind = static_cast<ParameterKind>(parameter.kind);
    if (kind == ParameterKind::scalar) {
      const double low = std::max(parameter.above, -2.), high = std::min(parameter.below, std::max(low, 0.) + 2);
      *to = low + (high - low) * (0.5 + 0.45 * *to);
    } else if (kind == ParameterKind::frame && parameter.size == 9) {
      write_triad(random, to);
    } else if (kind == ParameterKind::unit || kind == ParameterKind::frame) {
      double square = 0;
      for (int k = 0; k < parameter.size; ++k) square += to[k] * to[k];
      for (int k = 0; k < parameter.size; ++k) to[k] /= std::sqrt(square);
    }
  }
  return numbers;
}

planar::Pose<double> random_pose(Random& random, Planar<double>) {
  const double x = random.number(), y = random.number();
  return Planar<double>::pose(x, y, 3 * random.number());
}
spatial::Pose<double> random_pose(Random& random, Spatial<double>) {
  spatial::Place place{};
  place.x = random.number(), place.y = random.number(), place.z = random.number();
  spatial::Pose<double> pose = Spatial<double>::placed(place);
  const auto turn = [&] { return 2 * random.number(); };
  const double wx = turn(), wy = turn(), wz = turn();
  return Spatial<double>::moved(pose, {0, 0, 0, wx, wy, wz});
}

template <class S>
class Trial {
 public:
  Trial(const OwnKernel& kernel, Random& random)
      : kernel_(kernel), parameters_(random_parameters(kernel, random)), time_(random.number()) {
    for (int b = 0; b < kernel.bodies(); ++b) {
      q_.push_back(random_pose(random, S{}));
      double numbers[6];
      for (double& number : numbers) number = random.number();
      v_.push_back(S::read_velocity(numbers));
    }
  }

  std::vector<double> derived(const OwnBlock& block) const {
    const auto rows = static_cast<std::size_t>(block.rows());
    std::vector<double> C(rows), J(static_cast<std::size_t>(block.jacobian_size) + 1), rate(rows), C_t(rows);
    OwnArguments<double> in = at(q_, time_);
    run_own(block[OwnFunctionName::jacobian], in, C.data(), J.data());
    run_own(block[OwnFunctionName::time_derivative], in, C_t.data());
    in.velocity = reinterpret_cast<const double*>(v_.data()), in.jacobian = J.data();
    run_own(block[OwnFunctionName::velocity], in, rate.data());
    for (std::size_t r = 0; r < rows; ++r) rate[r] += C_t[r];
    return rate;
  }

  std::vector<double> by_differences(const OwnBlock& block) const {
    std::vector<double> after = moved(block, difference_step), before = moved(block, -difference_step);
    for (std::size_t r = 0; r < after.size(); ++r) after[r] = (after[r] - before[r]) / (2 * difference_step);
    return after;
  }

 private:
  OwnArguments<double> at(const std::vector<typename S::Pose>& q, const double& time) const {
    return {.pose = reinterpret_cast<const double*>(q.data()), .parameters = parameters_.data(), .time = &time};
  }
  std::vector<double> moved(const OwnBlock& block, double by) const {
    std::vector<typename S::Pose> q;
    for (std::size_t b = 0; b < q_.size(); ++b) q.push_back(S::moved(q_[b], S::sum({}, v_[b], by)));
    std::vector<double> C(static_cast<std::size_t>(block.rows()));
    const double time = time_ + by;
    run_own(block[OwnFunctionName::position], at(q, time), C.data());
    return C;
  }

  const OwnKernel& kernel_;
  std::vector<double> parameters_;
  double time_;
  std::vector<typename S::Pose> q_;
  std::vector<typename S::Velocity> v_;
};

template <class S>
std::string wrong_rate_in(const OwnKernel& kernel, const OwnBlock& block) {
  const auto rows = static_cast<std::size_t>(block.rows());
  std::vector<int> wrong(rows), judged(rows);
  std::vector<std::string> sample(rows);
  Random random;
  for (int k = 0; k < poses; ++k) {
    const Trial<S> trial(kernel, random);
    const std::vector<double> derived = trial.derived(block), differences = trial.by_differences(block);
    for (std::size_t r = 0; r < rows; ++r) {
      if (static_cast<RowKind>(block.row_kinds[r]) == RowKind::velocity) continue;
      const double off = std::abs(derived[r] - differences[r]), size = std::abs(derived[r]) + std::abs(differences[r]);
      if (!std::isfinite(off)) continue;
      ++judged[r];
      if (off <= tolerance * (1 + size)) continue;
      ++wrong[r];
      sample[r] = fmt::format("row {}: its derived rate is {:.6g}, central differences of C give {:.6g}",
                              block.row_names[r], derived[r], differences[r]);
    }
  }
  for (std::size_t r = 0; r < rows; ++r)
    if (2 * wrong[r] > judged[r]) return sample[r];
  return {};
}

// A law at random values, rates, parameters and a random time.
class LawTrial {
 public:
  LawTrial(const OwnKernel& kernel, Random& random)
      : law_(*kernel.law), parameters_(random_parameters(kernel, random)), time_(random.number()) {
    for (std::size_t r = 0; r < law_.acts.size(); ++r) C_.push_back(random.number()), rate_.push_back(random.number());
  }

  using Numbers = std::vector<double>;
  struct Pair {
    std::string what;
    double derived, by_differences;
  };
  // Every derived number beside its difference.
  std::vector<Pair> pairs() const {
    const std::size_t rows = C_.size();
    Numbers k(rows * rows), d(rows * rows);
    run_own(law_.slopes, at(C_, rate_), k.data(), d.data());
    std::vector<Pair> pairs;
    for (std::size_t c = 0; c < rows; ++c) {
      const Numbers by_C = slope(C_, c, [&](const Numbers& C) { return force(C, rate_); });
      const Numbers by_rate = slope(rate_, c, [&](const Numbers& rate) { return force(C_, rate); });
      for (std::size_t r = 0; r < rows; ++r) {
        pairs.push_back({fmt::format("stiffness {} {}", r + 1, c + 1), k[r * rows + c], -by_C[r]});
        pairs.push_back({fmt::format("damping {} {}", r + 1, c + 1), d[r * rows + c], -by_rate[r]});
      }
      if (!law_.energy.exists()) continue;
      const Numbers by_energy = slope(C_, c, [&](const Numbers& C) { return Numbers{energy(C)}; });
      pairs.push_back({fmt::format("stored force {}", c + 1), stored()[c], -by_energy[0]});
    }
    return pairs;
  }

 private:
  OwnArguments<double> at(const Numbers& C, const Numbers& rate) const {
    return {
        .parameters = parameters_.data(), .time = &time_, .C = C.data(), .rate = rate.data(), .effective_mass = &mass_};
  }
  Numbers force(const Numbers& C, const Numbers& rate) const {
    Numbers F(C.size());
    run_own(law_.force, at(C, rate), F.data());
    return F;
  }
  double energy(const Numbers& C) const {
    double E = 0;
    run_own(law_.energy, at(C, rate_), &E);
    return E;
  }
  Numbers stored() const {
    Numbers F = force(C_, rate_), unstored(C_.size());
    run_own(law_.unstored, at(C_, rate_), unstored.data());
    for (std::size_t r = 0; r < F.size(); ++r) F[r] -= unstored[r];
    return F;
  }
  template <class F>
  static Numbers slope(Numbers at, std::size_t c, F f) {
    const double middle = at[c];
    at[c] = middle + difference_step;
    Numbers slope = f(at);
    at[c] = middle - difference_step;
    const Numbers before = f(at);
    for (std::size_t r = 0; r < slope.size(); ++r) slope[r] = (slope[r] - before[r]) / (2 * difference_step);
    return slope;
  }

  const OwnLaw& law_;
  Numbers parameters_, C_, rate_;
  double time_, mass_ = 1.3;
};

}  // namespace

std::string wrong_law(const OwnKernel& kernel) {
  if (!kernel.law) return {};
  struct Count {
    int wrong = 0, judged = 0;
    std::string sample{};
  };
  std::map<std::string, Count> counts;
  Random random;
  for (int trial = 0; trial < poses; ++trial) {
    for (const auto& [what, derived, by_differences] : LawTrial(kernel, random).pairs()) {
      const double off = std::abs(derived - by_differences), size = std::abs(derived) + std::abs(by_differences);
      if (!std::isfinite(off)) continue;
      Count& count = counts[what];
      ++count.judged;
      if (off <= tolerance * (1 + size)) continue;
      ++count.wrong;
      count.sample =
          fmt::format("{}: derived it is {:.6g}, central differences give {:.6g}", what, derived, by_differences);
    }
  }
  for (const auto& [what, count] : counts)
    if (2 * count.wrong > count.judged) return count.sample;
  return {};
}

std::string wrong_rate(const OwnKernel& kernel) {
  const auto of = [&](const OwnBlock& block) {
    return kernel.dimension == 2 ? wrong_rate_in<Planar<double>>(kernel, block)
                                 : wrong_rate_in<Spatial<double>>(kernel, block);
  };
  std::string wrong = of(kernel.rows);
  for (const OwnBlock& coordinate : kernel.coordinates)
    if (wrong.empty()) wrong = of(coordinate);
  return wrong;
}

}  // namespace cdot
