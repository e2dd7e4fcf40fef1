// A path -> its messages, its derivation, its marks. A spec is read anew for each request: that takes a millisecond.
#include "derive/play/spec.hpp"

#include <algorithm>
#include <cmath>

#include "derive/derivation/derivation.hpp"
#include "derive/explain/explain.hpp"
#include "derive/language/specs_folder.hpp"
#include "derive/picture/marks.hpp"

namespace cdot::play {
namespace {

using namespace derive;
using nlohmann::json;

json refused(const ReadResult& read, const std::string& reason) {
  Diagnostics diagnostics;
  diagnostics.error(read.joint->rows.empty() ? derive::Span{} : read.joint->rows.front().where, reason);
  return {{"problems", render(*read.file, diagnostics)}};
}

// The body of the page that explanation_html() writes.
std::string body_of(const std::string& page) {
  const std::size_t heading = page.find("</h1>"), end = page.rfind("</body>");
  return page.substr(heading + 5, end - heading - 5);
}

// The numbers of the parameters in the order of the spec: 1 of a scalar, one per axis of the world for a point, a
// vector or a direction; of a frame in space those of its three axes.
void give_parameters(const Joint& joint, const std::vector<double>& numbers, Sample& to) {
  std::size_t at = 0;
  const auto give = [&](const Expr symbol) {
    Triple<double>& value = to.local[symbol->symbol];
    for (std::size_t k = 0; k < static_cast<std::size_t>(joint.dimension); ++k) value[k] = numbers.at(at++);
  };
  for (const Parameter& p : joint.parameters) {
    if (p.kind == derive::ParameterKind::scalar) to.scalars[p.symbol->symbol] = numbers.at(at++);
    else if (!p.axes.empty()) std::for_each(p.axes.begin(), p.axes.end(), give);
    else give(p.symbol);
  }
}

json arrow_json(const std::string& name, const Triple<double>& from, const Triple<double>& along) {
  return {{"name", name}, {"from", from}, {"along", along}};
}

// "pa, pb" where two coincide.
std::vector<std::string> names_in(const std::string& list) {
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin < list.size();) {
    const std::size_t end = std::min(list.find(", ", begin), list.size());
    names.push_back(list.substr(begin, end - begin));
    begin = end + 2;
  }
  return names;
}

}  // namespace

json message_json(const SourceFile& file, derive::Span where, const std::string& severity, const std::string& message,
                  const std::string& fix) {
  const int line = file.line(where.begin);
  const int last = where.end > where.begin ? where.end - 1 : where.begin;
  const int end = file.line(last) == line ? file.column(last) + 1 : file.column(where.begin) + 1;
  return {{"severity", severity}, {"line", line},       {"column", file.column(where.begin)},
          {"end", end},           {"message", message}, {"fix", fix}};
}

json messages_json(const SourceFile& file, const Diagnostics& diagnostics) {
  json messages = json::array();
  for (const Diagnostic& d : diagnostics.list)
    messages.push_back(
        message_json(file, d.where, d.severity == Severity::error ? "error" : "warning", d.message, d.fix));
  return messages;
}

json check_spec(const std::string& path) {
  const ReadResult read = SpecsFolder().read(path);
  json answer{{"messages", messages_json(*read.file, read.diagnostics)}, {"dimension", dimension_of(*read.file)}};
  if (read.joint) answer["name"] = read.joint->name;
  return answer;
}

json with_derivation(const std::string& path, const std::function<json(const Derivation&)>& answer) {
  const ReadResult read = SpecsFolder().read(path);
  if (!read.joint) return {{"problems", render(*read.file, read.diagnostics)}};
  try {
    return answer(derive::derive(*read.joint));
  } catch (const NotLinear& error) {
    return refused(read, error.what());
  } catch (const NumberTooLarge& error) {
    return refused(read, error.what());
  }
}

json explain_spec(const std::string& path) {
  return with_derivation(path, [](const Derivation& derivation) {
    const Explanation steps = explain(derivation);
    return json{{"title", steps.title}, {"html", body_of(explanation_html(steps))}};
  });
}

json marks_of_spec(const std::string& path, const JointPose& pose) {
  const ReadResult read = SpecsFolder().read(path);
  if (!read.joint) return {{"problems", render(*read.file, read.diagnostics)}};
  const Joint& joint = *read.joint;
  Sample sample;
  sample.bodies = pose.bodies;
  sample.scalars["time"] = pose.time;
  give_parameters(joint, pose.parameters, sample);
  const Marks marks = marks_of(joint, sample);
  json points = json::array(), arrows = json::array();
  for (const PointMark& point : marks.points)
    for (const std::string& name : names_in(point.name)) points.push_back({{"name", name}, {"at", point.at}});
  for (const ArrowMark& arrow : marks.arrows)
    for (const std::string& name : names_in(arrow.name)) arrows.push_back(arrow_json(name, arrow.from, arrow.along));
  Numbers numbers(sample);  // the arms, from the centre of the body
  for (const Parameter& p : joint.parameters) {
    if (p.kind != derive::ParameterKind::point || p.body < 0) continue;
    const Triple<double>& centre = sample.bodies[static_cast<std::size_t>(p.body)].x;
    arrows.push_back(arrow_json(std::string(p.symbol->symbol), centre, numbers.vector(p.symbol)));
  }
  json forces = json::array();
  for (std::size_t body = 0; body < pose.forces.size(); ++body) {
    const Triple<double>& force = pose.forces[body];
    if (std::hypot(force[0], force[1], force[2]) == 0) continue;
    Triple<double> from = sample.bodies[body].x;
    const auto point = std::ranges::find_if(joint.parameters, [&](const Parameter& p) {
      return p.kind == derive::ParameterKind::point && p.body == static_cast<int>(body);
    });
    if (point != joint.parameters.end()) {
      const Triple<double> arm = numbers.vector(point->symbol);
      for (std::size_t k = 0; k < 3; ++k) from[k] += arm[k];
    }
    forces.push_back({{"from", from}, {"force", force}});
  }
  return {{"points", points}, {"arrows", arrows}, {"forces", forces}};
}

}  // namespace cdot::play
