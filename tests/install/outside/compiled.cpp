// A rod on a pin at its end falls from the horizontal: at the bottom w^2 = 3 g / l.
#include <cstdio>

#include "crane.hpp"

int main() {
  using Crane = cdot::scenes::crane<double>;
  Crane::State state;
  Crane::reset(state);
  double fastest = 0;
  for (int k = 0; k < 1000; ++k) {
    Crane::step(state);
    const double w = state.v[Crane::arm].w;
    if (w * w > fastest) fastest = w * w;
  }
  std::printf("compiled: w^2 = %.6f at the bottom\n", fastest);
  return fastest > 29.4299 && fastest < 29.4301 ? 0 : 1;
}
