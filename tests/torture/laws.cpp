#include "tests/torture/laws.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/jacobian.hpp>

#include "tests/torture/draw/in_time.hpp"
#include "tests/torture/draw/own_effects.hpp"
#include "tests/torture/pushes.hpp"

namespace cdot::torture {
namespace {

const JointType& type_of(const Scene& scene, const SceneJoint& joint) {
  return *find_joint_type(scene.dimension, joint.definition.type);
}

bool one_sided(const JointType& type) {
  return std::count(type.row_kinds.begin(), type.row_kinds.end(), RowKind::inequality) > 0;
}

// An effect of a spec is bounded, as a brake or a stop, or a force.
bool bounded(const JointType& effect) { return effect.row_kinds.empty(); }

bool bounded(const CoordinateEffects& effects) {
  return effects.limit || effects.motor || effects.friction ||
         std::any_of(effects.specs.begin(), effects.specs.end(),
                     [](const SpecEffect& spec) { return bounded(*find_coordinate_effect(spec.type)); });
}

bool immovable(const Scene& scene, int body) {
  return body == world_body || scene.bodies[static_cast<std::size_t>(body)].is_static;
}

// True if the joint has a static body or a parameter in the world.
bool holds_the_world(const Scene& scene, const SceneJoint& joint) {
  for (const int body : joint.definition.bodies)
    if (immovable(scene, body)) return true;
  for (const ParameterInfo& info : type_of(scene, joint).parameters)
    if (info.body < 0 && info.kind != ParameterKind::scalar) return true;
  return false;
}

bool pushed_from_outside(const Scene& scene) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(), [&](const SceneBody& body) {
    const auto pushed = [](const auto& d, double force, double torque) {
      return force != 0 || torque != 0 || d.linear_damping != 0 || d.angular_damping != 0;
    };
    const BodyDefinition& p = body.definition;
    const SpatialBodyDefinition& s = body.spatial;
    return pushed(p, std::hypot(p.force_x, p.force_y), p.torque) ||
           pushed(s, std::hypot(s.force_x, s.force_y, s.force_z), std::hypot(s.torque_x, s.torque_y, s.torque_z));
  });
}

bool is_free(const Scene& scene) {
  for (const SceneJoint& joint : scene.joints) {
    const JointType& type = type_of(scene, joint);
    if (holds_the_world(scene, joint) || (type.is_effect && type.bodies == 1)) return false;
  }
  for (const SpringDefinition& spring : scene.springs)
    if (immovable(scene, spring.body_a) || immovable(scene, spring.body_b)) return false;
  return !pushed_from_outside(scene);
}

// True if all rows allow a common rotation about the origin at the start. A gear against the ground does not.
template <class S>
bool turns_as_one(const Scene& scene) {
  BasicWorld<S> world = build_world_in<S>(scene);
  const SystemMatrix D = system_matrix(world);
  constexpr bool in_space = S::dimension == Dimension::spatial;
  for (int axis = in_space ? 0 : 2; axis < 3; ++axis) {
    std::vector<double> v;
    for (const int body : D.bodies) {
      const auto q = world.place(body);
      if constexpr (in_space) {
        const double w[3] = {axis == 0 ? 1.0 : 0, axis == 1 ? 1.0 : 0, axis == 2 ? 1.0 : 0};
        v.insert(v.end(),
                 {w[1] * q.z - w[2] * q.y, w[2] * q.x - w[0] * q.z, w[0] * q.y - w[1] * q.x, w[0], w[1], w[2]});
      } else {
        v.insert(v.end(), {-q.y, q.x, 1.0});
      }
    }
    for (int r = 0; r < D.rows; ++r) {
      double sum = 0, size = 0;
      for (int c = 0; c < D.columns; ++c) {
        const double term = D.entry(r, c) * v[static_cast<std::size_t>(c)];
        sum += term, size += std::abs(term);
      }
      if (std::abs(sum) > 1e-7 * size) return false;
    }
  }
  return true;
}

bool has_damping(const Softness& s) { return s.damping_ratio != 0 || s.damping != 0; }

// Sources and sinks of energy in a scene.
struct Exchange {
  bool gives = false, takes = false;
  // A spring by frequency changes its stiffness with the pose, so its force has no potential.
  void spring(const Softness& s) { gives |= s.by_frequency, takes |= has_damping(s); }
};

void add_effect(const JointType& type, Exchange& exchange) {
  const bool any = bounded(type) || type.without_energy;
  exchange.gives |= any || type.explicit_time, exchange.takes |= any;
}

void add_effects(const CoordinateEffects& effects, Exchange& exchange) {
  for (const SpecEffect& spec : effects.specs) add_effect(*find_coordinate_effect(spec.type), exchange);
  exchange.gives |= effects.motor && effects.motor->speed != 0;
  exchange.takes |= effects.motor || effects.limit || effects.friction;
  for (const CoordinateSpring& spring : effects.springs) exchange.spring(spring.softness);
}

