// Masses and inertias: their inverses, the wrong axes, and those that are missing.
#include <algorithm>

#include "derive/diff/slips/slips.hpp"

namespace cdot::derive {
namespace {

std::vector<std::string> tensor_names(const Whole& whole, const std::string& body) {
  if (whole.entry.joint.dimension == 2) return {"inv_I_" + body};
  std::vector<std::string> names;
  for (const char* ij : {"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"}) {
    std::string key(ij);
    std::sort(key.begin(), key.end());
    names.push_back("inv_I_" + body + "_" + key);
  }
  return names;
}
// The inverse inertia of a body, 1 or 9 numbers; empty if nothing here depends on it.
List inverse_inertia(const Whole& whole, const Sample& sample, const std::string& body) {
  List numbers;
  for (const std::string& name : tensor_names(whole, body)) {
    const auto found = sample.scalars.find(name);
    if (found == sample.scalars.end()) return {};
    numbers.push_back(found->second);
  }
  return numbers;
}
template <class Changed>
void change_inertia(const Whole& whole, Sample& sample, Changed changed) {
  for (std::size_t b = 0; b < whole.entry.joint.bodies.size(); ++b) {
    const std::string& body = whole.entry.joint.bodies[b];
    const List before = inverse_inertia(whole, sample, body);
    if (before.empty()) continue;
    const List after = changed(before, b);
    const std::vector<std::string> names = tensor_names(whole, body);
    for (std::size_t k = 0; k < names.size(); ++k) sample.scalars[names[k]] = after[k];
  }
}
std::optional<Slip> inverse(const Whole& whole) {
  if (whole.what != "K" || !whole.is([&](std::size_t pose) { return inverted(whole.generated[pose]); })) return {};
  return Slip{"inverse", "this is K^-1, the inverse of K"};
}

std::optional<Slip> masses(const Whole& whole) {
  const auto invert_masses = [&](Sample& sample) {
    for (const std::string& body : whole.entry.joint.bodies)
      if (const auto m = sample.scalars.find("inv_m_" + body); m != sample.scalars.end()) m->second = 1 / m->second;
  };
  const auto invert_inertia = [&](Sample& sample) {
    change_inertia(whole, sample, [](const List& I, std::size_t) { return inverted(I); });
  };
  if (whole.at_changed(invert_masses)) return Slip{"inverse", "masses m stand where 1/m belongs"};
  if (whole.at_changed(invert_inertia))
    return Slip{"inverse", whole.entry.joint.dimension == 2 ? "inertias I stand where 1/I belongs"
                                                            : "inertias I stand where I^-1 belongs"};
  if (whole.at_changed([&](Sample& sample) { invert_masses(sample), invert_inertia(sample); }))
    return Slip{"inverse", "masses and inertias stand where their inverses belong: J M J^T in place of J M^-1 J^T"};
  return {};
}

// The terms with a mass or an inertia are missing, or stand without it; of one body, or of all.
std::optional<Slip> missing_masses(const Whole& whole) {
  const auto& bodies = whole.entry.joint.bodies;
  const auto set = [&](Sample& sample, std::size_t only, bool mass, double diagonal) {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (only < bodies.size() && b != only) continue;
      const auto m = sample.scalars.find("inv_m_" + bodies[b]);
      if (mass && m != sample.scalars.end()) m->second = diagonal;
      const std::vector<std::string> names = mass ? std::vector<std::string>{} : tensor_names(whole, bodies[b]);
      for (std::size_t k = 0; k < names.size(); ++k)
        if (const auto I = sample.scalars.find(names[k]); I != sample.scalars.end())
          I->second = k % 4 == 0 ? diagonal : 0;
    }
  };
  for (std::size_t b = 0; b <= bodies.size(); ++b)
    for (const bool mass : {true, false})
      for (const double diagonal : {0.0, 1.0}) {
        const std::size_t only = b == 0 ? bodies.size() : b - 1;  // all first
        if (!whole.at_changed([&](Sample& sample) { set(sample, only, mass, diagonal); })) continue;
        const std::string of = b == 0 ? "" : " of " + bodies[only];
        const char* const kind = mass ? (b == 0 ? "masses" : "mass") : (b == 0 ? "inertias" : "inertia");
        return Slip{"missing term", diagonal == 0
                                        ? fmt::format("the terms with the inverse {}{} are missing", kind, of)
                                        : fmt::format("the inverse {}{} {} missing", kind, of, b == 0 ? "are" : "is")};
      }
  return {};
}

// Of W = A B A^T with B in the body's axes: B itself, or A^T W A in place of W where W is meant in body axes.
std::optional<Slip> turned_inertia(const Whole& whole) {
  if (whole.entry.joint.dimension == 2) return {};
  // R W R^T, or R^T W R
  const auto turned = [&](Sample& sample, int times) {
    change_inertia(whole, sample, [&](List W, std::size_t b) {
      const auto axes = axes_of(sample.bodies[b].e);  // columns of A
      for (int t = 0; t < times; ++t) {
        List next(9);
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t j = 0; j < 3; ++j)
            for (std::size_t k = 0; k < 3; ++k)
              for (std::size_t l = 0; l < 3; ++l) next[3 * i + j] += axes[i][k] * W[3 * k + l] * axes[j][l];
        W = next;
      }
      return W;
    });
  };
  if (whole.at_changed([&](Sample& sample) { turned(sample, 1); }))
    return Slip{"frame", "the inertia is left in the axes of its body: A^T I^-1 A stands where I^-1 belongs"};
  if (whole.at_changed([&](Sample& sample) { turned(sample, 2); }))
    return Slip{"frame", "the inertia is turned to the wrong side: A^T I^-1 A in place of A I^-1 A^T"};
  return {};
}

}  // namespace

std::optional<Slip> slip_of_masses(const Whole& whole) {
  return first_of({inverse, masses, missing_masses, turned_inertia}, whole);
}

}  // namespace cdot::derive
