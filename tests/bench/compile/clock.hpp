// Times of steps that are taken by turns.
#pragma once

#include <algorithm>
#include <ctime>
#include <vector>

namespace cdot::bench {

// [s] of this thread.
inline double cpu_now() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

inline double median(std::vector<double> numbers) {
  std::sort(numbers.begin(), numbers.end());
  return numbers[numbers.size() / 2];
}

}  // namespace cdot::bench
