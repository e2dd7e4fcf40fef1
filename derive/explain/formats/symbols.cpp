// The meaning, unit and frame of each name; components that turn with a body follow from its angle.
#include "derive/explain/formats/symbols.hpp"

#include <array>
#include <utility>

#include "derive/expression/functions.hpp"

namespace cdot::derive {
namespace {

constexpr std::array reserved = {"False",  "None",  "True",   "and",      "as",    "assert",  "async",
                                 "await",  "break", "class",  "continue", "def",   "del",     "elif",
                                 "else",   "for",   "except", "from",     "if",    "finally", "global",
                                 "import", "in",    "is",     "lambda",   "not",   "or",      "nonlocal",
                                 "pass",   "raise", "return", "try",      "while", "with",    "yield"};

std::string spoken_kind(const Parameter& p) {
  switch (p.kind) {
    case ParameterKind::point: return p.body < 0 ? "the point " + p.name : "the arm of the point " + p.name;
    case ParameterKind::vector: return "the vector " + p.name;
    case ParameterKind::unit: return "the direction " + p.name + " (length 1)";
    case ParameterKind::frame: return " axis of the frame " + p.name + " (length 1)";
    case ParameterKind::scalar: break;
  }
  return "the number " + p.name + (p.range.empty() ? "" : ", " + p.range);
}

}  // namespace

ExplainedSymbols::ExplainedSymbols(const Joint& joint)
    : bodies_(joint.bodies), letters_(joint.dimension == 2 ? "xy" : "xyz") {
  for (const char* word : reserved) taken_.insert(word);
  for (const Function& f : functions) {
    if (!f.guard) taken_.emplace(f.name);
  }
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
  const auto or_null = [](const std::string& s) { return s.empty() ? text::Json() : text::Json(s); };
  docs_[name] = {{"kind", doc.kind},
                 {"meaning", doc.meaning},
                 {"unit", doc.unit},
                 {"frame", or_null(doc.frame)},
                 {"body", or_null(doc.body)},
                 {"from", or_null(doc.from)},
                 {"unit_length", doc.unit_length}};
}

void ExplainedSymbols::add_body(const std::string& b) {
  const bool plane = letters_.size() == 2;
  add_components("x_" + b, {"position", "the centre of mass of " + b, "m", "world", b, "", false});
  if (plane)
    add("theta_" + b, "theta_" + b, {"position", "angle of " + b + ", unwrapped", "rad", "world", b, "", false});
  else add_orientation(b);
  add_components("v_" + b, {"velocity", "the velocity of the centre of mass of " + b, "m/s", "world", b, "", false});
  const Doc spin{"velocity", "angular velocity of " + b, "rad/s", "world", b, "", false};
  const Doc inertia{"mass",
                    "inverse inertia of " + b + " about its centre of mass; 0 if it cannot turn",
                    "1/(kg*m^2)",
                    plane ? "" : "world",
                    b,
                    "",
                    false};
  if (plane) add("w_" + b, "w_" + b, spin);
  else add_components("w_" + b, spin);
  add("inv_m_" + b, "inv_m_" + b, {"mass", "inverse mass of " + b + "; 0 if it cannot move", "1/kg", "", b, "", false});
  if (plane) return add("inv_I_" + b, "inv_I_" + b, inertia);
  for (const std::string ij : {"xx", "yy", "zz", "xy", "xz", "yz"}) {
    Doc entry = inertia;
    entry.meaning = ij + " of the symmetric tensor: " + inertia.meaning;
    add("inv_I_" + b + "_" + ij, "inv_I_" + b + "_" + ij, entry);
  }
}

// Euler parameters, and the rotation matrix that follows from them.
void ExplainedSymbols::add_orientation(const std::string& b) {
  std::vector<std::string> e;
  for (const std::string k : {"0", "1", "2", "3"}) {
    e.push_back("e_" + b + "_" + k);
    add(e.back(), e.back(),
        {"orientation", "Euler parameter e" + k + " of " + b + ", a unit quaternion", "1", "world", b, "", false});
    e.back() = names_.at(e.back());
  }
  const auto twice = [&](int i, int j, const char* sign, int k, int l) {
    const auto at = [&](int n) { return e[static_cast<std::size_t>(n)]; };
    return "2*(" + at(i) + "*" + at(j) + sign + at(k) + "*" + at(l) + ")";
  };
  const auto diagonal = [&](int k) {
    std::string square = e[0] + "**2";
    for (int i = 1; i <= 3; ++i) square += (i == k ? " + " : " - ") + e[static_cast<std::size_t>(i)] + "**2";
    return square;
  };
  const std::string from[3][3] = {{diagonal(1), twice(1, 2, " - ", 0, 3), twice(1, 3, " + ", 0, 2)},
                                  {twice(1, 2, " + ", 0, 3), diagonal(2), twice(2, 3, " - ", 0, 1)},
                                  {twice(1, 3, " - ", 0, 2), twice(2, 3, " + ", 0, 1), diagonal(3)}};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const std::string ij{"xyz"[i], "xyz"[j]}, name = "A_" + b + "_" + ij;
      add(name, name, {"derived", ij + " of the rotation matrix of " + b, "1", "world", b, from[i][j], false});
    }
  }
}

