// Where a distance vanishes that is known at some times, but not on which side it is there.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace cdot {

// Where a line passes 0: the time, and its slope.
struct Passing {
  double at, slope;
};

// The zero of the line through the distances at time(1), time(2), ..., which count negative before the smallest.
template <class Time>
Passing zero_beside_least(Time time, const std::vector<double>& distance) {
  const std::size_t n = distance.size() - 1;
  std::size_t least = 1;
  for (std::size_t j = 2; j <= n; ++j)
    if (distance[j] < distance[least]) least = j;
  const auto signed_distance = [&](std::size_t j) { return time(j) < time(least) ? -distance[j] : distance[j]; };
  double t_mean = 0, d_mean = 0, tt = 0, td = 0;
  for (std::size_t j = 1; j <= n; ++j) t_mean += time(j) / double(n), d_mean += signed_distance(j) / double(n);
  for (std::size_t j = 1; j <= n; ++j) {
    tt += (time(j) - t_mean) * (time(j) - t_mean);
    td += (time(j) - t_mean) * (signed_distance(j) - d_mean);
  }
  const double slope = td / tt;
  return {t_mean - d_mean / slope, slope};
}

// The zero of the line that fits the distances at time(0), time(1), ... best, those before some time, or all of them,
// taken as negative. Those near 0 count most, as the line is bent further away.
template <class Time>
Passing best_zero(Time time, const std::vector<double>& distance) {
  constexpr double least_weighed = 0.1;  // of the largest distance: smaller ones count no more
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::size_t n = distance.size();
  const double floor = least_weighed * *std::ranges::max_element(distance);
  const auto weight = [&](std::size_t j) { return std::pow(distance[j] + floor, -2); };
  Passing best{infinity, 0};
  double least_error = infinity;
  for (std::size_t split = 1; split <= n; ++split) {
    const double passed_at = split < n ? time(split) : infinity;
    const auto signed_distance = [&](std::size_t j) { return time(j) < passed_at ? -distance[j] : distance[j]; };
    double sum = 0, t_mean = 0, d_mean = 0, tt = 0, td = 0, dd = 0;
    for (std::size_t j = 0; j < n; ++j)
      sum += weight(j), t_mean += weight(j) * time(j), d_mean += weight(j) * signed_distance(j);
    t_mean /= sum, d_mean /= sum;
    for (std::size_t j = 0; j < n; ++j) {
      const double t = time(j) - t_mean, d = signed_distance(j) - d_mean;
      tt += weight(j) * t * t, td += weight(j) * t * d, dd += weight(j) * d * d;
    }
    const double slope = td / tt, error = dd - slope * td;
    if (error < least_error) least_error = error, best = {t_mean - d_mean / slope, slope};
  }
  return best;
}

}  // namespace cdot
