// Signs of a body's columns or terms, and angular velocities along other axes.
#include "derive/diff/slips/slips.hpp"

namespace cdot::derive {
namespace {

// Of one body, or of all: columns of J, or the terms of velocities; all of them, those of v or those of w.
std::optional<Slip> wrong_sign(const Whole& whole) {
  const int width = whole.entry.width(), linear = whole.entry.joint.dimension;
  const auto& bodies = whole.entry.joint.bodies;
  for (int b = -1; b < static_cast<int>(bodies.size()); ++b)
    for (const auto& [v, w, of] :
         {std::tuple(true, true, "body "), std::tuple(true, false, "v_"), std::tuple(false, true, "w_")}) {
      const auto turned = [&, v = v, w = w](std::size_t pose) {
        List to = whole.generated[pose];
        for (int c = 0; c < whole.mine.columns; ++c)
          for (int r = 0; r < whole.mine.rows && (b < 0 || c / width == b); ++r)
            if (c % width < linear ? v : w) to[whole.at(r, c)] *= -1;
        return to;
      };
      const auto reversed = [&, v = v, w = w](Sample& sample) {
        for (std::size_t i = 0; i < bodies.size(); ++i)
          for (std::size_t k = 0; k < 3 && (b < 0 || static_cast<int>(i) == b); ++k) {
            if (v) sample.bodies[i].v[k] *= -1;
            if (w) sample.bodies[i].w[k] *= -1;
          }
      };
      if (whole.by_velocities ? !whole.is(turned) : !whole.at_changed(reversed)) continue;
      if (b < 0 && v && w) return Slip{"sign", "all of it has the wrong sign"};
      const std::string whose = b < 0 ? (v ? "v" : "w") : of + bodies[static_cast<std::size_t>(b)];
      return Slip{"sign",
                  fmt::format("the {} of {} have the wrong sign", whole.what == "J" ? "columns" : "terms", whose)};
    }
  return {};
}

// Of K: the terms with inertias, or those with masses; of all bodies, or of one.
std::optional<Slip> wrong_sign_of_terms(const Whole& whole) {
  if (whole.what != "K") return {};
  const auto& bodies = whole.entry.joint.bodies;
  for (std::size_t b = 0; b <= bodies.size(); ++b)
    for (const auto& [stem, words] : {std::pair("inv_I_", "inertias"), std::pair("inv_m_", "masses")}) {
      const std::string start = stem + (b < bodies.size() ? bodies[b] : "");
      const auto reversed = [&](Sample& sample) {
        for (auto& [name, value] : sample.scalars)
          if (name.starts_with(start)) value *= -1;
      };
      if (!whole.at_changed(reversed)) continue;
      return Slip{"sign", b < bodies.size()
                              ? fmt::format("the terms with the {} of {} have the wrong sign", words, bodies[b])
                              : fmt::format("the terms with {} have the wrong sign", words)};
    }
  return {};
}

}  // namespace

std::optional<Slip> slip_of_sign(const Whole& whole) {
  if (std::optional<Slip> found = wrong_sign(whole)) return found;
  return wrong_sign_of_terms(whole);
}

// Of J in space: the columns for angular velocities along other axes. w . v = w' . v' with w' = A^T w.
std::optional<Slip> slip_of_frame(const Whole& whole) {
  if (whole.what != "J" || whole.entry.joint.dimension == 2 || whole.entry.form == Form::euler) return {};
  const bool to_local = whole.entry.form == Form::global;
  const auto turned = [&](std::size_t pose) {
    List to = whole.generated[pose];
    for (int r = 0; r < whole.mine.rows; ++r)
      for (int c = 0; c < whole.mine.columns; c += 6) {
        const auto axes = axes_of(whole.samples()[pose].bodies[static_cast<std::size_t>(c / 6)].e);
        for (std::size_t i = 0; i < 3; ++i) {
          double& component = to[whole.at(r, c + 3) + i];
          component = 0;
          for (std::size_t k = 0; k < 3; ++k)
            component += (to_local ? axes[i][k] : axes[k][i]) * whole.generated[pose][whole.at(r, c + 3) + k];
        }
      }
    return to;
  };
  if (!whole.is(turned)) return {};
  return Slip{"frame", fmt::format("its columns of w are for angular velocities along the axes of {}: say `form {}`",
                                   to_local ? "the bodies" : "the world", to_local ? "local" : "global")};
}

}  // namespace cdot::derive
