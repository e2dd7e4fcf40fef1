// Many variants of a scene, compiled: numbers in and out as arrays.
#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cdot/methods.hpp>

#include "derive/python/arrays.hpp"
#include "runtime/command_line/installation.hpp"
#include "runtime/tool/compiled/compiled_batch.hpp"

namespace cdot::python {
namespace {

namespace fs = std::filesystem;

// In the package, or in the build folder around it.
SceneCompiler scene_compiler() {
  const fs::path package = command_line::installed("");
  for (const fs::path& program : {package / "bin/cdot-compile", package / "../../derive/cdot-compile"})
    for (const fs::path& include : {package / "include", package / "../../include"})
      if (fs::exists(program) && fs::exists(include / "cdot/pack.hpp"))
        return {program, include, 120, package / "specs"};
  return {};
}

class Compiled {
 public:
  Compiled(const Scene& scene, int variants, const std::string& integrator, const std::vector<std::string>& inputs,
           int lanes) {
    if (variants < 1) throw py::value_error(fmt::format("variants must be >= 1, but is {}", variants));
    if (lanes != 4 && lanes != 8 && lanes != 16)
      throw py::value_error(fmt::format("lanes must be 4, 8 or 16, but is {}", lanes));
    const std::vector<std::string> known = names_of(integrators);
    if (std::ranges::find(known, integrator) == known.end())
      throw py::value_error(
          fmt::format("integrator must be one of {}, but is `{}`", fmt::join(known, ", "), integrator));
    const StepWishes wishes = {method_called(integrators, integrator), lanes, inputs};
    const py::gil_scoped_release others_may_run;
    batch_ = std::make_unique<CompiledBatch>(scene, variants, wishes, scene_compiler());
  }

  void step(std::optional<double> h, int count, int threads) {
    if (count < 0) throw py::value_error(fmt::format("count must be >= 0, but is {}", count));
    const double length = h.value_or(batch_->usual_step());
    if (!(length > 0)) throw Error(fmt::format("a step has a positive length [s], but h is {}", length));
    const py::gil_scoped_release others_may_run;
    batch_->step(length, count, threads);
  }

  py::array_t<double> states() const {
    std::vector<double> numbers(size());
    batch_->read(numbers.data());
    return as_array(std::move(numbers), shape());
  }
  void set_states(const py::handle& states) { batch_->write(readable(states, "states", shape()).data()); }

  // A number, or one for each variant.
  void set(const std::string& input, const py::handle& values) {
    const auto known = std::ranges::find(batch_->inputs(), input);
    if (known == batch_->inputs().end())
      throw py::key_error(
          fmt::format("there is no input `{}`; the inputs are: {}", input, fmt::join(batch_->inputs(), ", ")));
    const auto count = static_cast<std::size_t>(batch_->variants());
    std::vector<double> numbers = numbers_of(values, "values");
    if (numbers.size() == 1) numbers.assign(count, numbers[0]);
    if (numbers.size() != count)
      throw py::value_error(fmt::format("{} has {} numbers, but there are {} variants", input, numbers.size(), count));
    batch_->set_input(static_cast<int>(known - batch_->inputs().begin()), numbers.data());
  }

  std::pair<py::array_t<double>, py::array_t<double>> measured() const {
    std::vector<double> energies(static_cast<std::size_t>(batch_->variants())), errors(energies.size());
    batch_->measure(energies.data(), errors.data());
    return {as_array(std::move(energies)), as_array(std::move(errors))};
  }

  const CompiledBatch& batch() const { return *batch_; }

 private:
  Shape shape() const {
    return {batch_->variants(), static_cast<py::ssize_t>(batch_->bodies().size()), batch_->numbers_of_body()};
  }
  std::size_t size() const {
    std::size_t product = 1;
    for (const py::ssize_t n : shape()) product *= static_cast<std::size_t>(n);
    return product;
  }

  std::unique_ptr<CompiledBatch> batch_;
};

}  // namespace

void bind_compiled(py::module_& module) {
  py::class_<Compiled>(module, "Compiled",
                       "Variants of one scene, stepped together by its own compiled step: cdot.compile() makes it.")
      .def(py::init<const Scene&, int, const std::string&, const std::vector<std::string>&, int>(), py::arg("scene"),
           py::arg("variants"), py::arg("integrator"), py::arg("inputs"), py::arg("lanes"),
           "All variants at the start of the scene.")
      .def("step", &Compiled::step, py::arg("h") = py::none(), py::arg("count") = 1, py::arg("threads") = 1,
           "Steps all variants `count` times by h [s], without h by the scene's own step.")
      .def("states", &Compiled::states,
           "A copy, float64 [variants, bodies, 6]: x, y, angle and their rates; in space 13 numbers with a quaternion.")
      .def("set_states", &Compiled::set_states, py::arg("states"),
           "Takes what states() gives, and moves each variant to C = 0 and Cdot = 0.")
      .def("set", &Compiled::set, py::arg("input"), py::arg("values"),
           "Sets an input: one number for all variants, or one for each.")
      .def(
          "energies", [](const Compiled& self) { return self.measured().first; }, "[variants], in J.")
      .def(
          "errors", [](const Compiled& self) { return self.measured().second; },
          "[variants]: the largest |C| of each, in m or rad.")
      .def_property_readonly(
          "bodies", [](const Compiled& self) { return self.batch().bodies(); },
          "The names of the bodies that move, in the order of states().")
      .def_property_readonly(
          "inputs", [](const Compiled& self) { return self.batch().inputs(); }, "The numbers that may change.")
      .def_property_readonly(
          "time", [](const Compiled& self) { return self.batch().time(); }, "Since the start, in s.")
      .def_property_readonly(
          "variants", [](const Compiled& self) { return self.batch().variants(); }, "How many there are.")
      .def("__repr__", [](const Compiled& self) {
        return fmt::format("<cdot.Compiled of {} variants of {} bodies, t = {:.4g} s>", self.batch().variants(),
                           self.batch().bodies().size(), self.batch().time());
      });
}

}  // namespace cdot::python