Exchange exchange_of(const Scene& scene) {
  Exchange exchange;
  for (const SceneBody& body : scene.bodies) {
    const auto damped = [](const auto& d) { return d.linear_damping != 0 || d.angular_damping != 0; };
    exchange.takes |= damped(body.definition) || damped(body.spatial);
    const SpatialBodyDefinition& s = body.spatial;
    exchange.gives |= s.torque_x != 0 || s.torque_y != 0 || s.torque_z != 0;  // without potential
  }
  for (const SceneJoint& joint : scene.joints) {
    const JointType& type = type_of(scene, joint);
    exchange.gives |= type.explicit_time;
    if (type.is_effect) add_effect(type, exchange);
    exchange.takes |= one_sided(type) || !joint.bonds.empty();
    if (joint.definition.soft) {
      exchange.spring(*joint.definition.soft);
      exchange.takes |= std::count(type.row_kinds.begin(), type.row_kinds.end(), RowKind::velocity) > 0;
    }
    for (const CoordinateEffects& effects : joint.effects) add_effects(effects, exchange);
  }
  for (const SpringDefinition& spring : scene.springs) exchange.takes |= spring.damping != 0;
  exchange.takes |= scene.settings.sleep_after > 0;
  exchange.gives |= has_numbers_in_time(scene);
  return exchange;
}

// A body with fixed rotation absorbs every torque.
bool takes_torque(const Scene& scene) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const SceneBody& body) {
    return body.definition.fixed_rotation || body.spatial.fixed_rotation;
  });
}

// Each soft row acts along its own direction; with several rows the force need not be along the stretch.
bool has_soft_rows(const Scene& scene) {
  return std::any_of(scene.joints.begin(), scene.joints.end(),
                     [](const SceneJoint& joint) { return joint.definition.soft.has_value(); });
}

bool is_smooth(const Scene& scene) {
  return std::none_of(scene.joints.begin(), scene.joints.end(), [&](const SceneJoint& joint) {
    const JointType& type = type_of(scene, joint);
    if (one_sided(type) || !joint.bonds.empty() || (type.is_effect && bounded(type))) return true;
    return std::any_of(joint.effects.begin(), joint.effects.end(),
                       [](const CoordinateEffects& effects) { return bounded(effects); });
  });
}

// True if time, a motor of unlimited force or rolling prescribes velocities.
bool prescribes_motion(const Scene& scene) {
  return std::any_of(scene.joints.begin(), scene.joints.end(), [&](const SceneJoint& joint) {
    const JointType& type = type_of(scene, joint);
    if ((type.explicit_time || moves_in_time(joint)) && !type.is_effect) return true;
    if (std::count(type.row_kinds.begin(), type.row_kinds.end(), RowKind::velocity) > 0) return true;
    return std::any_of(joint.effects.begin(), joint.effects.end(), [](const CoordinateEffects& effects) {
      return effects.motor && effects.motor->max_force == unlimited;
    });
  });
}

// True if the scene has ropes, limits, bodies with fixed rotation or a loop: a joint between bodies that are already
// connected. All static bodies count as one.
bool may_stop_a_motion(const Scene& scene) {
  if (takes_torque(scene)) return true;
  std::vector<int> group(scene.bodies.size() + 1);
  for (std::size_t k = 0; k < group.size(); ++k) group[k] = static_cast<int>(k);
  const auto node = [&](int body) { return immovable(scene, body) ? std::size_t(0) : std::size_t(body + 1); };
  for (const SceneJoint& joint : scene.joints) {
    const JointType& type = type_of(scene, joint);
    if (type.is_effect && !bounded(type)) continue;
    if (one_sided(type) || type.is_effect) return true;
    for (const CoordinateEffects& effects : joint.effects)
      if (effects.limit || !effects.specs.empty()) return true;
    std::vector<int> bodies = joint.definition.bodies;
    const bool of_the_world = std::any_of(bodies.begin(), bodies.end(), [&](int body) { return node(body) == 0; });
    if (!of_the_world && holds_the_world(scene, joint)) bodies.push_back(world_body);  // by a point, as `target`
    for (std::size_t k = 1; k < bodies.size(); ++k) {
      const int from = group[node(bodies[k])], to = group[node(bodies[0])];
      if (from == to) return true;
      std::replace(group.begin(), group.end(), from, to);
    }
  }
  return false;
}

