// include: another spec's declarations, rows and coordinates, on other bodies and under a prefix
// where asked for.
#include <algorithm>

#include "derive/elaborate.hpp"
#include "derive/symbols.hpp"

namespace cdot::derive {
namespace {

constexpr int most_includes = 64;

}  // namespace

void Elaborator::include(Source& source, const IncludeAst& item) {
  if (!includable(source, item)) return;
  Source inner;
  inner.file = library_.at(item.joint.text);
  inner.include = in_spec(source, item.where);
  inner.including = source.including;
  inner.including.push_back(item.joint.text);
  inner.prefix = source.prefix + (item.prefix.text.empty() ? "" : item.prefix.text + "_");
  parse_source(inner);
  if (!inner.diagnostics.has_errors() && !same_space(source, item, inner)) return;
  if (!inner.diagnostics.has_errors() && map_bodies(source, item, inner)) statements(inner);
  report_included(source, item, inner);
  if (!source.include) joint_.includes.push_back(item.joint.text);
}

bool Elaborator::includable(Source& source, const IncludeAst& item) {
  const std::string& name = item.joint.text;
  Diagnostics& d = source.diagnostics;
  const auto& way = source.including;
  if (std::find(way.begin(), way.end(), name) != way.end()) {
    std::string circle;
    for (const std::string& step : way) circle += step + " includes ";
    error(source, item.joint.where, "includes go in a circle: " + circle + name,
          "remove one of them");
    return false;
  }
  if (++include_count_ > most_includes) {
    if (include_count_ == most_includes + 1)
      d.error(item.joint.where, "more than 64 includes, counting those of the included joints");
    return false;
  }
  if (library_.contains(name)) return true;
  std::vector<std::string> known;
  for (const auto& [other, file] : library_) known.push_back(other);
  const std::string near = nearest(name, known);
  d.error(item.joint.where, "there is no joint " + quote(name) + " to include",
          near.empty() ? "put " + name + ".joint beside this file"
                       : "did you mean " + quote(near) + "?");
  return false;
}

bool Elaborator::same_space(Source& source, const IncludeAst& item, const Source& inner) {
  const std::string here = name_of_space(joint_.dimension);
  if (inner.ast.dimension == here) return true;
  error(source, item.joint.where,
        "a " + here + " joint cannot include the " + inner.ast.dimension + " joint " +
            quote(item.joint.text),
        "include a " + here + " one");
  return false;
}

// a, b, ... of the included joint are the bodies given in brackets.
bool Elaborator::map_bodies(Source& source, const IncludeAst& item, Source& inner) {
  inner.bodies = source.bodies;
  if (item.bodies.empty()) return true;
  inner.bodies.clear();
  SourceNames names(*this, source);
  for (const Word& word : item.bodies) {
    const int body = names.body(word.text);
    if (body < 0) {
      source.diagnostics.error(word.where, "there is no body " + quote(word.text),
                               "bodies are a, b, c, ... up to h");
      return false;
    }
    names.use_body(body, word.where);
    inner.bodies.push_back(body);
  }
  return true;
}

// Mistakes inside the included file are told once, with their place.
void Elaborator::report_included(Source& source, const IncludeAst& item, const Source& inner) {
  const auto& list = inner.diagnostics.list;
  const auto first = std::find_if(
      list.begin(), list.end(), [](const Diagnostic& d) { return d.severity == Severity::error; });
  if (first == list.end() || inner.clashed) return;
  const SourceFile& file = *inner.file;
  const int at = first->where.begin;
  source.diagnostics.error(item.joint.where,
                           "the included joint has a mistake: " + file.path + ":" +
                               std::to_string(file.line(at)) + ":" +
                               std::to_string(file.column(at)) + ": " + first->message,
                           first->fix);
}

}  // namespace cdot::derive
