// Compares each function in T with the same function in 60 digits, both from the same numbers of T. J, K and F as
// inputs are those computed in T.
#include "tests/bench/ulp/measure.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "tests/bench/ulp/dual.hpp"
#include "tests/bench/ulp/exact.hpp"

namespace cdot::ulp {
namespace {

using dual::Dual;
using exact::Exact;

struct Sample {
  double error;
  std::size_t family;
};

template <class T>
double unit_in_last_place(double x) {
  constexpr int digits = std::numeric_limits<T>::digits;
  return std::ldexp(1.0, std::ilogb(std::fabs(x)) - digits + 1);
}

// An error without a correct digit counts as 1 / epsilon.
template <class T>
double in_units(double error, double of) {
  constexpr double no_digit = 1 / static_cast<double>(std::numeric_limits<T>::epsilon());
  if (error == 0) return 0;
  if (of == 0 || !std::isfinite(error)) return no_digit;
  return std::min(error / unit_in_last_place<T>(of), no_digit);
}

template <class To, class From>
Arguments<To> converted(const Arguments<From>& from) {
  Arguments<To> to;
  for (std::size_t piece = 0; piece < from.size(); ++piece) {
    for (const From& x : from[piece]) to[piece].push_back(To(x));
  }
  return to;
}

template <class T>
std::vector<T> call(const MeasuredFunction<T>& f, const Arguments<T>& in) {
  std::vector<T> out(f.outputs);
  f.many(&in, 1, out.data());
  return out;
}

template <class T>
const MeasuredFunction<T>* find(const MeasuredBlock<T>& block, Measured which) {
  for (const MeasuredFunction<T>& f : block.functions) {
    if (f.which == which) return &f;
  }
  return nullptr;
}

// The numbers of a sample in T; T computes J, K and F.
template <class T>
Arguments<T> arguments(const MeasuredBlock<T>& block, const Inputs& in) {
  Arguments<double> rounded;
  rounded[poses] = in.q, rounded[velocities] = in.v, rounded[masses] = in.m;
  rounded[isotropic_masses] = in.m_isotropic, rounded[parameters] = in.p;
  rounded[instant] = in.time, rounded[impulses] = in.lambda, rounded[right_side] = in.rhs;
  Arguments<T> a = converted<T>(rounded);
  for (const auto& [piece, which] : {std::pair{fields_of_J, Measured::jacobian},
                                     {mass_matrix, Measured::effective_mass},
                                     {factors, Measured::factor}}) {
    if (const MeasuredFunction<T>* const f = find(block, which)) a[piece] = call(*f, a);
  }
  return a;
}

// The natural scale of a function's results: their change if every input changes by its own size. Rounding the inputs
// already costs one unit of this scale. If a common shift of all bodies does not change a result, positions count by
// their distance from the bodies' middle, because differences of nearby positions are exact.
class Scale {
 public:
  Scale(const MeasuredBlock<Dual>& block, const MeasuredFunction<Dual>& f, const Arguments<Dual>& in)
      : block_(block), function_(f), in_(in), sum_(f.outputs, 0.0L) {
    for (const Piece piece : info(f.which).reads) {
      if (piece == poses) {
        add_poses();
      } else {
        for (std::size_t i = 0; i < in_[piece].size(); ++i) {
          add(slopes(piece, i), std::fabs(in_[piece][i].value));
        }
      }
    }
  }
  double of(std::size_t output) const { return static_cast<double>(sum_[output]); }

 private:
  std::vector<long double> slopes(Piece piece, std::size_t i) {
    in_[piece][i].slope = 1;
    const std::vector<Dual> out = call(function_, in_);
    in_[piece][i].slope = 0;
    std::vector<long double> slopes;
    for (const Dual& x : out) slopes.push_back(std::fabs(x.slope) > 0 ? x.slope : 0);
    return slopes;
  }
  void add(const std::vector<long double>& slopes, long double size) {
    for (std::size_t o = 0; o < sum_.size(); ++o) sum_[o] += std::fabs(slopes[o]) * size;
  }
  void add_poses() {
    const std::size_t size = block_.shape.pose(), count = in_[poses].size();
    const std::size_t dimension = block_.shape.planar() ? 2 : 3;
    for (std::size_t k = 0; k < size; ++k) {
      std::vector<std::vector<long double>> by_body;
      for (std::size_t i = k; i < count; i += size) by_body.push_back(slopes(poses, i));
      if (k < dimension) {
        add_positions(k, by_body);
      } else {
        for (std::size_t b = 0; b < by_body.size(); ++b) {
          add(by_body[b], std::fabs(in_[poses][size * b + k].value));
        }
      }
    }
  }
  void add_positions(std::size_t k, const std::vector<std::vector<long double>>& by_body) {
    const std::size_t size = block_.shape.pose(), bodies = by_body.size();
    long double middle = 0;
    for (std::size_t b = 0; b < bodies; ++b) middle += in_[poses][size * b + k].value;
    middle /= static_cast<long double>(bodies);
    for (std::size_t o = 0; o < sum_.size(); ++o) {
      long double together = 0, apart = 0;
      for (const auto& slopes : by_body) together += slopes[o], apart += std::fabs(slopes[o]);
      const bool shifts = std::fabs(together) > 1e-12L * apart;
      for (std::size_t b = 0; b < bodies; ++b) {
        const long double x = in_[poses][size * b + k].value - (shifts ? 0 : middle);
        sum_[o] += std::fabs(by_body[b][o] * x);
      }
    }
  }

