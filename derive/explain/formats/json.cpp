// The derivation for other programs: every entry as a plain infix expression over documented component names. The
// schema is printed by `cdot explain --help`.
#include <algorithm>
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
  return all.dump(2) + "\n";
}

}  // namespace cdot::derive
