// The derivation for other programs: every entry as a plain infix expression over documented component names. The
// schema is printed by `cdot explain --help`.
#include <algorithm>
#include <fmt/format.h>
#include <set>

#include "derive/explain/explain.hpp"
#include "derive/explain/formats/symbols.hpp"
#include "derive/expression/components.hpp"
#include "derive/expression/functions.hpp"
#include "derive/expression/shared.hpp"

namespace cdot::derive {
namespace {

using text::Json;

class Infix {
 public:
  explicit Infix(const Joint& joint) : symbols_(joint) {}

  // Names of their own for what recurs in these expressions, if they are long.
  void share(const std::vector<Expr>& scalars) {
    std::vector<Expr> roots;
    for (const Expr e : scalars) roots.push_back(components_.of(e));
    for (const Expr e : shared_parts(roots, [](Expr e) { return !e->name.empty(); })) shared_.insert(&*e);
  }

  std::string of(Expr scalar) { return print(components_.of(scalar), Level::sum); }

  Json of_optional(Expr scalar) { return scalar ? Json(of(scalar)) : Json(); }
  Json of_all(const std::vector<Expr>& scalars) {
    Json list = Json::array();
    for (const Expr e : scalars) list.push_back(of_optional(e));
    return list;
  }
  ExplainedSymbols& names() { return symbols_; }

  const Json& intermediates() const { return intermediates_; }
  const Json& guards() const { return guards_; }
  Json symbols() const { return symbols_.json(); }
  Json frames() const { return symbols_.frames(); }

 private:
  enum class Level { sum, product, power };

  std::string print(Expr e, Level level) {
    if (e->kind == Kind::symbol) return symbols_.name(e);
    const bool shared = shared_.contains(&*e);
    if ((e->name.empty() && !shared) || e->kind == Kind::number) return inline_text(e, level);
    if (const auto found = names_.find(&*e); found != names_.end()) return found->second;
    const std::string definition = inline_text(e, Level::sum);
    std::string name = symbols_.reserve(shared ? "s" + std::to_string(++serial_) : e->name);
    names_.emplace(&*e, name);
    intermediates_.push_back({{"name", name}, {"definition", definition}});
    return name;
  }

  std::string inline_text(Expr e, Level level) {
    switch (e->kind) {
      case Kind::number: return enclosed(e->value.text(), level, e->value.sign() < 0, e->value);
      case Kind::sum: return sum_text(e, level);
      case Kind::product: return product_text(e, level);
      default: return function_text(e, level);
    }
  }

  static std::string enclosed(const std::string& text, Level level, bool negative, Rational value) {
    const bool needs = (negative && level > Level::sum) || (!value.is_integer() && level > Level::sum);
    return needs ? "(" + text + ")" : text;
  }

  std::string sum_text(Expr e, Level level) {
    if (e->args.empty()) return "0";
    std::string out;
    for (std::size_t i = 0; i < e->args.size(); ++i) {
      const Rational c = e->coefs[i];
      out += c.sign() < 0 ? (out.empty() ? "-" : " - ") : (out.empty() ? "" : " + ");
      const bool constant = is_one(e->args[i]);
      if (constant) out += abs(c).text();
      else if (abs(c) != Rational(1)) out += enclosed(abs(c).text(), Level::product, false, c) + "*";
      if (!constant) out += print(e->args[i], Level::product);
    }
    return level > Level::sum ? "(" + out + ")" : out;
  }

  std::string product_text(Expr e, Level level) {
    std::string out;
    for (std::size_t i = 0; i < e->args.size(); ++i) {
      const int k = e->exponents[i];
      const std::string base = print(e->args[i], k == 1 ? Level::product : Level::power);
      out += (out.empty() ? "" : "*") + base + (k == 1 ? "" : "**" + std::to_string(k));
    }
    return level == Level::power ? "(" + out + ")" : out;
  }