// The largest 1 / m and 1 / I of a body.
struct Lightness {
  double pull = 0, turn = 0;
};
Lightness lightness_of(const Scene& scene, const std::vector<int>& bodies, double length) {
  Lightness sum;
  for (const int index : bodies) {
    if (immovable(scene, index)) continue;
    const SceneBody& body = scene.bodies[static_cast<std::size_t>(index)];
    const bool planar = scene.dimension == Dimension::planar;
    const Inertia& I = body.spatial.inertia;
    // trace(I^-1) <= 3 / least moment, and the least moment >= det / (trace / 2)^2.
    const double det =
        I.xx * (I.yy * I.zz - I.yz * I.yz) - I.xy * (I.xy * I.zz - I.yz * I.xz) + I.xz * (I.xy * I.yz - I.yy * I.xz);
    const double half = (I.xx + I.yy + I.zz) / 2;
    const double inertia = planar ? body.definition.inertia : half > 0 ? det / (half * half) : 0;
    const double turn = inertia > 0 ? 1 / inertia : 0;
    sum.turn += turn;
    sum.pull += 1 / (planar ? body.definition.mass : body.spatial.mass) + length * length * turn;
  }
  return sum;
}

bool stiff(const Softness& s, double inverse_mass, double h) {
  if (s.by_frequency) return h * 6.3 * s.frequency * std::max(1.0, s.damping_ratio) > 2;
  return h * h * s.stiffness * inverse_mass > 4 || h * s.damping * inverse_mass > 2;
}

}  // namespace

double lightness(const Scene& scene, const std::vector<int>& bodies, double length) {
  return lightness_of(scene, bodies, length).pull;
}

bool stiff(const Scene& scene, double step, double length) {
  for (const SceneJoint& joint : scene.joints) {
    const Lightness light = lightness_of(scene, joint.definition.bodies, length);
    const double any = std::max(light.pull, light.turn);
    if (joint.definition.soft && stiff(*joint.definition.soft, any, step)) return true;
    for (const CoordinateEffects& effects : joint.effects)
      for (const CoordinateSpring& spring : effects.springs)
        if (stiff(spring.softness, any, step)) return true;
  }
  for (const SpringDefinition& spring : scene.springs) {
    const double pull = lightness(scene, {spring.body_a, spring.body_b}, length);
    if (step * step * spring.stiffness * pull > 4 || step * spring.damping * pull > 2) return true;
  }
  for (const SceneBody& body : scene.bodies)
    for (const double damping : {body.definition.linear_damping, body.definition.angular_damping,
                                 body.spatial.linear_damping, body.spatial.angular_damping})
      if (step * damping > 2) return true;
  return false;
}

Laws laws_of(const Scene& scene) {
  Laws laws;
  const Exchange exchange = exchange_of(scene);
  laws.energy_kept = !exchange.gives && !exchange.takes;
  laws.energy_falls = !exchange.gives;
  laws.smooth = is_smooth(scene);
  laws.may_contradict = prescribes_motion(scene) && may_stop_a_motion(scene);
  const bool leaps = has_late_ends(scene);  // poses change without a motion
  if (leaps) laws.energy_kept = laws.energy_falls = laws.smooth = false;
  if (scene.settings.sleep_after > 0 || !is_free(scene)) return laws;
  const double g[3] = {scene.settings.gravity_x, scene.settings.gravity_y, scene.settings.gravity_z};
  const bool planar = scene.dimension == Dimension::planar;
  const bool turns = !leaps && !has_soft_rows(scene) && !takes_torque(scene) &&
                     (planar ? turns_as_one<Planar<double>>(scene) : turns_as_one<Spatial<double>>(scene));
  for (std::size_t k = 0; k < 3; ++k) {
    laws.linear[k] = g[k] == 0 && !(planar && k == 2);
    laws.angular[k] = turns && g[(k + 1) % 3] == 0 && g[(k + 2) % 3] == 0 && !(planar && k != 2);
  }
  return laws;
}

double operations_of(const Scene& scene) {
  std::vector<int> rows(scene.bodies.size() + 1, 1);
  for (const SceneJoint& joint : scene.joints)
    for (const int body : joint.definition.bodies)
      rows[static_cast<std::size_t>(body + 1)] +=
          static_cast<int>(find_joint_type(scene.dimension, joint.definition.type)->row_kinds.size()) + 1;
  const Settings& s = scene.settings;
  const double stages = s.integrator == Integrator::dop853 ? 12 : s.integrator == Integrator::rk4 ? 4 : 2;
  const double sweeps = s.solver == Solver::iterative ? 3 * s.iterations : 10;
  return *std::max_element(rows.begin(), rows.end()) * stages * sweeps * s.substeps;
}

Scene without_forces(const Scene& scene) {
  Scene rows = scene;
  std::erase_if(rows.joints, [&](const SceneJoint& joint) {
    const JointType& type = type_of(scene, joint);
    return type.is_effect && !bounded(type);
  });
  return rows;
}

double heaviest_over_lightest(const Scene& scene) {
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const SceneBody& body : scene.bodies) {
    if (body.is_static) continue;
    const double mass = mass_of(scene, body);
    least = std::min(least, mass), most = std::max(most, mass);
  }
  return most > 0 ? most / least : 1;
}

}  // namespace cdot::torture
