#include "tests/derive/random/random_specs.hpp"

#include <algorithm>
#include <functional>
#include <vector>

#include "tests/derive/random/vocabulary.hpp"

namespace cdot::test {
namespace {

constexpr std::size_t most_lines = 40;

class Author {
 public:
  explicit Author(std::uint64_t seed) : Author(seed, derive::Random(~seed)) {}

  RandomSpec spec(const std::string& name) {
    declare();
    const std::string theme = write_theme();
    const std::size_t rows = 1 + words_.pick(words_.chance(0.3) ? 5 : 2);
    for (std::size_t i = 0; i < rows; ++i) write_row();
    if (words_.chance(0.4))
      lines_.push_back("coordinate free [m] = dot(" + words_.unit_vector() + ", " + words_.displacement(1) + ")");
    lines_.resize(std::min(lines_.size(), most_lines - 2));
    RandomSpec spec{name, "", theme, words_.chance(1.0 / 6) ? make_a_mistake() : ""};
    spec.text = "joint " + name + (words_.planar() ? " planar" : " spatial") + "\n  \"A random joint.\"\n";
    for (const std::string& line : lines_) spec.text += "  " + line + "\n";
    return spec;
  }

 private:
  Author(std::uint64_t seed, derive::Random shape)
      : words_(seed, shape.bits() % 2 == 0 ? 2 : 3, 2 + static_cast<int>(shape.bits() % 8) / 3) {}

  void declare() {
    for (const std::string& body : words_.bodies) {
      declare("point", "p" + body, body, words_.points);
      if (words_.chance(0.3)) declare("point", "q" + body, body, words_.points);
      if (words_.chance(0.4)) declare("unit", "t" + body, body, words_.units);
      if (words_.chance(words_.planar() ? 0.2 : 1)) declare("frame", "f" + body, body, words_.frames);
      if (words_.chance(0.2)) declare("vector", "s" + body + " [m]", body, words_.vectors);
    }
    if (words_.chance(0.15)) declare("point", "ground", "world", words_.points);
    for (std::string& vector : words_.vectors) vector = vector.substr(0, 2);
    scalar("l", "m", words_.lengths, 2);
    scalar("k", "1", words_.numbers, 2);
    scalar("phi", "rad", words_.angles, 1);
    if (words_.chance(0.2)) {
      lines_.push_back("scalar rate [rad/s]");
      words_.angles.push_back("rate*time");
    }
  }

  void declare(const std::string& kind, const std::string& name, const std::string& body,
               std::vector<std::string>& names) {
    lines_.push_back(kind + " " + name + " on " + body);
    names.push_back(name);
  }

  void scalar(const std::string& name, const std::string& unit, std::vector<std::string>& names, std::size_t most) {
    static const std::vector<std::string> ranges = {"", "", " above 0", " between 0.1 and 3"};
    for (std::size_t i = words_.pick(most + 1); i > 0; --i) {
      names.push_back(name + std::to_string(i));
      lines_.push_back("scalar " + names.back() + " [" + unit + "]" + words_.one_of(ranges));
    }
  }

  // The part that makes the spec unusual.
  std::string write_theme() {
    static const std::vector<std::pair<std::string, std::function<void(Author&)>>> themes = {
        {"plain", [](Author& a) { a.few_names(); }},
        {"nested numbers", [](Author& a) { a.nested_numbers(); }},
        {"nested lengths", [](Author& a) { a.nested_lengths(); }},
        {"nested vectors", [](Author& a) { a.nested_vectors(); }},
        {"long sum", [](Author& a) { a.long_sum(); }},
        {"deep product", [](Author& a) { a.deep_product(); }},
        {"included", [](Author& a) { a.included(); }},
        {"deep operators", [](Author& a) { a.depth_ = 4; }}};
    const auto& [name, write] = themes[words_.pick(themes.size())];
    write(*this);
    if (!special_.empty()) lines_.push_back("special: " + special_);
    return name;
  }

  void let(const std::string& name, const std::string& value, std::vector<std::string>& names) {
    lines_.push_back("let " + name + " = " + value);
    names.push_back(name);
  }

  void few_names() {
    if (words_.chance(0.7)) let("dist", words_.displacement(1), words_.displacements);
    if (words_.chance(0.5)) let("h", words_.length(2), words_.lengths);
    if (words_.chance(0.5)) let("share", words_.number(2), words_.numbers);
    if (words_.chance(0.3)) let("alpha", words_.angle(1), words_.angles);
  }

  // Each name stands more than once in the next one. `#` is the name before, `@` the one before that.
  void nested(const std::string& first, const std::vector<std::string>& steps, std::vector<std::string>& names) {
    let("u0", first, names);
    const std::size_t room = most_lines - 10 - std::min<std::size_t>(lines_.size(), most_lines - 18);
    const std::size_t count = 8 + words_.pick(room - 7);
    for (std::size_t i = 1; i <= count; ++i) {
      const std::string before = "u" + std::to_string(i - 1), earlier = "u" + std::to_string(i < 2 ? 0 : i - 2);
      std::string value;
      for (const char c : words_.one_of(steps)) value += c == '#' ? before : c == '@' ? earlier : std::string(1, c);
      let("u" + std::to_string(i), value, names);
    }
    names = {names.back()};
  }

  void nested_numbers() {
    static const std::vector<std::string> steps = {"sin(#)*cos(#)",     "#/(1 + #^2)",           "sqrt(1 + #^2)*sin(#)",
                                                   "exp(-#^2)*#",       "sin(# + @)*cos(# - @)", "(# - #^3/6)/2",
                                                   "log(2 + #^2) - #/2"};
    const std::vector<std::string> always = {steps[words_.pick(steps.size())]};
    nested(words_.number(1), words_.chance(0.5) ? always : steps, words_.numbers);
    special_ = words_.numbers.back() + "*norm(pa - pb) = " + words_.length(0);
  }

