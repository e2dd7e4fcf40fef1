// Masses and inertias: their inverses, the wrong axes, and those that are missing.
#include <algorithm>
#include <functional>

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

using Chosen = std::function<bool(std::size_t body)>;

// slip(chosen, of) of all bodies first, then of each alone, as " of a".
template <class SlipOf>
std::optional<Slip> of_all_or_one(const Whole& whole, SlipOf slip) {
  if (std::optional<Slip> all = slip(Chosen([](std::size_t) { return true; }), "")) return all;
  const auto& bodies = whole.entry.joint.bodies;
  for (std::size_t b = 0; b < bodies.size() && bodies.size() > 1; ++b)
    if (std::optional<Slip> one = slip(Chosen([b](std::size_t body) { return body == b; }), " of " + bodies[b]))
      return one;
  return {};
}

template <class Changed>
void change_inertia(const Whole& whole, Sample& sample, const Chosen& chosen, Changed changed) {
  for (std::size_t b = 0; b < whole.entry.joint.bodies.size(); ++b) {
    if (!chosen(b)) continue;
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

void change_masses(const Whole& whole, Sample& sample, const Chosen& chosen, double (*changed)(double)) {
  for (std::size_t b = 0; b < whole.entry.joint.bodies.size(); ++b)
    if (const auto m = sample.scalars.find("inv_m_" + whole.entry.joint.bodies[b]);
        chosen(b) && m != sample.scalars.end())
      m->second = changed(m->second);
}

std::optional<Slip> masses(const Whole& whole) {
  const char* const inverse = whole.entry.joint.dimension == 2 ? "1/I" : "I^-1";
  return of_all_or_one(whole, [&](const Chosen& chosen, const std::string& of) -> std::optional<Slip> {
    const auto invert_masses = [&](Sample& sample) {
      change_masses(whole, sample, chosen, [](double m) { return 1 / m; });
    };
    const auto invert_inertia = [&](Sample& sample) {
      change_inertia(whole, sample, chosen, [](const List& I, std::size_t) { return inverted(I); });
    };
    if (whole.at_changed(invert_masses))
      return Slip{"inverse", of.empty() ? "masses m stand where 1/m belongs"
                                        : fmt::format("the mass m{} stands where 1/m belongs", of)};
    if (whole.at_changed(invert_inertia))
      return Slip{"inverse", of.empty() ? fmt::format("inertias I stand where {} belongs", inverse)
                                        : fmt::format("the inertia I{} stands where {} belongs", of, inverse)};
    if (whole.at_changed([&](Sample& sample) { invert_masses(sample), invert_inertia(sample); }))
      return Slip{"inverse", of.empty() ? "masses and inertias stand where their inverses belong: J M J^T in place of "
                                          "J M^-1 J^T"
                                        : fmt::format("mass and inertia{} stand where their inverses belong", of)};
    return {};
  });
}

// The terms with a mass or an inertia are missing, or stand without it; of one body, or of all.
std::optional<Slip> missing_masses(const Whole& whole) {
  const auto set = [&](Sample& sample, const Chosen& chosen, bool mass, bool present) {
    if (mass)
      return change_masses(
          whole, sample, chosen, present ? [](double) { return 1.0; } : [](double) { return 0.0; });
    for (std::size_t b = 0; b < whole.entry.joint.bodies.size(); ++b) {
      if (!chosen(b)) continue;
      const std::vector<std::string> names = tensor_names(whole, whole.entry.joint.bodies[b]);
      for (std::size_t k = 0; k < names.size(); ++k)
        if (const auto I = sample.scalars.find(names[k]); I != sample.scalars.end())
          I->second = present && k % 4 == 0 ? 1 : 0;
    }
  };
  return of_all_or_one(whole, [&](const Chosen& chosen, const std::string& of) -> std::optional<Slip> {
    for (const bool mass : {true, false})
      for (const bool present : {false, true}) {
        if (!whole.at_changed([&](Sample& sample) { set(sample, chosen, mass, present); })) continue;
        const char* const kind = mass ? (of.empty() ? "masses" : "mass") : (of.empty() ? "inertias" : "inertia");
        return Slip{"missing term",
                    present ? fmt::format("the inverse {}{} {} missing", kind, of, of.empty() ? "are" : "is")
                            : fmt::format("the terms with the inverse {}{} are missing", kind, of)};
      }
    return {};
  });
}

// Of W = A B A^T with B in the body's axes: B itself, or A^T W A in place of W where W is meant in body axes.
std::optional<Slip> turned_inertia(const Whole& whole) {
  if (whole.entry.joint.dimension == 2) return {};
  // R W R^T, or R^T W R
  const auto turned = [&](Sample& sample, const Chosen& chosen, int times) {
    change_inertia(whole, sample, chosen, [&](List W, std::size_t b) {
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
  return of_all_or_one(whole, [&](const Chosen& chosen, const std::string& of) -> std::optional<Slip> {
    if (whole.at_changed([&](Sample& sample) { turned(sample, chosen, 1); }))
      return Slip{"frame", fmt::format("the inertia{} is left in the axes of its body: A^T I^-1 A stands where I^-1 "
                                       "belongs",
                                       of)};
    if (whole.at_changed([&](Sample& sample) { turned(sample, chosen, 2); }))
      return Slip{"frame",
                  fmt::format("the inertia{} is turned to the wrong side: A^T I^-1 A in place of A I^-1 A^T", of)};
    return {};
  });
}

}  // namespace

std::optional<Slip> slip_of_masses(const Whole& whole) {
  return first_of({inverse, masses, missing_masses, turned_inertia}, whole);
}

}  // namespace cdot::derive