  const MeasuredBlock<Dual>& block_;
  const MeasuredFunction<Dual>& function_;
  Arguments<Dual> in_;
  std::vector<long double> sum_;
};

// Whole turns are no error of an angle, because the reader counts turns.
double without_turns(double error) {
  constexpr double turn = 6.283185307179586;
  return std::fabs(error - turn) < 1e-2 ? std::fabs(error - turn) : error;
}

bool drops_a_row(const std::vector<double>& F, int rows) {
  for (int r = 0; r < rows; ++r) {
    if (F[static_cast<std::size_t>(r * (r + 3) / 2)] == 0) return true;
  }
  return false;
}

Spread spread(std::vector<Sample> samples) {
  if (samples.empty()) return {};
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.error < b.error; });
  const auto at = [&](double share) {
    return samples[static_cast<std::size_t>(share * static_cast<double>(samples.size() - 1))].error;
  };
  return {at(0.5), at(0.99), at(1), at(1) == 0 ? "" : family_names[samples.back().family]};
}

// The median over several runs, each long enough for the clock.
template <class T>
double nanoseconds(const MeasuredFunction<T>& f, const std::vector<Arguments<T>>& in) {
  using Clock = std::chrono::steady_clock;
  std::vector<T> out(f.outputs * in.size());
  std::vector<double> runs;
  for (int run = 0; run < 15; ++run) {
    const auto start = Clock::now();
    std::chrono::nanoseconds passed{};
    int repeats = 0;
    while (passed < std::chrono::microseconds(30)) {
      f.many(in.data(), in.size(), out.data()), ++repeats;
      passed = Clock::now() - start;
    }
    runs.push_back(static_cast<double>(passed.count()) / repeats / static_cast<double>(in.size()));
  }
  std::sort(runs.begin(), runs.end());
  return runs[runs.size() / 2];
}

struct Samples {
  std::vector<Sample> ulp, scale;
  int guarded = 0;
};

// One sample's errors in one function, appended. An impulse of exactly 0 belongs to a dropped row.
template <class T>
void compare(std::size_t index, std::size_t function, const Arguments<T>& in, std::size_t family, Samples& samples) {
  const MeasuredBlock<T>& block = measured_blocks<T>()[index];
  const MeasuredFunction<T>& f = block.functions[function];
  if (f.which == Measured::factor || f.which == Measured::factor_and_solve) {
    const std::vector<double> F(in[factors].begin(), in[factors].end());
    if (drops_a_row(F, block.shape.rows)) {
      ++samples.guarded;
      return;
    }
  }
  const std::vector<T> out = call(f, in);
  const bool impulse = f.which >= Measured::impulse_fast;
  if (impulse && std::count(out.begin(), out.end(), T(0)) > 0) {
    ++samples.guarded;
    return;
  }
  const MeasuredBlock<Exact>& exact_block = measured_blocks<Exact>()[block.shape.general];
  const MeasuredBlock<Dual>& slopes = measured_blocks<Dual>()[block.shape.general];
  const Measured truth = impulse ? Measured::impulse_balanced : f.which;  // the exact value of all forms
  const std::vector<Exact> expected = call(*find(exact_block, truth), converted<Exact>(in));
  const Scale scale(slopes, *find(slopes, truth), converted<Dual>(in));
  for (std::size_t o = 0; o < f.outputs; ++o) {
    const double exact_value = static_cast<double>(expected[o]);
    double error = std::isfinite(out[o]) ? std::fabs(static_cast<double>(Exact(out[o]) - expected[o]))
                                         : std::numeric_limits<double>::infinity();
    if (f.which == Measured::position) error = without_turns(error);
    samples.ulp.push_back({in_units<T>(error, exact_value), family});
    const double size = std::max(std::fabs(exact_value), scale.of(o));
    samples.scale.push_back({in_units<T>(error, size), family});
  }
}

}  // namespace

template <class T>
std::vector<Accuracy> measure(std::size_t index, int samples_per_family) {
  const MeasuredBlock<T>& block = measured_blocks<T>()[index];
  const MeasuredBlock<double>& in_double = measured_blocks<double>()[index];
  std::vector<Samples> samples(block.functions.size());
  std::vector<Arguments<T>> timed;
  for (std::size_t family = 0; family < families; ++family) {
    for (int i = 0; i < samples_per_family; ++i) {
      const Arguments<T> in =
          arguments(block, inputs_of(static_cast<Family>(family), block.shape, in_double.set_defaults,
                                     std::numeric_limits<T>::digits10, static_cast<std::uint32_t>(i + 1)));
      for (std::size_t f = 0; f < samples.size(); ++f) compare(index, f, in, family, samples[f]);
      if (family == 0 && timed.size() < 64) timed.push_back(in);
    }
  }
  std::vector<Accuracy> all;
  for (std::size_t f = 0; f < samples.size(); ++f) {
    all.push_back({spread(std::move(samples[f].ulp)), spread(std::move(samples[f].scale)),
                   nanoseconds(block.functions[f], timed), samples[f].guarded});
  }
  return all;
}

template std::vector<Accuracy> measure<float>(std::size_t, int);
template std::vector<Accuracy> measure<double>(std::size_t, int);

}  // namespace cdot::ulp
