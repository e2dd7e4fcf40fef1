// A spec for the page: messages about it, its derivation, and its names in the picture.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "derive/derivation/derivation.hpp"
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
// {html}: the kernel's C++ with the names of the derivation marked as there; or {problems}.
nlohmann::json kernel_of_spec(const std::string& path);
// The answer made of the derivation, or {problems} if there is none.
nlohmann::json with_derivation(const std::string& path,
                               const std::function<nlohmann::json(const derive::Derivation&)>& answer);

// Poses of a joint's bodies and its parameters, laid out as in cdot::JointType.
struct JointPose {
  std::vector<derive::Sample::Body> bodies;
  std::vector<double> parameters;
  double time = 0;
  std::vector<derive::Triple<double>> forces;  // of the joint on its bodies [N]
};
// {points: [{name, at}], arrows: [{name, from, along}], forces: [{from, force}]}, at this pose; or {problems}. A force
// begins at the first point of its body that the spec names, or at its centre.
nlohmann::json marks_of_spec(const std::string& path, const JointPose& pose);

}  // namespace cdot::play
