// A spec for the page: messages about it, its derivation, and its names in the picture.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "derive/numbers/numeric.hpp"
#include "derive/syntax/source.hpp"

namespace cdot::play {

// A message about a place of a text; the columns count characters from 1.
nlohmann::json message_json(const derive::SourceFile& file, derive::Span where, const std::string& severity,
                            const std::string& message, const std::string& fix);
nlohmann::json messages_json(const derive::SourceFile& file, const derive::Diagnostics& diagnostics);

// {messages: [{severity, line, column, end, message, fix}], name, dimension}
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
