// Keyword arguments of Python -> settings, bodies, parameters and effects. A name that nothing knows raises TypeError.
#pragma once

#include <pybind11/pybind11.h>
#include <string>
#include <vector>

#include <cdot/effects.hpp>
#include <cdot/settings.hpp>

namespace cdot::python {

namespace py = pybind11;

Settings settings_of(const py::kwargs& keywords);

BodyDefinition planar_body_of(const py::kwargs& keywords);
SpatialBodyDefinition spatial_body_of(const py::kwargs& keywords);

// Every keyword is a parameter with its numbers.
std::vector<NamedValue> parameters_of(const py::kwargs& keywords);

// An effect of this type alone, by its short form (limit, motor, ...) or by its spec.
CoordinateEffects effect_of(const std::string& coordinate, const std::string& type, const py::kwargs& keywords);

// The candidate nearest to a word, as the end of a message; empty if none is near.
std::string suggestion(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace cdot::python
