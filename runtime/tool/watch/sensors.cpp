#include "runtime/tool/watch/sensors.hpp"

#include <array>

#include "runtime/state/add_rows.hpp"
#include "runtime/state/probe.hpp"
#include "runtime/state/world_data.hpp"

namespace cdot {
namespace {

template <class S>
double kinetic_energy(const BasicWorld<S>& world) {
  double sum = 0;
  for (int body = 0; body < world.body_count(); ++body) {
    if (world.is_static(body)) continue;
    const auto v = world.velocity(body);
    sum += 0.5 * double(S::dot(S::force(world.inverse_mass(body), v), v));
  }
  return sum;
}

// Force or torque of a coordinate's effects: their impulses of the last step by its length.
template <class S>
double force_of_effects(BasicWorld<S>& world, const Measured& m) {
  const WorldData<S>& data = world.data();
  const JointRecord& joint = data.joints[static_cast<std::size_t>(m.joint)];
  if (joint.broken || data.last_step <= 0) return 0;
  const auto coordinate = static_cast<std::size_t>(coordinate_index<S>(joint.type, m.coordinate_name));
  const BlockVariants<S>& rows = joint_entries<S>()[static_cast<std::size_t>(joint.type)].coordinates[coordinate];
  double sum = 0;
  for (const Place& place : joint.places) {
    const Batch<S>& batch = *data.batches[static_cast<std::size_t>(place.batch)];
    if (!rows.has(batch.ops) || (!m.effect.empty() && data.sources[batch.source] != m.effect)) continue;
    const auto i = static_cast<std::size_t>(slot_of(data, place) * batch.ops->rows);
    sum += (double(batch.lambda[i]) + double(batch.correction[i])) / data.last_step;
  }
  return sum;
}

template <class Wrench>
std::array<double, 6> numbers_of(const Wrench& w) {
  if constexpr (requires { w.force_z; }) return {w.force_x, w.force_y, w.force_z, w.torque_x, w.torque_y, w.torque_z};
  else return {w.force_x, w.force_y, 0, w.torque, 0, 0};
}

// Of the forces of a joint, or of an effect between bodies, on all its bodies: means over the last step, at the present
// velocities.
template <class S>
double power_of_joint(const BasicWorld<S>& world, int joint) {
  double power = 0;
  for (const int body : world.joint_bodies(joint)) {
    if (world.is_static(body)) continue;
    power += S::dot(S::components(world.reaction(joint, body)), world.velocity(body));
  }
  return power;
}

template <class S>
double measure(BasicWorld<S>& world, const Measured& m, int component) {
  switch (m.what) {
    case Measured::energy: return world.energy();
    case Measured::kinetic: return kinetic_energy(world);
    case Measured::coordinate: return world.coordinate(m.joint, m.coordinate_name);
    case Measured::rate: return world.coordinate_rate(m.joint, m.coordinate_name);
    case Measured::effects: return force_of_effects(world, m);
    case Measured::power: return force_of_effects(world, m) * world.coordinate_rate(m.joint, m.coordinate_name);
    case Measured::given: return power_of_joint(world, m.joint);
    case Measured::force:
    case Measured::torque: {
      const auto on = world.reaction(m.joint, world.joint_bodies(m.joint).back());
      return numbers_of(on)[static_cast<std::size_t>(component + (m.what == Measured::torque ? 3 : 0))];
    }
    case Measured::acceleration:
    case Measured::angular_acceleration: break;  // not of the World alone
  }
  return 0;
}

bool is_acceleration(const Measured& m) {
  return m.what == Measured::acceleration || m.what == Measured::angular_acceleration;
}

double acceleration(const Accelerations& of, const Measured& m, int component) {
  const int first = m.what == Measured::acceleration ? 0 : 3;
  return of[static_cast<std::size_t>(m.joint)][static_cast<std::size_t>(first + component)];
}

template <class S>
double state_number(const BasicWorld<S>& world, const Formula::Input& input) {
  using Of = Formula::Input::Of;
  if (input.of == Of::time) return world.time();
  const auto k = static_cast<std::size_t>(input.component);
  const auto p = world.place(input.index);
  const auto v = world.velocity(input.index);
  if constexpr (S::dimension == Dimension::planar) {
    const double position[] = {p.x, p.y}, velocity[] = {double(v.x), double(v.y)};
    const double axis[] = {double(world.pose(input.index).c), double(world.pose(input.index).s)};
    return input.of == Of::position   ? position[k]
           : input.of == Of::velocity ? velocity[k]
           : input.of == Of::axis     ? axis[k]
           : input.of == Of::spin     ? double(v.w)
                                      : p.angle;
  } else {
    const auto q = world.pose(input.index);
    const double position[] = {p.x, p.y, p.z}, velocity[] = {double(v.x), double(v.y), double(v.z)},
                 spin[] = {double(v.wx), double(v.wy), double(v.wz)};
    // By columns: axis x, then y, then z.
    const double axes[] = {double(q.xx), double(q.yx), double(q.zx), double(q.xy), double(q.yy),
                           double(q.zy), double(q.xz), double(q.yz), double(q.zz)};
    return input.of == Of::position   ? position[k]
           : input.of == Of::velocity ? velocity[k]
           : input.of == Of::axis     ? axes[k]
                                      : spin[k];
  }
}

}  // namespace

template <class S>
std::vector<double> sensor_values(const Scene& scene, BasicWorld<S>& world, const Accelerations& accelerations) {
  std::vector<double> values, inputs;
  for (const Sensor& sensor : scene.sensors) {
    inputs.clear();
    for (std::size_t k = 0; k < sensor.measured.size(); ++k) {
      const Formula::Input& input = sensor.formula.inputs()[k];
      const Measured& measured = sensor.measured[k];
      inputs.push_back(input.of != Formula::Input::quantity ? state_number(world, input)
                       : is_acceleration(measured)          ? acceleration(accelerations, measured, input.component)
                                                            : measure(world, measured, input.component));
    }
    values.push_back(sensor.formula(inputs));
  }
  return values;
}

#define CDOT_INSTANTIATE(S) \
  template std::vector<double> sensor_values(const Scene&, BasicWorld<S>&, const Accelerations&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
