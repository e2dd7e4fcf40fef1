// A spec for the page: messages about it, its derivation, and its names in the picture.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "derive/numbers/numeric.hpp"

namespace cdot::play {

// {messages: [{severity, line, column, end, message, fix}], name, dimension}; the columns count characters from 1.
nlohmann::json check_spec(const std::string& path);
// {title, html}, or {problems}.
nlohmann::json explain_spec(const std::string& path);

// Poses of a joint's bodies and its parameters, laid out as in cdot::JointType.
struct JointPose {
  std::vector<derive::Sample::Body> bodies;
  std::vector<double> parameters;
  double time = 0;
};
// {points: [{name, at}], arrows: [{name, from, along}]}, at this pose; or {problems}.
nlohmann::json marks_of_spec(const std::string& path, const JointPose& pose);

}  // namespace cdot::play