  // The mathematics alone; `guards` lists what a kernel does where it is undefined.
  std::string function_text(Expr e, Level level) {
    if (e->fn == Fn::inverse) {
      const std::string below = print(e->args[0], Level::sum);
      guard(below + " = 0", "1/(" + below + ") is taken as 0");
      const std::string out = "1/" + print(e->args[0], Level::power);
      return level > Level::sum ? "(" + out + ")" : out;
    }
    if (e->fn == Fn::select) {
      const std::string where = print(e->args[0], Level::sum) + " = 0";
      const std::string out = print(e->args[1], level);
      guard(where, out + " is taken as " + print(e->args[2], Level::sum));
      return out;
    }
    std::string out = std::string(name_of(e->fn)) + "(";
    for (std::size_t i = 0; i < e->args.size(); ++i) {
      out += (i == 0 ? "" : ", ") + print(e->args[i], Level::sum);
    }
    return out + ")";
  }

  void guard(const std::string& where, const std::string& kernel) {
    if (guarded_.insert(where + kernel).second) guards_.push_back({{"where", where}, {"kernel", kernel}});
  }

  ExplainedSymbols symbols_;
  Components components_;
  std::map<const Node*, std::string> names_;
  std::set<const Node*> shared_;  // looked up only
  int serial_ = 0;                // of their names
  std::set<std::string> guarded_;
  Json intermediates_ = Json::array(), guards_ = Json::array();
};

std::string kind_name(RowKind kind) {
  return kind == RowKind::equality ? "equality" : kind == RowKind::inequality ? "inequality" : "velocity";
}

Json J_of(Infix& infix, const ScalarRow& row) {
  Json entries = Json::array();
  for (const Expr entry : columns_of(row.J)) entries.push_back(infix.of(entry));
  return entries;
}

std::vector<std::string> columns(const Joint& joint) {
  std::vector<std::string> names;
  const std::string letters = joint.dimension == 2 ? "xy" : "xyz";
  for (const std::string& b : joint.bodies) {
    for (const char c : letters) names.push_back("v_" + b + "_" + c);
    if (joint.dimension == 2) names.push_back("w_" + b);
    if (joint.dimension == 2) continue;
    for (const char c : letters) names.push_back("w_" + b + "_" + c);
  }
  return names;
}

void add_expressions(const Block& block, std::vector<Expr>& all) {
  for (const ScalarRow& row : block.rows) {
    all.insert(all.end(), {row.C, row.Cdot, row.C_t, row.gamma});
    for (const Expr entry : columns_of(row.J)) all.push_back(entry);
  }
  for (const auto& K : block.K) all.insert(all.end(), K.begin(), K.end());
}

void add_block(Json& out, Infix& infix, const Block& block) {
  for (const char* key : {"C", "Cdot", "C_t", "J", "K", "gamma"}) out[key] = Json::array();
  for (std::size_t i = 0; i < block.rows.size(); ++i) {
    const ScalarRow& row = block.rows[i];
    out["C"].push_back(infix.of(row.C));
    out["Cdot"].push_back(infix.of(row.Cdot));
    out["C_t"].push_back(infix.of(row.C_t));
    out["J"].push_back(J_of(infix, row));
    out["gamma"].push_back(infix.of(row.gamma));
    Json entries = Json::array();
    for (std::size_t j = 0; j < block.rows.size(); ++j) {
      entries.push_back(infix.of(block.K[std::max(i, j)][std::min(i, j)]));
    }
    out["K"].push_back(std::move(entries));
  }
}

const Unit second = {.s = 1}, joule = {.m = 2, .s = -2, .kg = 1};

// Leaves of the law, under the names of its rows: length, and rate_length.
void name_leaves(Infix& infix, const Joint& joint, const DerivedLaw& law) {
  std::size_t row = 0;
  for (const LawInput& input : joint.law->inputs) {
    const std::size_t rows = input.rate->vector ? static_cast<std::size_t>(joint.dimension) : 1;
    for (std::size_t k = 0; k < rows; ++k, ++row) {
      const std::string name = rows > 1 ? input.name + "_" + "xyz"[k] : input.name;
      infix.names().add_leaf(law.value[row], name, "value", "the value of the row " + name, input.unit);
      infix.names().add_leaf(law.rate[row], "rate_" + name, "rate", "the rate of the row " + name, input.unit / second);
    }
    infix.names().add_leaf(joint.law->mass, "mass", "mass", "the effective mass 1/K of the coordinate",
                           joule * second * second / (input.unit * input.unit));
  }
}

Json law_json(Infix& infix, const Joint& joint, const DerivedLaw& law) {
  name_leaves(infix, joint, law);
  Json out{{"value", infix.of_all(law.value)},
           {"rate", infix.of_all(law.rate)},
           {"energy", infix.of_optional(law.energy)},
           {"force", infix.of_all(law.force)},
           {"unstored", infix.of_all(law.unstored)},
           {"stiffness", Json::array()},
           {"damping", Json::array()}};
  for (const std::vector<Expr>& row : law.stiffness) out["stiffness"].push_back(infix.of_all(row));
  for (const std::vector<Expr>& row : law.damping) out["damping"].push_back(infix.of_all(row));
  return out;
}

Json bound_json(Infix& infix, const Joint& joint, const BoundedRow& row, const DerivedBound& bound) {
  const auto known = std::ranges::find(joint.coordinates, row.coordinate, &Coordinate::name);
  const Unit unit = known == joint.coordinates.end() ? joint.law->free->unit : known->unit;
  const auto add = [&](Expr leaf, const char* before, const char* kind, const std::string& of, const Unit& its) {
    infix.names().add_leaf(leaf, before + of, kind, fmt::format("the {} of {}", kind, of), its);
  };
  add(row.value, "", "value", row.coordinate, unit);
  add(row.own_rate, "rate_", "rate", row.coordinate, unit / second);
  add(row.own_load, "force_", "force", row.name, joule / unit);
  return {{"name", row.name},
          {"text", row.text},
          {"coordinate", row.coordinate},
          {"rate", infix.of_optional(bound.rate)},
          {"lower", infix.of_optional(bound.lower)},
          {"upper", infix.of_optional(bound.upper)},
          {"by_lower", infix.of_optional(bound.by_lower)},
          {"by_upper", infix.of_optional(bound.by_upper)},
          {"after", infix.of_optional(row.after)},
          {"until", infix.of_optional(row.until)}};
}

// The law and the bounds of an effect, beside its rows: null and none without them.
void add_effect(Json& out, Infix& infix, const Derivation& derivation) {
  const Joint& joint = derivation.joint;
  out["law"] = derivation.law ? law_json(infix, joint, *derivation.law) : Json();
  out["bounds"] = Json::array();
  for (std::size_t i = 0; i < derivation.bounded.size(); ++i)
    out["bounds"].push_back(bound_json(infix, joint, joint.law->bounded[i], derivation.bounded[i]));
}

}  // namespace

std::string explanation_json(const Derivation& derivation) {
  const Joint& joint = derivation.joint;
  Infix infix(joint);
  std::vector<Expr> expressions;
  add_expressions(derivation.rows, expressions);
  for (const Block& block : derivation.coordinates) add_expressions(block, expressions);
  infix.share(expressions);
  Json rows, coordinates = Json::array();
  rows["rows"] = Json::array();
  for (const ScalarRow& row : derivation.rows.rows) {
    rows["rows"].push_back(
        {{"name", row.name}, {"kind", kind_name(row.kind)}, {"text", row.row->text}, {"unit", text(row.row->unit)}});
  }
  add_block(rows, infix, derivation.rows);
  for (std::size_t i = 0; i < joint.coordinates.size(); ++i) {
    const Coordinate& c = joint.coordinates[i];
    Json out{{"name", c.name}, {"text", c.text}, {"unit", text(c.unit)}};
    if (c.by_rate) out["kind"] = kind_name(RowKind::velocity);
    add_block(out, infix, derivation.coordinates[i]);
    coordinates.push_back(std::move(out));
  }
  Json effect;
  add_effect(effect, infix, derivation);
  Json all{{"format", 1},
           {"joint", joint.name},
           {"title", joint.title},
           {"source", joint.source},
           {"dimension", joint.dimension},
           {"bodies", joint.bodies},
           {"columns", columns(joint)},
           {"symbols", infix.symbols()},
           {"frames", infix.frames()}};
  all["intermediates"] = infix.intermediates();
  all["guards"] = infix.guards();
  all.update(rows);
  all["coordinates"] = std::move(coordinates);
  all.update(effect);
  return all.dump(2) + "\n";
}

}  // namespace cdot::derive
