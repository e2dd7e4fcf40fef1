#include "tests/torture/shrink.hpp"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <functional>

#include "tests/torture/numbers.hpp"

namespace cdot::torture {
namespace {

using Change = std::function<void(Scene&)>;

// Removes a body and everything attached to it.
void remove_body(Scene& scene, int body) {
  const auto uses = [&](const std::vector<int>& bodies) { return std::count(bodies.begin(), bodies.end(), body) > 0; };
  std::erase_if(scene.joints, [&](const SceneJoint& joint) { return uses(joint.definition.bodies); });
  std::erase_if(scene.springs, [&](const SpringDefinition& s) { return s.body_a == body || s.body_b == body; });
  scene.bodies.erase(scene.bodies.begin() + body);
  const auto moved = [&](int& index) { index -= index > body; };
  for (SceneJoint& joint : scene.joints)
    for (int& index : joint.definition.bodies) moved(index);
  for (SpringDefinition& spring : scene.springs) moved(spring.body_a), moved(spring.body_b);
}

auto rounder(int digits) {
  return [digits](double& x) { x = std::strtod(fmt::format("{:.{}e}", x, digits - 1).c_str(), nullptr) + 0.0; };
}

// Rounds the settings but keeps the number of steps.
void round_settings(Scene& scene, int digits) {
  const int steps = steps_of(scene);
  each_number_of_settings(scene, rounder(digits));
  scene.duration = steps * scene.step;
}

class Shrinker {
 public:
  Shrinker(const Scene& scene, const Verdict& verdict, const Judge& judge, int most_tries)
      : judge_(judge), most_tries_(most_tries), best_{scene, verdict, 0} {}

  Shrunk run() {
    for (bool smaller = true; smaller && best_.tries < most_tries_;) {
      smaller = false;
      for (const auto pass :
           {&Shrinker::fewer_steps, &Shrinker::fewer_bodies, &Shrinker::fewer_joints, &Shrinker::fewer_effects,
            &Shrinker::fewer_functions, &Shrinker::plainer_settings, &Shrinker::plainer_bodies})
        smaller |= (this->*pass)();
    }
    rounder_numbers();
    fewer_steps();
    return std::move(best_);
  }

 private:
  // Applies the change if the same invariant still breaks.
  bool attempt(const Change& change) {
    if (best_.tries >= most_tries_) return false;
    Scene scene = best_.scene;
    change(scene);
    ++best_.tries;
    const Verdict seen = judge_(scene);
    if (!seen.broken() || seen.what != best_.verdict.what) return false;
    best_.scene = std::move(scene), best_.verdict = seen;
    return true;
  }
  // From last to first, so indices stay valid after a removal.
  bool each(std::size_t count, const std::function<void(Scene&, std::size_t)>& change) {
    bool smaller = false;
    for (std::size_t k = count; k-- > 0;) smaller |= attempt([&](Scene& scene) { change(scene, k); });
    return smaller;
  }

