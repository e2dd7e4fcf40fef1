// include: another spec's declarations, rows and coordinates, on other bodies and under a prefix where asked for.
#include <algorithm>

#include "derive/expression/symbols.hpp"
#include "derive/language/elaborate.hpp"

namespace cdot::derive {
namespace {

constexpr int most_includes = 64;

}  // namespace

void Elaborator::include(Source& source, const IncludeAst& item) {
  if (!includable(source, item)) return;
  Source inner;
  inner.file = library_.at(item.joint.text);
  included_.push_back(inner.file);
  inner.include = in_spec(source, item.where);
  inner.including = source.including;
  inner.including.push_back(item.joint.text);
  inner.prefix = source.prefix + (item.prefix.text.empty() ? "" : item.prefix.text + "_");
  parse_source(inner);
  if (!inner.diagnostics.has_errors() && !same_space(source, item, inner)) return;
  if (!inner.diagnostics.has_errors() && map_bodies(source, item, inner)) {
    give_parameters(source, item, inner);
    statements(inner);
    check_given(source, item, inner);
  }
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
    error(source, item.joint.where, "includes form a cycle: " + circle + name, "remove one of these includes");
    return false;
  }
  if (++include_count_ > most_includes) {
    if (include_count_ == most_includes + 1)
      d.error(item.joint.where, "the joint has more than 64 includes, counting those of the included joints");
    return false;
  }
  if (library_.contains(name)) return true;
  std::vector<std::string> known;
  for (const auto& [other, file] : library_) known.push_back(other);
  const std::string near = nearest(name, known);
  d.error(item.joint.where, "there is no joint " + quote(name) + " to include",
          near.empty() ? "put " + name + ".joint beside this file" : "did you mean " + quote(near) + "?");
  return false;
}

bool Elaborator::same_space(Source& source, const IncludeAst& item, const Source& inner) {
  const std::string here = name_of_space(joint_.dimension);
  if (inner.ast.dimension == here) return true;
  error(source, item.joint.where,
        "a " + here + " joint cannot include the " + inner.ast.dimension + " joint " + quote(item.joint.text),
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
      source.diagnostics.error(word.where, "there is no body " + quote(word.text), "bodies are a, b, c, ... up to h");
      return false;
    }
    names.use_body(body, word.where);
    inner.bodies.push_back(body);
  }
  return true;
}

void Elaborator::give_parameters(Source& source, const IncludeAst& item, Source& inner) {
  for (const DeclaredAst& d : item.given) {
    if (d.broken || !d.value) continue;
    const Span where = d.value->where;
    std::string text = source.file->text.substr(static_cast<std::size_t>(where.begin),
                                                static_cast<std::size_t>(where.end - where.begin));
    const bool one = d.value->kind == Ast::Kind::name || d.value->kind == Ast::Kind::call ||
                     d.value->kind == Ast::Kind::member || d.value->kind == Ast::Kind::number;
    if (!one) text = "(" + text + ")";
    of_world_ = false;
    Given given{evaluate(source, *d.value), text};
    given.of_world = of_world_;
    const bool is_new = inner.given.emplace(d.name.text, std::move(given)).second;
    if (!is_new) source.diagnostics.error(d.name.where, quote(d.name.text) + " is given twice", "remove one");
  }
}

void Elaborator::check_given(Source& source, const IncludeAst& item, const Source& inner) {
  std::vector<std::string> parameters;
  for (const StatementAst& s : inner.ast.statements)
    if (s.kind == StatementAst::Kind::declare) parameters.push_back(s.declared.name.text);
  for (const DeclaredAst& d : item.given) {
    const auto given = inner.given.find(d.name.text);
    if (given == inner.given.end() || given->second.taken) continue;
    const std::string near = nearest(d.name.text, parameters);
    source.diagnostics.error(d.name.where, quote(item.joint.text) + " declares no parameter " + quote(d.name.text),
                             near.empty() ? "" : "did you mean " + quote(near) + "?");
  }
}

// The including joint gives this parameter a value: it becomes a name for that value, and a scene cannot set it.
bool Elaborator::take_given(Source& source, const DeclaredAst& d) {
  const auto found = source.given.find(d.name.text);
  if (found == source.given.end()) return false;
  found->second.taken = true;
  Value value = found->second.value;
  if (value.type == Type::poison) {
    enter(source, source.prefix + d.name.text, d.kind, value, d.name.where);
    return true;
  }
  const Type wanted = d.kind == "point"    ? Type::point
                      : d.kind == "scalar" ? Type::scalar
                      : d.kind == "frame"  ? Type::frame
                                           : Type::vector;
  const bool arm = wanted == Type::point && value.anchored;
  if (value.type != wanted || (wanted == Type::point && !arm) || !value.along.empty()) {
    error(source, d.name.where, "the " + d.kind + " " + quote(d.name.text) + " cannot be " + found->second.text,
          wanted == Type::point ? "give a declared point" : "give " + std::string(in_words(wanted)));
    return true;
  }
  if (d.unit && !same_unit(scalar(Expr(), d.unit->unit), value)) {
    error(source, d.name.where,
          quote(d.name.text) + " is in " + spoken(d.unit->unit) + ", its given value in " + spoken(*value.unit));
    return true;
  }
  if (d.kind == "unit" && !value.e->unit_length) value.e = unit(value.e);
  const std::string full = source.prefix + d.name.text;
  if (arm) enter(source, arm_name(source.prefix, d.name.text), "arm", vector(value.arm, value.unit), d.name.where);
  if (name_is_free(source, d.name, full)) enter(source, full, d.kind, value, d.name.where, found->second.of_world);
  return true;
}

// Reports the first error inside the included file, with its place.
void Elaborator::report_included(Source& source, const IncludeAst& item, const Source& inner) {
  const auto& list = inner.diagnostics.list;
  const auto first =
      std::find_if(list.begin(), list.end(), [](const Diagnostic& d) { return d.severity == Severity::error; });
  if (first == list.end() || inner.clashed) return;
  const SourceFile& file = *inner.file;
  const int at = first->where.begin;
  source.diagnostics.error(item.joint.where,
                           "the included joint has an error: " + file.path + ":" + std::to_string(file.line(at)) + ":" +
                               std::to_string(file.column(at)) + ": " + first->message,
                           first->fix);
}

}  // namespace cdot::derive
