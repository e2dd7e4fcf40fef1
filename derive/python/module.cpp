// The module cdot._cdot: its exceptions and its parts.
#include <pybind11/pybind11.h>
#include <string>

#include <cdot/settings.hpp>

#include "derive/python/arrays.hpp"
#include "runtime/command_line/installation.hpp"
#include "runtime/tool/scene/scene.hpp"

PYBIND11_MODULE(_cdot, module) {
  namespace py = pybind11;
  module.doc() = "Scenes, Worlds and derivations of Cdot. Use the package cdot, which adds sympy and batches.";
  module.attr("__version__") = CDOT_VERSION;
  module.def(
      "_install_in", [](const std::string& folder) { cdot::command_line::install_in(folder); }, py::arg("folder"),
      "The folder of the package, which holds its specs and scenes.");
  const auto& error = py::register_exception<cdot::Error>(module, "Error", PyExc_RuntimeError);
  error.attr("__doc__") = "A mistake, in the words of the programs: failure, number, cause and likely fix.";
  py::register_exception<cdot::SceneError>(module, "SceneError", error).attr("__doc__") =
      "Mistakes in a scene, each with its line.";
  cdot::python::bind_derivation(module);
  cdot::python::bind_scene(module);
  cdot::python::bind_world(module);
  cdot::python::bind_compiled(module);
}
