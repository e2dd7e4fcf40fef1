// Scenes and their runs: rows of a trajectory as arrays, the verdict in words.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <string>
#include <vector>

#include "derive/python/arrays.hpp"
#include "runtime/tool/run/balance_report.hpp"
#include "runtime/tool/run/error_report.hpp"
#include "runtime/tool/run/pick_integrator.hpp"
#include "runtime/tool/search/advice.hpp"
#include "runtime/tool/search/simulate.hpp"
#include "runtime/tool/watch/record.hpp"

namespace cdot::python {
namespace {

constexpr int poses_diagnosed = 8;

// The rows of a run, as the file of `cdot-run simulate -o` has them.
struct Rows {
  std::vector<double> times, states, sensors, energies, errors;

  void take(const Scene& scene, const Frame& frame) {
    times.push_back(frame.time);
    for (const BodyState& body : frame.bodies)
      for (const StateColumn& column : state_columns(scene.dimension)) states.push_back(body.*column.number);
    sensors.insert(sensors.end(), frame.sensors.begin(), frame.sensors.end());
    energies.push_back(frame.energy);
    errors.push_back(frame.worst.value);
  }
};

struct Finished {
  Scene scene;
  RunResult run;
  std::string warnings;
  py::array_t<double> times, states, sensors, energies, errors;
};

py::ssize_t size_of(const auto& list) { return static_cast<py::ssize_t>(list.size()); }

void check_times(const std::vector<double>& times) {
  for (const double time : times)
    if (!(time >= 0 && std::isfinite(time)))
      throw py::value_error(fmt::format("a time of the output must be a finite number >= 0, but is {}", time));
}

void record_known(Scene& scene, const std::vector<std::string>& groups) {
  std::string known = "all";
  for (const Recordable& group : recordables()) known += fmt::format(", {}", group.name);
  for (const std::string& name : groups)
    if (name != "all" &&
        std::ranges::find(recordables(), std::string_view(name), &Recordable::name) == recordables().end())
      throw py::value_error(fmt::format("there is no group `{}` to record. Known groups: {}", name, known));
  record(scene, groups);
}

RunResult run_scene(const Scene& scene, const RunOptions& options, std::string& warnings) {
  const py::gil_scoped_release others_may_run;
  RunResult run = simulate(scene, options, warnings);
  if (!run.interrupted && needs_advice(scene, run)) run.advice = find_advice(scene, options, run);
  return run;
}

Finished simulate_scene(const Scene& as_written, std::vector<double> times, const Snapshot* from, bool save) {
  check_times(times);
  const Scene scene = with_integrator(as_written);
  Rows rows;
  RunOptions options;
  options.row = [&](const Frame& frame) { rows.take(scene, frame); };
  options.row_times = std::move(times);
  std::sort(options.row_times.begin(), options.row_times.end());
  options.diagnose_times = equal_times(scene.duration, poses_diagnosed, 0);
  if (from) options.from = *from;
  if (save) options.save_at = scene.duration;
  Finished result{scene, {}, {}, {}, {}, {}, {}, {}};
  result.run = run_scene(scene, options, result.warnings);
  if (result.run.interrupted) {
    PyErr_SetNone(PyExc_KeyboardInterrupt);
    throw py::error_already_set();
  }
  const py::ssize_t frames = size_of(rows.times), columns = size_of(state_columns(scene.dimension));
  result.times = as_array(std::move(rows.times), {frames});
  result.states = as_array(std::move(rows.states), {frames, size_of(scene.bodies), columns});
  result.sensors = as_array(std::move(rows.sensors), {frames, size_of(scene.sensors)});
  result.energies = as_array(std::move(rows.energies), {frames});
  result.errors = as_array(std::move(rows.errors), {frames});
  return result;
}

// A number that Python gives to a member of the scene.
template <double Scene::*number>
void set_positive(Scene& scene, double value) {
  if (!(value > 0 && std::isfinite(value)))
    throw py::value_error(fmt::format("this number of a scene must be finite and > 0, but is {}", value));
  scene.*number = value;
}

std::vector<std::string> names_in(const auto& parts) {
  std::vector<std::string> names;
  for (const auto& part : parts) names.push_back(part.name);
  return names;
}

std::vector<std::string> columns_in(const Scene& scene) {
  std::vector<std::string> names;
  for (const StateColumn& column : state_columns(scene.dimension)) names.emplace_back(column.name);
  return names;
}

std::string warnings_of(const Finished& f) {
  std::string all = f.warnings;
  for (const std::string& text : {balance_warning(f.scene, f.run), trajectory_warning(f.scene, f.run)})
    if (!text.empty()) all += text + "\n";
  return all;
}

void bind_scenes(py::module_& module) {
  py::class_<Scene>(module, "Scene",
                    "A scene of TOML, read and checked. A scene does not run: simulate() and World do.")
      .def(py::init([](const std::string& path) { return read_scene(path); }), py::arg("path"),
           "By its path, or by the name of one of the catalogue: \"four_bar\". Raises SceneError with its mistakes.")
      .def_static(
          "of_text", [](const std::string& text, const std::string& name) { return read_scene(text, name); },
          py::arg("text"), py::arg("name") = "text.toml", "From TOML; messages call it by `name`.")
      .def_readonly("file", &Scene::file, "Where it was read from.")
      .def_readonly("title", &Scene::title, "Its title.")
      .def_property_readonly(
          "dimension", [](const Scene& s) { return s.dimension == Dimension::planar ? 2 : 3; }, "2 or 3.")
      .def_property(
          "duration", [](const Scene& s) { return s.duration; }, set_positive<&Scene::duration>, "Of the run [s].")
      .def_property(
          "step", [](const Scene& s) { return s.step; }, set_positive<&Scene::step>,
          "[s]; 0 if an accuracy chooses it.")
      .def_property(
          "accuracy", [](const Scene& s) { return s.accuracy; }, set_positive<&Scene::accuracy>,
          "[m], [rad]; 0: the method that the scene names, else 1e-4 of its size.")
      .def_property_readonly(
          "bodies", [](const Scene& s) { return names_in(s.bodies); }, "Names of the bodies.")
      .def_property_readonly(
          "joints", [](const Scene& s) { return names_in(s.joints); }, "Names of the joints.")
      .def_property_readonly(
          "sensors", [](const Scene& s) { return names_in(s.sensors); }, "Names of the sensors.")
      .def_property_readonly("columns", columns_in, "Names of the numbers of a body's state: x, y, angle, vx, ...")
      .def("record", &record_known, py::arg("groups"), "Adds sensors, as `cdot-run simulate --record`: [\"all\"], ...")
      .def("_simulate", &simulate_scene, py::arg("times"), py::arg("start"), py::arg("save"))
      .def("__copy__", [](const Scene& s) { return Scene(s); })
      .def("__deepcopy__", [](const Scene& s, const py::dict&) { return Scene(s); });
}

void bind_results(py::module_& module) {
  py::class_<Finished>(module, "Result", "A finished run: one row per step, or per time that was asked for.")
      .def_readonly("scene", &Finished::scene, "The scene that ran.")
      .def_readonly("times", &Finished::times, "float64 [rows], in s.")
      .def_readonly("states", &Finished::states, "float64 [rows, bodies, columns]; scene.columns names the columns.")
      .def_readonly("sensors", &Finished::sensors, "float64 [rows, sensors], each in the unit of its sensor.")
      .def_readonly("energies", &Finished::energies, "float64 [rows], kinetic and potential energy in J.")
      .def_readonly("joint_errors", &Finished::errors, "float64 [rows], the largest |C| of a joint in m or rad.")
      .def_property_readonly(
          "failure", [](const Finished& f) { return failure(f.scene, f.run); },
          "Why the run failed: failure, number, cause and fix; empty if it did not.")
      .def_property_readonly("warnings", warnings_of,
                             "Warnings about the start, the balance and the trajectory; empty if there are none.")
      .def_property_readonly(
          "text", [](const Finished& f) { return summary_text(f.scene, f.run); },
          "The summary that `cdot-run simulate` prints.")
      .def_property_readonly(
          "json", [](const Finished& f) { return summary_json(f.scene, f.run); },
          "The same for programs: the text of `cdot-run simulate --json`.")
      .def_property_readonly(
          "state", [](const Finished& f) { return f.run.state; },
          "The Snapshot at the end, if simulate(save=True) asked for it; else an empty one.");
}

}  // namespace

void bind_scene(py::module_& module) {
  py::class_<Snapshot>(module, "Snapshot", "The complete state of a World at one moment. It does not change.")
      .def_property_readonly("time", &Snapshot::time, "At which it was taken [s].")
      .def("text", &Snapshot::text, "The state as lines of text, every number to the bit.")
      .def_static(
          "read", [](const std::string& text) { return Snapshot::read(text); }, py::arg("text"),
          "From the output of text(), or from a file of `cdot-run simulate --save-state`.")
      .def("differences", &Snapshot::differences, py::arg("other"), "Names of the arrays whose bits differ.")
      .def(
          "__eq__", [](const Snapshot& a, const Snapshot& b) { return a == b; }, py::is_operator());
  bind_scenes(module);
  bind_results(module);
}

}  // namespace cdot::python