  bool fewer_steps() {
    const int steps = steps_of(best_.scene);
    const auto end_after = [](int count) { return [count](Scene& scene) { scene.duration = count * scene.step; }; };
    const int seen = best_.verdict.step;
    if (seen > 0 && seen < steps && attempt(end_after(seen))) return true;
    return steps > 1 && (attempt(end_after(steps / 4 + 1)) || attempt(end_after(steps / 2)));
  }
  bool fewer_bodies() {
    return best_.scene.bodies.size() > 1 &&
           each(best_.scene.bodies.size(), [](Scene& s, std::size_t k) { remove_body(s, static_cast<int>(k)); });
  }
  bool fewer_joints() {
    const bool joints =
        each(best_.scene.joints.size(), [](Scene& s, std::size_t k) { s.joints.erase(s.joints.begin() + long(k)); });
    const bool springs =
        each(best_.scene.springs.size(), [](Scene& s, std::size_t k) { s.springs.erase(s.springs.begin() + long(k)); });
    return joints || springs;
  }
  bool fewer_effects() {
    bool smaller = false;
    for (std::size_t j = 0; j < best_.scene.joints.size(); ++j) {
      if (best_.scene.joints[j].definition.soft)
        smaller |= attempt([&](Scene& s) { s.joints[j].definition.soft.reset(); });
      if (!best_.scene.joints[j].bonds.empty()) smaller |= attempt([&](Scene& s) { s.joints[j].bonds.clear(); });
      smaller |= each(best_.scene.joints[j].effects.size(), [&](Scene& s, std::size_t k) {
        s.joints[j].effects.erase(s.joints[j].effects.begin() + long(k));
      });
      for (std::size_t e = 0; e < best_.scene.joints[j].effects.size(); ++e)
        smaller |= each(best_.scene.joints[j].effects[e].specs.size(), [&](Scene& s, std::size_t k) {
          auto& specs = s.joints[j].effects[e].specs;
          specs.erase(specs.begin() + long(k));
        });
    }
    return smaller;
  }
  // Of time.
  bool fewer_functions() {
    bool smaller = false;
    for (std::size_t j = 0; j < best_.scene.joints.size(); ++j) {
      std::size_t count = 0, kept = 0;
      each_value(best_.scene.joints[j], [&](const NamedValue& value) { count += !value.in_time.empty(); });
      while (kept < count) {
        const bool gone = attempt([&](Scene& s) {
          std::size_t seen = 0;
          each_value(s.joints[j], [&](NamedValue& value) {
            if (!value.in_time.empty() && seen++ == kept) value.in_time.clear();
          });
        });
        smaller |= gone;
        gone ? --count : ++kept;
      }
    }
    return smaller;
  }
  bool plainer_settings() {
    const Settings usual;
    bool smaller = false;
    const auto set = [&](auto member, auto value) {
      if (best_.scene.settings.*member != value) smaller |= attempt([&](Scene& s) { s.settings.*member = value; });
    };
    set(&Settings::drift, usual.drift);
    set(&Settings::kernels, usual.kernels);
    set(&Settings::substeps, usual.substeps);
    set(&Settings::iterations, usual.iterations);
    set(&Settings::baumgarte, usual.baumgarte);
    set(&Settings::warm_start, usual.warm_start);
    set(&Settings::local_error, 0.0);
    set(&Settings::sleep_after, 0.0);
    for (const auto axis : {&Settings::gravity_x, &Settings::gravity_y, &Settings::gravity_z}) set(axis, 0.0);
    if (best_.scene.on_failure != OnFailure::stop) smaller |= attempt([](Scene& s) { s.on_failure = OnFailure::stop; });
    if (best_.scene.single) smaller |= attempt([](Scene& s) { s.single = false; });
    return smaller;
  }
  bool plainer_bodies() {
    bool smaller = false;
    for (std::size_t k = 0; k < best_.scene.bodies.size(); ++k) {
      const auto zero = [&](auto... members) {
        auto& planar = best_.scene.bodies[k].definition;
        if ((... || (planar.*members != 0)))
          smaller |= attempt([&](Scene& s) { ((s.bodies[k].definition.*members = 0), ...); });
      };
      const auto zero_in_space = [&](auto... members) {
        auto& spatial = best_.scene.bodies[k].spatial;
        if ((... || (spatial.*members != 0)))
          smaller |= attempt([&](Scene& s) { ((s.bodies[k].spatial.*members = 0), ...); });
      };
      using P = BodyDefinition;
      using V = SpatialBodyDefinition;
      zero(&P::vx, &P::vy), zero(&P::w), zero(&P::force_x, &P::force_y, &P::torque);
      zero(&P::linear_damping, &P::angular_damping);
      zero_in_space(&V::vx, &V::vy, &V::vz), zero_in_space(&V::wx, &V::wy, &V::wz);
      zero_in_space(&V::force_x, &V::force_y, &V::force_z, &V::torque_x, &V::torque_y, &V::torque_z);
      zero_in_space(&V::linear_damping, &V::angular_damping), zero_in_space(&V::e1, &V::e2, &V::e3);
    }
    return smaller;
  }
  void rounder_numbers() {
    for (const int digits : {1, 2, 3, 4, 6})
      if (attempt([&](Scene& s) { round_settings(s, digits), each_number(s, rounder(digits)); })) break;
    for (const int digits : {1, 2, 3}) {
      attempt([&](Scene& s) { round_settings(s, digits); });
      const auto round = rounder(digits);
      each(best_.scene.bodies.size(), [&](Scene& s, std::size_t k) {
        each_number(s.bodies[k].definition, round), each_number(s.bodies[k].spatial, round);
      });
      each(best_.scene.joints.size(), [&](Scene& s, std::size_t k) { each_number(s.joints[k], round); });
      each(best_.scene.springs.size(), [&](Scene& s, std::size_t k) { each_number(s.springs[k], round); });
    }
  }

  const Judge& judge_;
  int most_tries_;
  Shrunk best_;
};

}  // namespace

Shrunk shrink(const Scene& scene, const Verdict& verdict, const Judge& judge, int most_tries) {
  return Shrinker(scene, verdict, judge, most_tries).run();
}

}  // namespace cdot::torture