// `doc` with the letter of the component in front of its meaning.
void ExplainedSymbols::add_components(const std::string& stem, const Doc& doc) {
  for (const char letter : letters_) {
    Doc component = doc;
    component.meaning = std::string(1, letter) + " of " + doc.meaning;
    add(stem + "_" + letter, stem + "_" + letter, component);
  }
}

void ExplainedSymbols::add_parameter(const Joint& joint, const Parameter& p) {
  const std::string unit = text(p.unit), meaning = spoken_kind(p);
  if (p.kind == ParameterKind::scalar) {
    const std::string& leaf = p.symbol->symbol;
    return add(leaf, leaf, {"parameter", meaning, unit, "", "", "", false});
  }
  const bool frame = p.kind == ParameterKind::frame;
  std::vector<std::vector<std::string>> triad;
  for (const Expr axis : p.axes.empty() ? std::vector{p.symbol} : p.axes) {
    const std::string letter(1, letters_[triad.size()]);
    const std::string what = frame ? "the " + letter + meaning : meaning;
    triad.push_back(
        add_direction(joint, p, axis->symbol, {"parameter", what, unit, "world", "", "", p.symbol->unit_length}));
  }
  if (!p.axes.empty()) frames_.push_back({{"name", p.name}, {"axes", triad}});
}

// The names of the numbers that are given: components in the world, or in the frame of the body it is fixed in.
std::vector<std::string> ExplainedSymbols::add_direction(const Joint& joint, const Parameter& p,
                                                         const std::string& leaf, Doc doc) {
  std::vector<std::string> given;
  if (p.body < 0) {
    add_components(leaf, doc);
    for (const char letter : letters_) given.push_back(names_.at(leaf + "_" + letter));
    return given;
  }
  const bool point = p.kind == ParameterKind::point;
  doc.body = doc.frame = joint.bodies[static_cast<std::size_t>(p.body)];
  const std::string local = (point ? p.name : leaf) + "_local";
  add_components(local, doc);
  for (const char letter : letters_) given.push_back(names_.at(local + "_" + letter));
  doc.kind = "derived";
  doc.frame = "world";
  add_turned(leaf, point ? "r_" + p.name : leaf, given, doc);
  return given;
}

// Components in world axes follow from those in the body's by its rotation.
void ExplainedSymbols::add_turned(const std::string& leaf, const std::string& wish,
                                  const std::vector<std::string>& given, const Doc& doc) {
  std::vector<std::string> from;
  if (letters_.size() == 2) {
    const std::string c = "cos(theta_" + doc.body + ")*", s = "sin(theta_" + doc.body + ")*";
    from = {c + given[0] + " - " + s + given[1], s + given[0] + " + " + c + given[1]};
  } else {
    for (const char i : letters_) {
      std::string sum;
      for (std::size_t j = 0; j < 3; ++j) {
        sum += (j == 0 ? "" : " + ") + names_.at("A_" + doc.body + "_" + i + letters_[j]) + "*" + given[j];
      }
      from.push_back(sum);
    }
  }
  for (std::size_t k = 0; k < letters_.size(); ++k) {
    Doc component = doc;
    component.meaning = std::string(1, letters_[k]) + " of " + doc.meaning;
    component.from = from[k];
    add(leaf + "_" + letters_[k], wish + "_" + letters_[k], component);
  }
}

// The only leaves that are not known beforehand: the axes of bodies, and pi.
void ExplainedSymbols::add_axis(Expr symbol) {
  const std::string& leaf = symbol->symbol;
  if (symbol->role == Role::constant) {
    return add(leaf, leaf, {"constant", "half the turn of a circle", "rad", "", "", "", false});
  }
  const std::string& body = bodies_.at(static_cast<std::size_t>(symbol->body));
  const char component = leaf.back();
  Doc doc{"derived", std::string(1, component) + " of the x axis of " + body,       "1", "world",
          body,      (component == 'x' ? "cos(theta_" : "sin(theta_") + body + ")", true};
  if (letters_.size() == 3) {  // axis_a_x_y is an entry of the rotation matrix
    const char axis = leaf[leaf.size() - 3];
    doc.meaning = std::string(1, component) + " of the " + axis + " axis of " + body;
    doc.from = names_.at("A_" + body + "_" + component + axis);
  }
  add(leaf, leaf, doc);
}

void ExplainedSymbols::add_leaf(Expr leaf, const std::string& wish, const std::string& kind, const std::string& meaning,
                                const Unit& unit) {
  if (leaf && !names_.contains(leaf->symbol))
    add(leaf->symbol, wish, {kind, meaning, derive::text(unit), "", "", "", false});
}

std::string ExplainedSymbols::name(Expr symbol) {
  if (!names_.contains(symbol->symbol)) add_axis(symbol);
  return names_.at(symbol->symbol);
}

}  // namespace cdot::derive
