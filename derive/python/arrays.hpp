// Numbers of C++ -> numpy, and the numbers that Python gives -> C++.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <string>
#include <vector>

namespace cdot::python {

namespace py = pybind11;

using Shape = std::vector<py::ssize_t>;

// The numbers as an array of this shape, row by row. The array owns them: nothing is copied.
py::array_t<double> as_array(std::vector<double> numbers, Shape shape);
py::array_t<double> as_array(std::vector<double> numbers);

// Shows memory that is not its own: `owner` keeps it alive. Python may not write there.
py::array_t<double> as_view(const double* first, Shape shape, Shape strides, const py::object& owner);

// A number or a sequence of them. Throws TypeError with the name if it is neither.
std::vector<double> numbers_of(const py::handle& value, const std::string& name);

// The same with exactly `count` numbers, else ValueError with both counts.
std::vector<double> numbers_of(const py::handle& value, const std::string& name, std::size_t count);

// The memory of an array of this shape, in doubles, row by row. To read: another type or layout is copied. To write:
// such an array is an error.
py::array_t<double> readable(const py::handle& value, const std::string& name, const Shape& shape);
double* writable(const py::array& value, const std::string& name, const Shape& shape);

// The parts of the module, one file each.
void bind_compiled(py::module_& module);
void bind_derivation(py::module_& module);
void bind_scene(py::module_& module);
void bind_world(py::module_& module);

}  // namespace cdot::python
