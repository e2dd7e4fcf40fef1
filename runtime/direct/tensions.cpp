// The rows that tension adds to an island's system.
#include <algorithm>

#include <cdot/spaces.hpp>

#include "runtime/direct/system.hpp"

namespace cdot {

template <class S>
void System<S>::slacken() {
  for (const Block& tension : tensions) {
    const int numbers = tension.rows * S::freedom * tension.batch->ops->bodies;
    std::fill_n(jacobian_.begin() + tension.jacobian, numbers, 0.0);
    std::fill_n(weighted_.begin() + tension.jacobian, numbers, 0.0);
    std::fill_n(broken.begin() + tension.first, tension.rows, 1);
    std::fill_n(b.begin() + tension.first, tension.rows, 0.0);
  }
  taut_ = false;
}

template <class S>
void System<S>::follow(const System& other) {
  for (size_t k = 0; k < blocks.size(); ++k) {
    blocks[k].slot = other.blocks[k].slot;
    std::copy_n(other.broken.begin() + other.blocks[k].first, blocks[k].rows, broken.begin() + blocks[k].first);
  }
  for (size_t k = 0; k < tensions.size(); ++k) tensions[k].slot = blocks[static_cast<size_t>(tension_of_[k])].slot;
  std::fill(active_set_.begin(), active_set_.end(), free);
  ldlt_.forget();
}

template <class S>
void System<S>::tighten(const Block& tension, int row, const double* w, double stiffness) {
  const double soft = inverse(stiffness);
  if (!(soft > 0)) return;
  taut_ = true;
  broken[tension.first + row] = 0;
  softness[tension.first + row] = soft;
  const int width = S::freedom * tension.batch->ops->bodies;
  std::copy_n(w, width, jacobian_.data() + tension.jacobian + row * width);
}

template <class S>
void System<S>::load_tensions(const typename S::Velocity* velocity) {
  if (!taut_) return;
  each_tension_row([&](const Block& tension, int r, int row) {
    b[row] = 0;
    if (!velocity || broken[row]) return;
    const int bodies = tension.batch->ops->bodies;
    const Real* w = jacobian_.data() + tension.jacobian + r * S::freedom * bodies;
    for (int k = 0; k < bodies; ++k, w += S::freedom) {
      T v[S::freedom];
      S::write(velocity[tension.batch->body[tension.slot * bodies + k]], v);
      for (int c = 0; c < S::freedom; ++c) b[row] -= w[c] * Real(v[c]);
    }
  });
}

template <class S>
void System<S>::assemble_tensions(const Bodies<S>& all) {
  using Exact = typename S::Exact;
  if (!taut_) return;
  each_tension_row([&](const Block& tension, int r, int row) {
    if (broken[row]) return;
    const int bodies = tension.batch->ops->bodies, width = S::freedom * bodies;
    const Real* W = jacobian_.data() + tension.jacobian;
    Real* weighted = weighted_.data() + tension.jacobian + r * width;
    for (int k = 0; k < bodies; ++k) {
      const auto m = exact<typename Exact::InverseMass, T>(
          all.effective_mass[static_cast<size_t>(tension.batch->body[tension.slot * bodies + k])]);
      const int at = S::freedom * k;
      Exact::write(Exact::weighted(m, Exact::read_velocity(W + r * width + at)), weighted + at);
    }
    for (int s = 0; s <= r; ++s)
      for (int c = 0; c < width; ++c)
        ldlt_.values()[tension.own.at + r * tension.own.stride + s] += W[s * width + c] * weighted[c];
  });
}

template <class S>
void System<S>::pull(const Bodies<S>& all, typename S::Velocity* to) const {
  if (!taut_) return;
  each_tension_row([&](const Block& tension, int r, int row) {
    if (broken[row]) return;
    const int bodies = tension.batch->ops->bodies;
    const Real* weighted = weighted_.data() + tension.jacobian + r * S::freedom * bodies;
    for (int k = 0; k < bodies; ++k, weighted += S::freedom) {
      const int body = tension.batch->body[tension.slot * bodies + k];
      if (all.immovable(body)) continue;
      T moved[S::freedom];
      for (int c = 0; c < S::freedom; ++c) moved[c] = T(weighted[c] * lambda[row]);
      to[body] = S::sum(to[body], S::read_velocity(moved), T(1));
    }
  });
}

#define CDOT_INSTANTIATE(S) template class System<S>;
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
