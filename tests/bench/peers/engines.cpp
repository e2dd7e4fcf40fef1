// The registered engines, and the steps that all of them try.
#include <algorithm>
#include <cmath>

#include "tests/bench/peers/peer.hpp"

namespace cdot::peers {
namespace {

std::vector<Engine>& registered() {
  static std::vector<Engine> all;
  return all;
}

}  // namespace

Registration::Registration(Engine engine) {
  const auto rank = [](const Engine& e) { return std::pair{!e.name.starts_with("Cdot"), e.name}; };
  std::vector<Engine>& all = registered();
  const auto place =
      std::find_if(all.begin(), all.end(), [&](const Engine& other) { return rank(engine) < rank(other); });
  all.insert(place, std::move(engine));
}

const std::vector<Engine>& engines() { return registered(); }

namespace {

// The whole number of `coarsest` steps per interval between samples, half as many more, twice as many, and so on.
std::vector<double> two_per_halving(const Problem& problem, double steps_per_second) {
  const double interval = problem.duration / double(problem.times.size());
  const double coarsest =
      2 * std::ceil(interval * steps_per_second / 2);  // even, so 1.5 times as many is a whole number too
  std::vector<double> all{interval / coarsest};
  for (int halvings = 0; halvings <= 14; ++halvings)
    for (const double part : {1.5, 2.0}) all.push_back(interval / std::ldexp(part * coarsest, halvings));
  return all;
}

}  // namespace

std::vector<double> steps(const Problem& problem) { return two_per_halving(problem, 60); }

std::vector<double> fine_steps(const Problem& problem) { return two_per_halving(problem, 15); }

}  // namespace cdot::peers
