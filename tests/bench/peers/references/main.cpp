// cdot-peers-reference: makes references/*.json, or checks them. A reference stands if both routes agree.
#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <stdexcept>

#include "tests/bench/peers/geometry.hpp"
#include "tests/bench/peers/problem.hpp"
#include "tests/bench/peers/references/route.hpp"

namespace {

using namespace cdot::peers;

constexpr long double tolerance = 1e-17L;
constexpr double agreement = 1e-11;  // [m], [rad]: largest difference of the routes

struct Difference {
  double place = 0, orientation = 0, rates = 0;
};

Difference difference(const Trajectory& a, const Trajectory& b) {
  Difference d;
  for (std::size_t k = 0; k < a.size(); ++k) {
    for (std::size_t i = 0; i < a[k].size(); ++i) {
      const State &s = a[k][i], &t = b[k][i];
      d.place = std::max(d.place, norm(s.x - t.x));
      d.orientation = std::max(d.orientation, angle_between(s.q, t.q));
      d.rates = std::max({d.rates, norm(s.v - t.v), norm(s.w - t.w)});
    }
  }
  return d;
}

template <std::size_t n>
std::string list(const std::array<double, n>& numbers) {
  std::string text;
  for (const double x : numbers) text += fmt::format(", {}", x);
  return text;
}

std::string json(const Problem& problem, const Trajectory& samples, const Difference& d) {
  std::string text = fmt::format(
      "{{\n  \"problem\": \"{}\",\n  \"scene\": \"specs/scenes/{}.toml\",\n"
      "  \"routes_differ_by\": {{\"place\": {:.0e}, \"orientation\": {:.0e}, \"rates\": {:.0e}}},\n"
      "  \"layout\": \"each body: x, y, z, e0, e1, e2, e3, vx, vy, vz, wx, wy, wz; SI units\",\n"
      "  \"samples\": [",
      problem.title, problem.scene, d.place, d.orientation, d.rates);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    text += fmt::format("{}\n    {{\"t\": {}, \"bodies\": {{", k ? "," : "", problem.times[k]);
    for (std::size_t i = 0; i < samples[k].size(); ++i) {
      const State& s = samples[k][i];
      const std::string numbers = list(s.x) + list(s.q) + list(s.v) + list(s.w);
      text += fmt::format("{}\n      \"{}\": [{}]", i ? "," : "", problem.bodies[i].name, numbers.substr(2));
    }
    text += "}}";
  }
  return text + "\n  ]\n}\n";
}

// True if the routes agree and, with `check`, the file agrees too.
bool handle(const ProblemRow& row, bool check) {
  const Problem problem = pose(row);
  const Trajectory one = maximal(problem, tolerance), other = minimal(problem, tolerance);
  const Difference d = difference(one, other);
  fmt::print("{:<18} routes differ by {:.1e} m, {:.1e} rad, {:.1e} in rates", row.name, d.place, d.orientation,
             d.rates);
  bool good = d.place < agreement && d.orientation < agreement;
  if (check) {
    const Difference kept = difference(load(row).reference, other);
    fmt::print("; the file by {:.1e} m, {:.1e} rad", kept.place, kept.orientation);
    good = good && kept.place < agreement && kept.orientation < agreement;
  } else if (good) {
    std::ofstream(reference_file(row.name)) << json(problem, other, d);
  }
  fmt::print("{}\n", good ? "" : "  TOO MUCH");
  std::fflush(stdout);
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 2 || (argc == 2 && std::strcmp(argv[1], "--check") != 0)) {
    fmt::print(stderr, "usage: cdot-peers-reference [--check]\n");
    return 2;
  }
  try {
    bool good = true;
    for (const ProblemRow& row : problem_rows()) good = handle(row, argc == 2) && good;
    return good ? 0 : 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
