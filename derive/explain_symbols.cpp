// What each name means, in which unit and frame, and how what turns with a body follows from its
// angle.
#include "derive/explain_symbols.hpp"

#include <array>

namespace cdot::derive {
namespace {

constexpr std::array reserved = {
    "False",    "None",     "True",   "and",    "as",   "assert", "async",  "await",  "break",
    "class",    "continue", "def",    "del",    "elif", "else",   "for",    "except", "from",
    "if",       "finally",  "global", "import", "in",   "is",     "lambda", "not",    "or",
    "nonlocal", "pass",     "raise",  "return", "try",  "while",  "with",   "yield",  "sqrt",
    "sin",      "cos",      "tan",    "atan2",  "exp",  "log",    "abs",    "sign"};

const char* component_name(int axis) { return axis == 0 ? "x" : "y"; }

std::string spoken_kind(const Parameter& p) {
  switch (p.kind) {
    case ParameterKind::point:
      return p.body < 0 ? "the point " + p.name : "the arm of the point " + p.name;
    case ParameterKind::vector:
      return "the vector " + p.name;
    case ParameterKind::unit:
      return "the direction " + p.name + " (length 1)";
    case ParameterKind::frame:
      return "the x axis of the frame " + p.name + " (length 1)";
    case ParameterKind::scalar:
      break;
  }
  return "the number " + p.name;
}

}  // namespace

ExplainedSymbols::ExplainedSymbols(const Joint& joint) : bodies_(joint.bodies) {
  for (const char* word : reserved) taken_.insert(word);
  for (const std::string& body : joint.bodies) add_body(body);
  for (const Parameter& p : joint.parameters) add_parameter(joint, p);
  if (joint.uses_time) add("time", "time", {"time", "time", "s", "", "", "", false});
}

std::string ExplainedSymbols::reserve(const std::string& wish) {
  std::string name = wish;
  while (!taken_.insert(name).second) name += "_";
  return name;
}

void ExplainedSymbols::add(const std::string& leaf, const std::string& wish, const Doc& doc) {
  const std::string name = reserve(wish);
  names_.emplace(leaf, name);
  const auto or_null = [](const std::string& s) {
    return s.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(s);
  };
  docs_[name] = {{"kind", doc.kind},
                 {"meaning", doc.meaning},
                 {"unit", doc.unit},
                 {"frame", or_null(doc.frame)},
                 {"body", or_null(doc.body)},
                 {"from", or_null(doc.from)},
                 {"unit_length", doc.unit_length}};
}

void ExplainedSymbols::add_body(const std::string& b) {
  for (const std::string axis : {"x", "y"}) {
    const std::string name = "x_" + b + "_" + axis;
    add(name, name,
        {"position", axis + " of the centre of mass of " + b, "m", "world", b, "", false});
  }
  add("theta_" + b, "theta_" + b,
      {"position", "angle of " + b + ", unwrapped", "rad", "world", b, "", false});
  for (const std::string axis : {"x", "y"}) {
    const std::string name = "v_" + b + "_" + axis;
    add(name, name,
        {"velocity", axis + " of the velocity of the centre of mass of " + b, "m/s", "world", b, "",
         false});
  }
  add("w_" + b, "w_" + b, {"velocity", "angular velocity of " + b, "rad/s", "world", b, "", false});
  add("inv_m_" + b, "inv_m_" + b,
      {"mass", "inverse mass of " + b + "; 0 if it cannot move", "1/kg", "", b, "", false});
  add("inv_I_" + b, "inv_I_" + b,
      {"mass", "inverse inertia of " + b + " about its centre of mass; 0 if it cannot turn",
       "1/(kg*m^2)", "", b, "", false});
}

void ExplainedSymbols::add_parameter(const Joint& joint, const Parameter& p) {
  const std::string unit = text(p.unit), meaning = spoken_kind(p), leaf = p.symbol->symbol;
  if (p.kind == ParameterKind::scalar) {
    return add(leaf, leaf, {"parameter", meaning, unit, "", "", "", false});
  }
  if (p.body < 0) {
    for (int k = 0; k < 2; ++k) {
      const std::string axis = component_name(k), name = leaf + "_" + axis;
      add(name, name,
          {"parameter", axis + " of " + meaning, unit, "world", "", "", p.symbol->unit_length});
    }
    return;
  }
  const std::string& body = joint.bodies[static_cast<std::size_t>(p.body)];
  const bool point = p.kind == ParameterKind::point;
  add_turning(leaf, point ? "r_" + p.name : leaf, (point ? p.name : leaf) + "_local",
              {"derived", meaning, unit, "world", body, "", p.symbol->unit_length});
}

// Components in the body's frame are the parameter; those in world axes follow by the rotation
// through theta.
void ExplainedSymbols::add_turning(const std::string& leaf, const std::string& wish,
                                   const std::string& local, Doc doc) {
  std::array<std::string, 2> parameter;
  for (int k = 0; k < 2; ++k) {
    parameter[static_cast<std::size_t>(k)] = local + "_" + component_name(k);
    const std::string& name = parameter[static_cast<std::size_t>(k)];
    add(name, name,
        {"parameter", component_name(k) + (" of " + doc.meaning), doc.unit, doc.body, doc.body, "",
         doc.unit_length});
  }
  const auto names = [&](std::size_t k) { return names_.at(parameter[k]); };
  const std::string c = "cos(theta_" + doc.body + ")*", s = "sin(theta_" + doc.body + ")*";
  const std::string from[] = {c + names(0) + " - " + s + names(1),
                              s + names(0) + " + " + c + names(1)};
  for (int k = 0; k < 2; ++k) {
    Doc component = doc;
    component.meaning = component_name(k) + (" of " + doc.meaning);
    component.from = from[k];
    add(leaf + "_" + component_name(k), wish + "_" + component_name(k), component);
  }
}

// The only leaves that are not known beforehand: the axes of bodies, and pi.
void ExplainedSymbols::add_axis(Expr symbol) {
  const std::string& leaf = symbol->symbol;
  if (symbol->role == Role::constant) {
    return add(leaf, leaf, {"constant", "half the turn of a circle", "rad", "", "", "", false});
  }
  const std::string& body = bodies_.at(static_cast<std::size_t>(symbol->body));
  const bool x = leaf.ends_with("_x");
  add(leaf, leaf,
      {"derived", std::string(x ? "x" : "y") + " of the x axis of " + body, "1", "world", body,
       (x ? "cos(theta_" : "sin(theta_") + body + ")", true});
}

std::string ExplainedSymbols::name(Expr symbol) {
  if (!names_.contains(symbol->symbol)) add_axis(symbol);
  return names_.at(symbol->symbol);
}

}  // namespace cdot::derive