  void nested_lengths() {
    nested(words_.length(1),
           {"sqrt(#^2 + @^2)/2", "#*sin(#/(1 [m]))", "#*@/(1 [m] + norm(pa - pb))", "norm(pa - pb)*cos(#/(1 [m]))"},
           words_.lengths);
    special_ = words_.lengths.back() + " = norm(pa - pb)";
  }

  void nested_vectors() {
    const std::string t = words_.unit_vector();
    const std::vector<std::string> both = {"dot(#, " + t + ")*" + t + " - #/2", "(# + norm(#)*" + t + ")/2",
                                           "(norm(@)*unit(#) + @)/3"};
    std::vector<std::string> steps = both;
    steps.push_back(words_.planar() ? "perp(#)/2 + @/2" : "cross(#, " + t + ")/2 + @/2");
    nested(words_.difference_of_points(), steps, words_.displacements);
    special_ = (words_.chance(0.5) ? "norm(" : "dot(" + words_.unit_vector() + ", ") + words_.displacements.back() +
               ") = 1 [m]";
  }

  std::string joined(std::size_t count, const std::string& between, const std::function<std::string()>& part) {
    std::string text = part();
    for (std::size_t i = 1; i < count; ++i) text += between + part();
    return text;
  }

  void long_sum() {
    if (words_.chance(0.5))
      let("sum", joined(10 + words_.pick(30), " + ", [&] { return words_.number(2); }), words_.numbers);
    else let("sum", joined(10 + words_.pick(30), " - ", [&] { return words_.length(1); }), words_.lengths);
    special_ = "sum" + std::string(words_.numbers.empty() || words_.numbers.back() != "sum" ? "" : "*norm(pa - pb)") +
               " = " + (words_.lengths.empty() || words_.lengths[0] == "sum" ? "1 [m]" : words_.lengths[0]);
  }

  void deep_product() {
    let("product", joined(4 + words_.pick(12), "*", [&] { return "(1 + " + words_.number(1) + ")"; }), words_.numbers);
    if (words_.chance(0.5)) let("power", "(1 + product)^" + std::to_string(2 + words_.pick(11)), words_.numbers);
    special_ = words_.numbers.back() + "*norm(pa - pb) = " + words_.length(0);
  }

  void included() {
    static const std::vector<std::string> planar = {"line", "revolute", "pulley", "weld", "distance", "prismatic"};
    static const std::vector<std::string> spatial = {"spherical", "p1",     "n1",         "universal",
                                                     "distance",  "slider", "swing_twist"};
    const std::string& part = words_.one_of(words_.planar() ? planar : spatial);
    const std::string last = words_.bodies.back();
    lines_.push_back("include " + part + "(a, " + last + ") as part");
    depth_ = 0;
  }

  void write_row() {
    const std::string sign = words_.chance(0.15) ? " <= " : words_.chance(0.1) ? " >= " : " = ";
    lines_.push_back("row" + std::to_string(++rows_) + ": " + row(sign, depth_ + static_cast<int>(words_.pick(2))));
  }

  std::string row(const std::string& sign, int depth) {
    const auto [one, other] = words_.two_bodies();
    const std::string apart = "p" + one + " - p" + other;
    switch (words_.pick(words_.planar() ? 9 : 10)) {
      case 0: return "norm(" + apart + ")" + sign + words_.length(depth);
      case 1: return "dot(" + words_.axis_of(one) + ", " + words_.axis_of(other) + ")" + sign + words_.number(depth);
      case 2: return "angle(" + words_.axis_of(one) + ", " + words_.axis_of(other) + ")" + sign + words_.angle(depth);
      case 3: return "dot(" + words_.axis_of(one) + ", " + apart + " + " + words_.displacement(depth) + ") = 0";
      case 4: return "norm(" + words_.displacement(depth) + ")" + sign + words_.length(0);
      case 5: return "p" + one + " = p" + other;
      case 6: return "velocity dot(v(p" + one + ") - v(p" + other + "), " + words_.direction(depth) + ") = 0";
      case 7: return apart + " = " + words_.displacement(depth);
      case 8: return words_.number(depth) + "*norm(" + apart + ")" + sign + words_.length(0);
      default: return "cross(f" + one + ".x, " + words_.axis_of(other) + ") = 0 keep 2";
    }
  }

  // Puts a mistake of a typist into a line; returns its name.
  std::string make_a_mistake() {
    std::string& line = lines_[words_.pick(lines_.size())];
    const auto replaced = [&](const std::string& what, const std::string& by) {
      const std::size_t at = line.find(what);
      if (at == line.npos) return false;
      line.replace(at, what.size(), by);
      return true;
    };
    switch (words_.pick(6)) {
      case 0:
        if (replaced(")", "")) return "a bracket is missing";
        break;
      case 1:
        if (replaced("norm(", "lenght(") || replaced("sin(", "sine(")) return "an unknown operator";
        break;
      case 2:
        if (replaced(" = ", " == ")) return "a sign of another language";
        break;
      case 3:
        if (replaced("pa", "paa")) return "an unknown name";
        break;
      case 4: line += " 0.5.5"; return "a number too many";
      default: break;
    }
    lines_.push_back("mixed: norm(pa - pb) + 1 [rad] = 0");
    return "units that do not fit";
  }

  Vocabulary words_;
  std::vector<std::string> lines_;
  std::string special_;  // a row about the theme
  int depth_ = 1, rows_ = 0;
};

}  // namespace

RandomSpec random_spec(std::uint64_t seed) { return Author(seed).spec("spec_" + std::to_string(seed)); }

}  // namespace cdot::test
