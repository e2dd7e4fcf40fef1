// Names and numbers of Python -> calls of a World, and back.
#include "derive/python/world.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <utility>

#include "derive/python/keywords.hpp"
#include "runtime/own/own.hpp"
#include "runtime/state/world_data.hpp"
#include "runtime/tool/run/pick_integrator.hpp"
#include "runtime/tool/run/simulate.hpp"

namespace cdot::python {
namespace {

constexpr const char* ground_name = "world";
constexpr double live_step = 1.0 / 240;  // [s] of a scene that asks for an accuracy instead of a method and a step

// A scene that asks for an accuracy gets a method for short equal steps.
Scene with_steps(Scene scene) {
  if (!chooses_method(scene)) return with_integrator(std::move(scene));
  scene.accuracy = 0, scene.settings.local_error = 0, scene.names_integrator = false;
  scene.step = live_step;
  settle_drift(scene);
  return with_integrator(std::move(scene));
}

py::dict named_numbers(const auto& infos, const auto& number_of) {
  py::dict all;
  for (const auto& info : infos) all[py::str(info.name.data(), info.name.size())] = number_of(info);
  return all;
}

template <class S>
typename S::Place place_of_numbers(const double* n) {
  if constexpr (S::dimension == Dimension::planar) return {n[0], n[1], n[2]};
  else return {n[0], n[1], n[2], n[3], n[4], n[5], n[6]};
}

template <class S>
void write_place(const typename S::Place& p, double* to) {
  if constexpr (S::dimension == Dimension::planar) to[0] = p.x, to[1] = p.y, to[2] = p.angle;
  else to[0] = p.x, to[1] = p.y, to[2] = p.z, to[3] = p.e0, to[4] = p.e1, to[5] = p.e2, to[6] = p.e3;
}

}  // namespace

int Names::find(const py::handle& which) const {
  if (PyLong_Check(which.ptr())) {
    const auto number = which.cast<long long>();
    if (number < 0 || number >= std::ssize(all_))
      throw py::index_error(fmt::format("there is no {} number {}: the World has {}", what_, number, all_.size()));
    return static_cast<int>(number);
  }
  if (!py::isinstance<py::str>(which)) throw py::type_error(fmt::format("a {} goes by its name or its number", what_));
  const auto name = which.cast<std::string>();
  const auto found = std::find(all_.begin(), all_.end(), name);
  if (found == all_.end())
    throw py::key_error(fmt::format("there is no {} `{}`{}", what_, name, suggestion(name, all_)));
  return static_cast<int>(found - all_.begin());
}

void Names::check_new(const std::string& name) const {
  if (name == ground_name || std::find(all_.begin(), all_.end(), name) != all_.end())
    throw py::value_error(fmt::format("the name `{}` of a {} is taken. Likely fix: another name", name, what_));
}

std::string Names::of(int number) const { return number < 0 ? "" : all_.at(static_cast<std::size_t>(number)); }

template <class S>
NamedWorld<S>::NamedWorld(const Scene& scene) {
  const Scene ready = with_steps(scene);
  std::string warnings;
  world_ = world_at_start<S>(ready, warnings);
  if (!warnings.empty() && PyErr_WarnEx(PyExc_UserWarning, warnings.c_str(), 1) != 0) throw py::error_already_set();
  step_ = ready.step, why = ready.why_integrator;
  for (const SceneBody& body : scene.bodies) bodies.add(body.name);
  for (const SceneJoint& joint : scene.joints) joints.add(joint.name);
  name_the_rest();
}

// The ground and the springs of a scene get their names after its bodies and joints.
template <class S>
void NamedWorld<S>::name_the_rest() {
  while (std::ssize(bodies.all()) < world_.body_count()) bodies.add(ground_name);
  while (std::ssize(joints.all()) < world_.joint_count()) joints.add(fmt::format("spring {}", joints.all().size()));
}

// --- setting up ---

template <class S>
int NamedWorld<S>::add_body(const std::string& name, const py::kwargs& keywords) {
  bodies.check_new(name);
  int number;
  if constexpr (planar) number = world().add_body(planar_body_of(keywords));
  else number = world().add_body(spatial_body_of(keywords));
  bodies.add(name);
  return number;
}

namespace {

// The name of a type: that of the catalogue, or of the spec whose path it is.
std::string type_named(const std::string& type) {
  if (!type.ends_with(".joint") && !type.ends_with(".effect")) return type;
  const OwnType own = add_own_type(type);
  if (own.name.empty()) throw Error(own.problems);
  return own.name;
}

}  // namespace

template <class S>
int NamedWorld<S>::add_joint(const std::string& name, const std::string& type, const py::sequence& of,
                             const py::kwargs& keywords) {
  if (py::isinstance<py::str>(of)) throw py::type_error("bodies must be a sequence of names or numbers");
  joints.check_new(name);
  JointDefinition definition;
  definition.type = type_named(type);
  for (const py::handle& which : of) {
    const bool ground = py::isinstance<py::str>(which) && which.cast<std::string>() == ground_name;
    definition.bodies.push_back(ground ? world().ground() : body(which));
    name_the_rest();
  }
  definition.parameters = parameters_of(keywords);
  const int number = world().add_joint(definition);
  joints.add(name);
  return number;
}

template <class S>
int NamedWorld<S>::add_effect(const py::handle& which, const std::string& coordinate, const std::string& type,
                              const py::kwargs& keywords) {
  const int of = joint(which);
  int number = -1;
  effect_of(coordinate, type_named(type), keywords).each([&](const auto& effect) {
    number = cdot::add_effect(world(), of, coordinate, effect);
  });
  return number;
}

template <class S>
void NamedWorld<S>::end_by_effect(const py::handle& which, const std::string& type, const py::kwargs& keywords) {
  cdot::add_effect(world(), joint(which), SpecEffect{type_named(type), parameters_of(keywords)});
}

template <class S>
void NamedWorld<S>::set_effect(const py::handle& which, int number, const std::string& type,
                               const py::kwargs& keywords) {
  const int of = joint(which);
  effect_of("", type_named(type), keywords).each([&](const auto& effect) {
    cdot::set_effect(world(), of, number, effect);
  });
}

template <class S>
void NamedWorld<S>::set_breaking_load(const py::handle& which, double load) {
  cdot::set_breaking_load(world(), joint(which), load);
}

template <class S>
void NamedWorld<S>::set_parameters(const py::handle& which, const py::kwargs& keywords) {
  world().set_parameters(joint(which), parameters_of(keywords));
}

template <class S>
void NamedWorld<S>::remove_joint(const py::handle& which) {
  world().remove_joint(joint(which));
}

template <class S>
void NamedWorld<S>::set_force(const py::handle& which, const py::handle& value) {
  typename S::Wrench force;
  S::add(force, S::read_velocity(numbers_of(value, "force", S::freedom).data()), 1);
  world().set_force(body(which), force);
}

template <class S>
void NamedWorld<S>::set_velocity(const py::handle& which, const py::handle& value) {
  world().set_velocity(body(which), S::read_velocity(numbers_of(value, "velocity", S::freedom).data()));
}

template <class S>
void NamedWorld<S>::apply_impulse(const py::handle& which, const py::handle& value) {
  world().apply_impulse(body(which), S::read_velocity(numbers_of(value, "impulse", S::freedom).data()));
}

template <class S>
void NamedWorld<S>::set_pose(const py::handle& which, const py::handle& value) {
  world().set_pose(body(which), place_of_numbers<S>(numbers_of(value, "pose", S::pose_numbers).data()));
}

// An unchanged state stays untouched: it wakes nothing and costs nothing.
template <class S>
void NamedWorld<S>::set_states(const py::handle& states) {
  const auto count = static_cast<py::ssize_t>(world().body_count());
  const py::array_t<double> given = readable(states, "states", {count, state_numbers});
  std::array<double, S::pose_numbers> pose{};
  std::array<double, S::freedom> velocity{};
  for (int body = 0; body < count; ++body) {
    const double* row = given.data(body, 0);
    write_place<S>(world_.place(body), pose.data());
    S::write(world_.velocity(body), velocity.data());
    if (!std::equal(pose.begin(), pose.end(), row)) world_.set_pose(body, place_of_numbers<S>(row));
    row += S::pose_numbers;
    if (!std::equal(velocity.begin(), velocity.end(), row)) world_.set_velocity(body, S::read_velocity(row));
  }
}

// --- running ---

template <class S>
std::string NamedWorld<S>::run(double h, int count, double* out) {
  for (int k = 0; k < count; ++k) {
    const StepResult result = world_.step(h);
    if (!result)
      return in_words(result, bodies.of(result.body), joints.of(result.joint)) +
             "\nLikely fix: " + likely_fix(result.problem, OnFailure::stop);
    if (!out) continue;
    write_states(out);
    out += world_.body_count() * state_numbers;
  }
  return {};
}

template <class S>
void NamedWorld<S>::step(std::optional<double> h, int count, const std::optional<py::array>& out) {
  constexpr int steps_between_signals = 256;  // Ctrl-C ends many steps
  if (count < 0) throw py::value_error(fmt::format("count must be >= 0, but is {}", count));
  const py::ssize_t bodies_now = world().body_count();
  double* to = out ? writable(*out, "out", {count, bodies_now, state_numbers}) : nullptr;
  for (int done = 0; done < count; done += steps_between_signals) {
    const int now = std::min(count - done, steps_between_signals);
    std::string failure;
    set_busy(true);
    {
      const py::gil_scoped_release others_may_run;
      failure = run(h.value_or(step_), now, to ? to + done * bodies_now * state_numbers : nullptr);
    }
    set_busy(false);
    if (!failure.empty()) throw Error(failure);
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
}

template <class S>
void NamedWorld<S>::project(double tolerance) {
  const ProjectResult result = world().project(tolerance);
  if (result) return;
  throw Error(fmt::format(
      "the projection failed: row {} of joint `{}` is off by {:.3g} (m or rad, or per s). The joints contradict each "
      "other{}. Likely fix: correct the poses, or remove a joint",
      result.row + 1, joints.of(result.joint), result.misfit,
      result.refused ? ", or would move bodies far for a small error" : ""));
}

// --- looking ---

template <class S>
void NamedWorld<S>::write_states(double* to) const {
  for (int body = 0; body < world_.body_count(); ++body) {
    write_place<S>(world_.place(body), to);
    S::write(world_.velocity(body), to + S::pose_numbers);
    to += state_numbers;
  }
}

template <class S>
py::array_t<double> NamedWorld<S>::states() const {
  py::array_t<double> all(Shape{world().body_count(), state_numbers});
  write_states(all.mutable_data());
  return all;
}

// Keeps the World alive, and the bytes of an older layout as long as an array shows them.
template <class S>
py::object NamedWorld<S>::owner_of(const py::object& self) {
  using Bytes = std::vector<std::byte>;
  struct Keeper {
    py::object world;
    std::shared_ptr<Bytes> bytes;
  };
  Block& block = self.cast<NamedWorld&>().world_.data().block;
  std::shared_ptr<Bytes> heir = block.heir.lock();
  if (!heir) block.heir = heir = std::make_shared<Bytes>();
  return py::capsule(new Keeper{self, heir}, [](void* at) { delete static_cast<Keeper*>(at); });
}

// `count` numbers of each struct, from number `offset` on.
template <class S>
template <class Struct>
py::array_t<double> NamedWorld<S>::view_of(const py::object& self, const Struct* first, std::size_t offset,
                                           py::ssize_t count) {
  Shape shape{self.cast<NamedWorld&>().world_.body_count()}, strides{static_cast<py::ssize_t>(sizeof(Struct))};
  if (count > 1) shape.push_back(count), strides.push_back(sizeof(double));
  return as_view(reinterpret_cast<const double*>(first) + offset, shape, strides, owner_of(self));
}

template <class S>
Bodies<S>& prepared(BasicWorld<S>& world) {
  world.prepare();
  return world.data().bodies;
}

template <class S>
py::array_t<double> NamedWorld<S>::positions(const py::object& self) {
  return view_of(self, prepared(self.cast<NamedWorld&>().world()).pose.data(), 0, planar ? 2 : 3);
}
template <class S>
py::array_t<double> NamedWorld<S>::orientations(const py::object& self) {
  return view_of(self, prepared(self.cast<NamedWorld&>().world()).pose.data(), planar ? 4 : 3, planar ? 1 : 4);
}
template <class S>
py::array_t<double> NamedWorld<S>::velocities(const py::object& self) {
  return view_of(self, prepared(self.cast<NamedWorld&>().world()).velocity.data(), 0, S::freedom);
}

template <class S>
py::array_t<double> NamedWorld<S>::reaction(const py::handle& which, const py::handle& on) const {
  const typename S::Velocity force = S::components(world().reaction(joint(which), body(on)));
  std::vector<double> numbers(S::freedom);
  S::write(force, numbers.data());
  return as_array(std::move(numbers));
}

template <class S>
py::dict NamedWorld<S>::coordinates(const py::handle& which) const {
  const int of = joint(which);
  return named_numbers(world().joint_type(of).coordinates,
                       [&](const CoordinateInfo& info) { return world_.coordinate(of, info.name); });
}

template <class S>
py::dict NamedWorld<S>::rates(const py::handle& which) const {
  const int of = joint(which);
  return named_numbers(world().joint_type(of).coordinates,
                       [&](const CoordinateInfo& info) { return world_.coordinate_rate(of, info.name); });
}

template <class S>
py::dict NamedWorld<S>::parameters(const py::handle& which) const {
  const int of = joint(which);
  const std::vector<double> all = world().joint_parameters(of);
  return named_numbers(world_.joint_type(of).parameters, [&](const ParameterInfo& info) {
    const auto first = all.begin() + info.offset;
    return as_array(std::vector<double>(first, first + info.size));
  });
}

template <class S>
py::dict NamedWorld<S>::balance() const {
  const Balance b = world().balance();
  py::dict all;
  all["kinetic"] = b.kinetic, all["potential"] = b.potential, all["start"] = b.start;
  all["put_in"] = b.put_in, all["taken"] = b.taken, all["method"] = b.method();
  return all;
}

template <class S>
py::dict NamedWorld<S>::work() const {
  py::dict all;
  for (const WorkOfSource& source : world().work_by_source())
    all[py::str(source.name.data(), source.name.size())] = source.work;
  return all;
}

template <class S>
std::vector<std::string> NamedWorld<S>::notes() const {
  std::vector<std::string> all;
  for (const Note& note : world().notes())
    all.push_back(fmt::format("joint `{}` {}", joints.of(note.joint), note.text));
  return all;
}

template <class S>
std::vector<std::string> NamedWorld<S>::broken() const {
  std::vector<std::string> all;
  for (int joint = 0; joint < world().joint_count(); ++joint)
    if (world_.broken(joint)) all.push_back(joints.of(joint));
  return all;
}

template <class S>
std::vector<double> NamedWorld<S>::origin() const {
  const auto& at = const_cast<BasicWorld<S>&>(world()).data().origin;
  return {at.begin(), at.begin() + (planar ? 2 : 3)};
}

template class NamedWorld<Planar<double>>;
template class NamedWorld<Spatial<double>>;

}  // namespace cdot::python
