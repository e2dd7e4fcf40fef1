// A World for Python: bodies and joints by name, numbers as arrays.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <cdot/effects.hpp>
#include <cdot/world.hpp>

#include "derive/python/arrays.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot::python {

// The bodies or joints of a World by number or name.
class Names {
 public:
  explicit Names(std::string what) : what_(std::move(what)) {}

  int find(const py::handle& which) const;  // throws IndexError, KeyError, TypeError
  void check_new(const std::string& name) const;
  void add(const std::string& name) { all_.push_back(name); }
  const std::vector<std::string>& all() const { return all_; }
  std::string of(int number) const;  // empty for -1

 private:
  std::string what_;
  std::vector<std::string> all_;
};

template <class S>
class NamedWorld {
 public:
  static constexpr bool planar = S::dimension == Dimension::planar;
  // Numbers of a body in an array of states: pose and velocity.
  static constexpr int state_numbers = S::pose_numbers + S::freedom;

  explicit NamedWorld(const Settings& settings) : world_(settings) {}
  explicit NamedWorld(const Scene& scene);  // at its start, with the method and the step that it names

  // --- setting up ---
  int add_body(const std::string& name, const py::kwargs& keywords);
  int add_joint(const std::string& name, const std::string& type, const py::sequence& of, const py::kwargs& keywords);
  int add_effect(const py::handle& joint, const std::string& coordinate, const std::string& type,
                 const py::kwargs& keywords);
  void end_by_effect(const py::handle& joint, const std::string& type, const py::kwargs& keywords);
  void set_effect(const py::handle& joint, int number, const std::string& type, const py::kwargs& keywords);
  void set_breaking_load(const py::handle& joint, double load);
  void set_parameters(const py::handle& joint, const py::kwargs& keywords);
  void remove_joint(const py::handle& joint);
  void set_force(const py::handle& body, const py::handle& value);
  void set_velocity(const py::handle& body, const py::handle& value);
  void apply_impulse(const py::handle& body, const py::handle& value);
  void set_pose(const py::handle& body, const py::handle& value);
  void set_states(const py::handle& states);

  // --- running ---
  // Other threads of Python run meanwhile. `out`, if given, gets the states after each step.
  void step(std::optional<double> h, int count, const std::optional<py::array>& out);
  void project(double tolerance);
  // Steps without Python: the reason if one fails, else empty. `out` has room for `count` times the states.
  std::string run(double h, int count, double* out);
  void write_states(double* to) const;

  // --- looking ---
  py::array_t<double> states() const;
  py::array_t<double> reaction(const py::handle& joint, const py::handle& body) const;
  py::dict coordinates(const py::handle& joint) const;
  py::dict rates(const py::handle& joint) const;
  py::dict parameters(const py::handle& joint) const;
  py::dict balance() const;
  py::dict work() const;
  std::vector<std::string> notes() const;
  std::vector<std::string> broken() const;
  std::vector<double> origin() const;
  // Views of the memory of the World itself, which they keep alive.
  static py::array_t<double> positions(const py::object& self);
  static py::array_t<double> orientations(const py::object& self);
  static py::array_t<double> velocities(const py::object& self);

  // Throws Error while another thread steps it.
  BasicWorld<S>& world() { return checked(), world_; }
  const BasicWorld<S>& world() const { return checked(), world_; }
  int body(const py::handle& which) const { return bodies.find(which); }
  int joint(const py::handle& which) const { return joints.find(which); }
  double usual_step() const { return step_; }
  // Marks it as stepped by a thread; call with the lock of Python.
  void set_busy(bool busy) { busy_ = busy; }

  Names bodies{"body"}, joints{"joint"};
  std::string why;  // the method of a scene that names none was picked

 private:
  void checked() const {
    if (busy_) throw Error("another thread steps this World. Likely fix: a World for each thread");
  }
  void name_the_rest();
  static py::object owner_of(const py::object& self);
  template <class Struct>
  static py::array_t<double> view_of(const py::object& self, const Struct* first, std::size_t offset,
                                     py::ssize_t count);

  BasicWorld<S> world_;
  double step_ = default_step;  // [s] of step() without a length
  bool busy_ = false;
};

// Steps Worlds of one space on threads; `out` [worlds, bodies, numbers] gets their states. Throws Error if one fails,
// after all have ended.
void batch(const py::list& worlds, double h, int count, const py::array& out, int threads);

extern template class NamedWorld<Planar<double>>;
extern template class NamedWorld<Spatial<double>>;

}  // namespace cdot::python
