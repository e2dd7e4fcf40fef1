// Expressions as infix text in the spec language's own notation.
#include "derive/expression/expr.hpp"

namespace cdot::derive {
namespace {

enum Level { in_sum = 0, in_product = 1, in_power = 2 };

class Printer {
 public:
  explicit Printer(bool use_names) : use_names_(use_names) {}

  std::string print(Expr e, Level level, bool root) const {
    if (!root && use_names_ && !e->name.empty()) return e->name;
    switch (e->kind) {
      case Kind::number: return number(e->value, level);
      case Kind::symbol: return e->symbol;
      case Kind::sum: return sum_text(e, level);
      case Kind::product: return product_text(e, level);
      case Kind::scale: return wrap(arg(e, 0, in_product) + "*" + arg(e, 1, in_product), level >= in_power);
      case Kind::function: return call(std::string(name_of(e->fn)), e);
      case Kind::dot: return dot_text(e);
      case Kind::cross: return call("cross", e);
      case Kind::perp: return call("perp", e);
      case Kind::tensor: return wrap(arg(e, 0, in_product) + "*" + arg(e, 1, in_product), level >= in_power);
      case Kind::twist: return "twist(" + frame(e, 0) + ", " + frame(e, 3) + ")";
      case Kind::norm: return call("norm", e);
      case Kind::unit: return call("unit", e);
    }
    return "";
  }

 private:
  static std::string wrap(std::string s, bool parentheses) { return parentheses ? "(" + s + ")" : s; }
  static std::string number(Rational r, Level level) {
    return wrap(r.text(), (r.sign() < 0 && level > in_sum) || (!r.is_integer() && level >= in_power));
  }
  std::string arg(Expr e, std::size_t i, Level level) const { return print(e->args[i], level, false); }

  std::string call(std::string name, Expr e) const {
    name += "(";
    for (std::size_t i = 0; i < e->args.size(); ++i) name += (i ? ", " : "") + arg(e, i, in_sum);
    return name + ")";
  }

  // Products with the world's axes are components: u.x, u.y, u.z.
  std::string dot_text(Expr e) const {
    const std::vector<Expr> axes = world_axes(*e->pool);
    for (std::size_t i = 0; i < 2; ++i) {
      for (std::size_t k = 0; k < axes.size(); ++k) {
        if (e->args[i] == axes[k]) return arg(e, 1 - i, in_power) + "." + "xyz"[k];
      }
    }
    return call("dot", e);
  }

  // The name of a triad, from that of its x axis.
  std::string frame(Expr e, std::size_t first) const {
    const std::string x_axis = arg(e, first, in_sum);
    return x_axis.substr(0, x_axis.size() - 2);
  }

  std::string sum_text(Expr e, Level level) const {
    if (e->args.empty()) return "0";
    std::string s;
    // The first positive term leads: a sum should not open with a minus sign without need.
    std::size_t lead = 0;
    while (lead < e->args.size() && e->coefs[lead].sign() < 0) ++lead;
    if (lead == e->args.size()) lead = 0;
    append_term(e, lead, s);
    for (std::size_t i = 0; i < e->args.size(); ++i) {
      if (i != lead) append_term(e, i, s);
    }
    return wrap(s, level >= in_product);
  }

  void append_term(Expr e, std::size_t i, std::string& s) const {
    const Rational c = e->coefs[i];
    const Expr a = e->args[i];
    s += s.empty() ? (c.sign() < 0 ? "-" : "") : (c.sign() < 0 ? " - " : " + ");
    if (is_one(a)) {
      s += abs(c).text();
    } else {
      if (abs(c) != Rational(1)) s += abs(c).text() + "*";
      s += print(a, in_product, false);
    }
  }

  std::string product_text(Expr e, Level level) const {
    std::string above, below;
    int under = 0;
    for (std::size_t i = 0; i < e->args.size(); ++i) {
      const int k = e->exponents[i];
      std::string& side = k > 0 ? above : below;
      if (k < 0) ++under;
      const int magnitude = k > 0 ? k : -k;
      const std::string base = print(e->args[i], magnitude > 1 ? in_power : in_product, false);
      side += (side.empty() ? "" : "*") + base;
      if (magnitude > 1) side += "^" + std::to_string(magnitude);
    }
    if (above.empty()) above = "1";
    if (!below.empty()) above += "/" + wrap(below, under > 1);
    return wrap(above, level >= in_power);
  }

  bool use_names_;
};

}  // namespace

std::string text(Expr e) { return Printer(true).print(e, in_sum, true); }
std::string text_unnamed(Expr e) { return Printer(false).print(e, in_sum, true); }

}  // namespace cdot::derive
