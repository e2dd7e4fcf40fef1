// Worlds in the plane and in space, in doubles, as classes of Python.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include "derive/python/keywords.hpp"
#include "derive/python/world.hpp"

namespace cdot::python {
namespace {

template <class S>
using Type = py::class_<NamedWorld<S>>;

py::object world_of(const py::object& from) {
  const Scene scene = py::isinstance<py::str>(from) ? read_scene(from.cast<std::string>()) : from.cast<const Scene&>();
  return in_space_of<double>(
      scene, [&]<class S>(S) -> py::object { return py::cast(std::make_unique<NamedWorld<S>>(scene)); });
}

template <class S>
void bind_setup(Type<S>& type) {
  using World = NamedWorld<S>;
  type.def_static(
          "from_scene", world_of, py::arg("scene"),
          "The World of a scene at its start: a Scene, a path, or the name of a scene of the catalogue. A World, "
          "or a SpatialWorld for a scene in space. A scene that names no method gets one for equal steps.")
      .def(
          py::init([](const py::kwargs& settings) { return std::make_unique<World>(settings_of(settings)); }),
          "Settings by keyword: solver (direct, iterative), integrator (euler, implicit, rattle, rk4, dop853, radau5), "
          "drift (projection, soft, baumgarte, none), kernels (fast, balanced, robust), gravity (2 or 3 numbers, "
          "m/s^2), local_error, iterations, substeps, baumgarte, warm_start, sleep_after [s], sleep_speed [m/s].")
      .def("add_body", &World::add_body, py::arg("name"),
           "Adds a body; returns its number. Keywords: mass [kg]; inertia about the centre of mass [kg m^2] (a number; "
           "in space 3 or 6: xx yy zz xy xz yz); position of that centre [m]; angle [rad], in space orientation (4: "
           "e0 e1 e2 e3); velocity [m/s]; omega [rad/s]; force [N]; torque [N m]; linear_damping, angular_damping "
           "[1/s]; static, fixed_rotation (bool).")
      .def("add_joint", &World::add_joint, py::arg("name"), py::arg("type"), py::arg("bodies"),
           "Adds a joint or an effect between bodies; returns its number. `type` is of the catalogue, or the path of a "
           ".joint or .effect file. `bodies` are names or numbers in the order of the spec; \"world\" is the ground. "
           "Keywords are "
           "the parameters of the spec: numbers or sequences. Others get their defaults at the present poses.")
      .def("add_effect", &World::add_effect, py::arg("joint"), py::arg("coordinate"), py::arg("type"),
           "Adds an effect to a free coordinate of a joint; returns its number. `type` is limit, motor, spring, "
           "damper, friction, load, a spec of specs/coordinate or the path of an .effect file; keywords are its "
           "numbers.")
      .def("add_effect", &World::end_by_effect, py::arg("joint"), py::arg("type"),
           "Adds an effect to the joint itself, one that ends it, as `breaking`; keywords are its numbers.")
      .def("set_effect", &World::set_effect, py::arg("joint"), py::arg("number"), py::arg("type"),
           "Changes the numbers of an effect from the next step on.")
      .def("set_breaking_load", &World::set_breaking_load, py::arg("joint"), py::arg("load"),
           "The joint breaks where its row forces reach the load [N, N m].")
      .def("set_parameters", &World::set_parameters, py::arg("joint"),
           "Changes the parameters given by keyword; the next step projects the bodies onto the new C = 0.")
      .def("remove_joint", &World::remove_joint, py::arg("joint"), "The bodies are free of it from the next step on.")
      .def("set_force", &World::set_force, py::arg("body"), py::arg("force"),
           "A constant force and torque: [3] fx fy torque; in space [6], in world axes [N, N m].")
      .def("set_pose", &World::set_pose, py::arg("body"), py::arg("pose"),
           "[3] x y angle; in space [7] x y z e0 e1 e2 e3 [m, rad].")
      .def("set_velocity", &World::set_velocity, py::arg("body"), py::arg("velocity"),
           "[3] vx vy omega; in space [6] vx vy vz wx wy wz [m/s, rad/s].")
      .def("apply_impulse", &World::apply_impulse, py::arg("body"), py::arg("impulse"),
           "[3] or [6], at the centre of mass [N s, N m s].")
      .def("set_states", &World::set_states, py::arg("states"),
           "Poses and velocities of all bodies: float64 [bodies, 6], in space [bodies, 13], as states() gives them.");
}

template <class S>
void bind_run(Type<S>& type) {
  using World = NamedWorld<S>;
  type.def("step", &World::step, py::arg("h") = py::none(), py::arg("count") = 1, py::arg("out") = py::none(),
           "`count` steps of h seconds; without h the step of the scene. `out`, float64 [count, bodies, 6 or 13], "
           "receives states() after each step, in place. Other threads run meanwhile. A step that fails raises Error "
           "and leaves the state before it.")
      .def(
          "prepare", [](World& w) { w.world().prepare(); }, "Analyses the mechanism now instead of in the first step.")
      .def("project", &World::project, py::arg("tolerance") = 1e-12,
           "Projects poses onto C = 0 and velocities onto Cdot = 0; raises Error if the joints contradict each other.")
      .def(
          "snapshot", [](World& w) { return w.world().snapshot(); }, "The complete state, as a Snapshot.")
      .def(
          "restore", [](World& w, const Snapshot& s) { w.world().restore(s); }, py::arg("snapshot"),
          "Goes back to a snapshot of this World, or of one built by the same calls; raises Error for another's.");
}

template <class S>
void bind_state(Type<S>& type) {
  using World = NamedWorld<S>;
  type.def("__repr__",
           [](const World& w) {
             return fmt::format("<cdot.{} of {} bodies and {} joints, t = {:.6g} s>",
                                S::dimension == Dimension::planar ? "World" : "SpatialWorld", w.world().body_count(),
                                w.world().joint_count(), w.world().time());
           })
      .def_property_readonly(
          "time", [](const World& w) { return w.world().time(); }, "Of the simulation [s].")
      .def_property_readonly("usual_step", &World::usual_step, "[s] of step() without h.")
      .def_readonly("why", &World::why, "Why this method was picked for a scene that names none; else empty.")
      .def_property_readonly("origin", &World::origin,
                             "[2 or 3] in m: positions count from here. 0, unless a scene lies far away from 0.")
      .def_property_readonly(
          "positions", World::positions,
          "float64 [bodies, 2 or 3] in m, from the origin: a view, which follows every step and may not be written. "
          "After a change of bodies or joints it keeps the old state; ask for it again.")
      .def_property_readonly("orientations", World::orientations,
                             "A view like positions: angles [bodies] in rad; in space quaternions [bodies, 4].")
      .def_property_readonly("velocities", World::velocities,
                             "A view like positions: [bodies, 3] vx vy omega; in space [bodies, 6] in world axes.")
      .def("states", &World::states,
           "A copy in world coordinates, float64 [bodies, 6]: x y angle vx vy omega; in space [bodies, 13]: x y z e0 "
           "e1 e2 e3 vx vy vz wx wy wz.")
      .def(
          "energy", [](const World& w) { return w.world().energy(); }, "Kinetic and potential energy [J].")
      .def("balance", &World::balance,
           "Energies [J] since the first step: kinetic, potential, start, put_in, taken, and method: made up (> 0) or "
           "lost "
           "by the method itself.")
      .def("work", &World::work, "Work [J] since the first step by who did it: motor, friction, drag, ...")
      .def(
          "hash", [](const World& w) { return w.world().hash(); }, "Of every bit of poses and velocities.");
}

template <class S>
void bind_joints(Type<S>& type) {
  using World = NamedWorld<S>;
  type.def_property_readonly(
          "bodies", [](const World& w) { return w.bodies.all(); }, "Names of the bodies, by number.")
      .def_property_readonly(
          "joints", [](const World& w) { return w.joints.all(); }, "Names of the joints, by number.")
      .def("notes", &World::notes, "Joints and effects that have no influence, with the reason.")
      .def("broken", &World::broken, "Names of the joints that broke or were removed.")
      .def("parameters", &World::parameters, py::arg("joint"), "Arrays by name, given or by default, in body axes.")
      .def("coordinates", &World::coordinates, py::arg("joint"), "The free coordinates by name [m, rad].")
      .def("rates", &World::rates, py::arg("joint"), "Their rates by name [m/s, rad/s].")
      .def("reaction", &World::reaction, py::arg("joint"), py::arg("body"),
           "[3] fx fy torque, in space [6]: of the joint on the body in the last step [N, N m].")
      .def(
          "position_error",
          [](const World& w, const py::handle& joint) { return as_array(w.world().position_error(w.joint(joint))); },
          py::arg("joint"), "C [rows], in m or rad.")
      .def(
          "velocity_error",
          [](const World& w, const py::handle& joint) { return as_array(w.world().velocity_error(w.joint(joint))); },
          py::arg("joint"), "Cdot [rows], per second.")
      .def(
          "impulse",
          [](const World& w, const py::handle& joint) { return as_array(w.world().impulse(w.joint(joint))); },
          py::arg("joint"), "lambda [rows] of the last substep [N s, N m s].")
      .def(
          "worst_error", [](const World& w) { return w.world().worst_position_error().value; },
          "The largest |C| of a joint, in m or rad.");
}

template <class S>
void bind(py::module_& module, const char* name, const char* doc) {
  Type<S> type(module, name, doc);
  bind_setup<S>(type);
  bind_run<S>(type);
  bind_state<S>(type);
  bind_joints<S>(type);
}

}  // namespace

void bind_world(py::module_& module) {
  bind<Planar<double>>(module, "World", "Bodies and joints in the plane, in doubles. Lengths in m, angles in rad.");
  bind<Spatial<double>>(module, "SpatialWorld", "Bodies and joints in space, in doubles; world axes.");
  module.def("_batch", &batch, py::arg("worlds"), py::arg("h"), py::arg("count"), py::arg("out"), py::arg("threads"));
}

}  // namespace cdot::python
