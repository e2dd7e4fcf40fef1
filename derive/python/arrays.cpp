// Numbers of C++ -> numpy, and back.
#include "derive/python/arrays.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <utility>

namespace cdot::python {
namespace {

void check_shape(const py::array& array, const std::string& name, const Shape& shape) {
  const Shape given(array.shape(), array.shape() + array.ndim());
  if (given != shape)
    throw py::value_error(
        fmt::format("{} must have the shape ({}), but has ({})", name, fmt::join(shape, ", "), fmt::join(given, ", ")));
}

}  // namespace

py::array_t<double> as_array(std::vector<double> numbers, Shape shape) {
  auto* const owned = new std::vector<double>(std::move(numbers));
  const py::capsule owner(owned, [](void* at) { delete static_cast<std::vector<double>*>(at); });
  return py::array_t<double>(std::move(shape), owned->data(), owner);
}

py::array_t<double> as_array(std::vector<double> numbers) {
  const auto count = static_cast<py::ssize_t>(numbers.size());
  return as_array(std::move(numbers), {count});
}

py::array_t<double> as_view(const double* first, Shape shape, Shape strides, const py::object& owner) {
  py::array_t<double> view(std::move(shape), std::move(strides), first, owner);
  view.attr("flags").attr("writeable") = false;
  return view;
}

std::vector<double> numbers_of(const py::handle& value, const std::string& name) {
  const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(value);
  if (!array || array.ndim() > 1) {
    PyErr_Clear();
    throw py::type_error(fmt::format("{} must be a number or a sequence of numbers, but is {}", name,
                                     py::repr(value).cast<std::string>()));
  }
  return {array.data(), array.data() + array.size()};
}

std::vector<double> numbers_of(const py::handle& value, const std::string& name, std::size_t count) {
  std::vector<double> numbers = numbers_of(value, name);
  if (numbers.size() != count)
    throw py::value_error(fmt::format("{} must have {} numbers, but has {}", name, count, numbers.size()));
  return numbers;
}

py::array_t<double> readable(const py::handle& value, const std::string& name, const Shape& shape) {
  const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(value);
  if (!array) {
    PyErr_Clear();
    throw py::type_error(
        fmt::format("{} must be an array of numbers, but is {}", name, py::repr(value).cast<std::string>()));
  }
  check_shape(array, name, shape);
  return array;
}

double* writable(const py::array& value, const std::string& name, const Shape& shape) {
  check_shape(value, name, shape);
  const bool fits = py::isinstance<py::array_t<double, py::array::c_style>>(value) && value.writeable();
  if (!fits)
    throw py::type_error(fmt::format("{} must be a writable array of float64 in C order: it is filled in place", name));
  return static_cast<double*>(py::array(value).mutable_data());
}

}  // namespace cdot::python
