// The verdicts of `cdot diff` over the catalogue: right derivations, also rewritten, agree; with one mistake they
// differ. An oracle of its own decides which are right: the numbers of the matrices at random poses, up to the freedom
// that an author has.
#include <cctype>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <gtest/gtest.h>
#include <regex>

#include "derive/derivation/derivation.hpp"
#include "derive/diff/terms.hpp"
#include "derive/numbers/numeric.hpp"
#include "tests/derive/diff/support.hpp"

namespace cdot::test {
namespace {

using namespace derive;
namespace fs = std::filesystem;

using Rows = std::vector<std::vector<Expr>>;

// The whole derivation of a joint.
struct Paper {
  Rows C, J, K, b;
};

struct Subject {
  std::string name;  // "planar/line"
  Joint joint;
  std::vector<int> equation;  // of each row
  Paper right;
};

Subject subject_of(const std::string& name) {
  const SpecsFolder folder(specs_folder());
  Derivation derivation = derive::derive(*folder.read(folder.find(name)).joint);
  Subject s{name, derivation.joint, {}, {}};
  const std::vector<ScalarRow>& rows = derivation.rows.rows;
  const Row* before = nullptr;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    s.equation.push_back(i > 0 && rows[i].row == before ? s.equation.back() : static_cast<int>(i));
    before = rows[i].row;
    s.right.C.push_back({rows[i].C});
    s.right.J.push_back(columns_of(rows[i].J));
    s.right.b.push_back({-rows[i].Cdot});
    s.right.K.emplace_back();
    for (std::size_t j = 0; j < rows.size(); ++j)
      s.right.K[i].push_back(derivation.rows.K[std::max(i, j)][std::min(i, j)]);
  }
  return s;
}

// Replaces whole words. In vectors, a word goes with its component: axis_a_x becomes a.x.
enum class In { scalars, vectors };
void replace(std::string& s, const std::string& word, const std::string& by, In in = In::scalars) {
  const auto in_word = [&](std::size_t at) {
    return at < s.size() && (std::isalnum(static_cast<unsigned char>(s[at])) != 0 || s[at] == '_');
  };
  for (std::size_t at = 0; (at = s.find(word, at)) != s.npos;) {
    const std::string part = in == In::vectors ? s.substr(at + word.size(), 2) : "";
    const std::size_t end = at + word.size() + part.size();
    const bool fits = in == In::scalars || part == "_x" || part == "_y" || part == "_z";
    if (!fits || in_word(at - 1) || in_word(end)) {
      ++at;
      continue;
    }
    const std::string text = part.empty() ? by : by + "." + part[1];
    s.replace(at, end - at, text);
    at += text.size();
  }
}

// An expression in the language of .hand files.
std::string in_hand(Expr e, const Joint& joint) {
  std::string s = " " + text_unnamed(e) + " ";
  for (const std::string& body : joint.bodies) {
    replace(s, "inv_m_" + body, "(1/m(" + body + "))");
    replace(s, "inv_I_" + body, joint.dimension == 2 ? "(1/I(" + body + "))" : "(I(" + body + ")^-1)");
    for (const char* stem : {"x", "v", "w"})
      replace(s, std::string(stem) + "_" + body, fmt::format("{}({})", stem, body));
    replace(s, "theta_" + body, "angle(" + body + ")");
    replace(s, "axis_" + body, body, In::vectors);
  }
  for (const Parameter& p : joint.parameters) {
    if (p.kind == ParameterKind::frame) replace(s, p.name, p.name, In::vectors);
    if (p.kind == ParameterKind::point && p.body >= 0) replace(s, p.symbol->symbol, "arm(" + p.name + ")");
  }
  return s;
}

std::string in_hand(const Rows& rows, const Joint& joint) {
  std::string s = "[";
  for (const auto& row : rows) {
    if (&row != &rows[0]) s += ";";
    for (std::size_t c = 0; c < row.size(); ++c) s += (c ? "," : "") + in_hand(row[c], joint);
  }
  return s + "]";
}

bool is_positional(const Subject& s) {
  for (const auto& row : s.right.C)
    if (is_zero(row[0])) return false;
  return true;
}

// The entry of a paper; `only`: of one quantity, or of all.
std::string entry_of(const Subject& s, const Paper& p, const std::string& only = "") {
  std::string text;
  for (const auto& [what, rows] :
       {std::pair("C", &p.C), std::pair("J", &p.J), std::pair("K", &p.K), std::pair("b", &p.b)}) {
    if (!only.empty() && only != what) continue;
    if (*what == 'C' && !is_positional(s)) continue;  // a velocity row has no C
    text += fmt::format("  {} = {}\n", what, in_hand(*rows, s.joint));
  }
  return text;
}

std::vector<Expr> flat(const Rows& rows) {
  std::vector<Expr> all;
  for (const auto& row : rows) all.insert(all.end(), row.begin(), row.end());
  return all;
}

bool same_numbers(const Subject& s, const Rows& a, const Rows& b) {
  if (a.size() != b.size() || a[0].size() != b[0].size()) return false;
  std::vector<Expr> both = flat(a), other = flat(b);
  const std::size_t half = both.size();
  both.insert(both.end(), other.begin(), other.end());
  for (std::uint64_t seed = 50000; seed < 50004; ++seed) {
    const std::vector<double> v = values_at(both, random_sample(s.joint, both, seed));
    for (std::size_t i = 0; i < half; ++i)
      if (std::abs(v[i] - v[half + i]) > 1e-9 * (1 + std::abs(v[i]))) return false;
  }
  return true;
}

// The paper with equations times +-1, one bit of the pattern per equation.
Paper with_signs(const Subject& s, const Paper& of, unsigned pattern) {
  Paper p = of;
  const auto sign = [&](std::size_t row) { return Rational((pattern >> s.equation[row]) & 1 ? -1 : 1); };
  for (std::size_t r = 0; r < p.J.size(); ++r) {
    for (Rows* rows : {&p.C, &p.J, &p.b})
      for (Expr& e : (*rows)[r]) e = sign(r) * e;
    for (std::size_t c = 0; c < p.K[r].size(); ++c) p.K[r][c] = sign(r) * sign(c) * p.K[r][c];
  }
  return p;
}

// The paper with its rows from the last to the first.
Paper backwards(Paper p) {
  for (Rows* rows : {&p.C, &p.J, &p.K, &p.b}) std::ranges::reverse(*rows);
  for (auto& row : p.K) std::ranges::reverse(row);
  return p;
}

// The paper of 2 C: of all equations, in C, J and b twice and in K four times.
Paper doubled(Paper p) {
  for (const auto& [rows, factor] : {std::pair(&p.C, 2), std::pair(&p.J, 2), std::pair(&p.b, 2), std::pair(&p.K, 4)})
    for (auto& row : *rows)
      for (Expr& e : row) e = Rational(factor) * e;
  return p;
}

Rows& rows_of(Paper& p, const std::string& what) {
  return what == "J" ? p.J : what == "K" ? p.K : what == "b" ? p.b : p.C;
}

// One quantity alone is right if it is that of some choice of signs.
bool is_right_alone(const Subject& s, Paper p, const std::string& what) {
  for (unsigned pattern = 0; pattern < (1u << s.right.J.size()); ++pattern) {
    Paper right = with_signs(s, s.right, pattern);
    if (same_numbers(s, rows_of(p, what), rows_of(right, what))) return true;
  }
  return false;
}

Rows substituted(Rows rows, const std::map<const Node*, Expr>& by) {
  for (auto& row : rows)
    for (Expr& e : row) e = substitute(e, by, KeepNames::no);
  return rows;
}

struct Mistake {
  const char* name;
  const char* in;  // the quantity
  std::function<void(const Subject&, Rows&)> make;
};

// The first entry that is not zero, from the middle on: others than the corner are hit as well.
Expr& some_entry(Rows& rows) {
  const std::size_t columns = rows[0].size(), count = rows.size() * columns;
  for (std::size_t k = 0; k < count; ++k) {
    Expr& e = rows[(count / 2 + k) % count / columns][(count / 2 + k) % count % columns];
    if (!is_zero(e)) return e;
  }
  return rows[0][0];
}

Expr first_arm(const Subject& s, std::size_t skip) {
  for (const Parameter& p : s.joint.parameters)
    if (p.kind == ParameterKind::point && p.body >= 0 && skip-- == 0) return p.symbol;
  return {};
}

const std::vector<Mistake>& mistakes() {
  const auto entry = [](Expr (*change)(Expr)) {
    return [change](const Subject&, Rows& rows) { some_entry(rows) = change(some_entry(rows)); };
  };
  const auto bodies = [](auto pick, bool both) {
    return [pick, both](const Subject& s, Rows& rows) {
      if (s.joint.bodies.size() < 2) return;
      const Expr one = pick(body_symbols(s.joint, 0)), other = pick(body_symbols(s.joint, 1));
      std::map<const Node*, Expr> by = {{&*one, other}};
      if (both) by.emplace(&*other, one);
      rows = substituted(rows, by);
    };
  };
  const auto arm = [](std::size_t which, auto change) {
    return [which, change](const Subject& s, Rows& rows) {
      const Expr ra = first_arm(s, which), rb = first_arm(s, 1 - which);
      if (ra && rb) rows = substituted(rows, {{&*ra, change(ra, rb)}});
    };
  };
  const auto mass = [](auto change) {
    return [change](const Subject& s, Rows& rows) {
      for (std::size_t b = 0; b < s.joint.bodies.size(); ++b) {
        const Expr m = body_symbols(s.joint, static_cast<int>(b)).inv_m;
        rows = substituted(rows, {{&*m, change(m)}});
      }
    };
  };
  static const std::vector<Mistake> all = {
      {"a sign in J", "J", entry([](Expr e) { return -e; })},
      {"a sign in b", "b", entry([](Expr e) { return -e; })},
      {"a sign in C", "C",
       [](const Subject&, Rows& rows) { rows.back()[0] = rows.back()[0] + rows.back()[0]->pool->number(1); }},
      {"an entry of J is missing", "J", entry([](Expr e) { return e->pool->number(0); })},
      {"an entry of J is doubled", "J", entry([](Expr e) { return Rational(2) * e; })},
      {"an entry of J has an extra term", "J", entry([](Expr e) { return e + e->pool->number(1); })},
      {"an entry of K is missing", "K", entry([](Expr e) { return e->pool->number(0); })},
      {"an entry of K is halved", "K", entry([](Expr e) { return Rational(1, 2) * e; })},
      {"a sign in K", "K", entry([](Expr e) { return -e; })},
      {"signs off the diagonal of K", "K",
       [](const Subject&, Rows& rows) {
         for (std::size_t r = 0; r < rows.size(); ++r)
           for (std::size_t c = 0; c < rows.size(); ++c)
             if (r != c) rows[r][c] = -rows[r][c];
       }},
      {"exchanged masses in K", "K", bodies([](const BodySymbols& b) { return b.inv_m; }, true)},
      {"exchanged inertias in K", "K", bodies([](const BodySymbols& b) { return b.inv_I; }, true)},
      {"one inertia for both in K", "K", bodies([](const BodySymbols& b) { return b.inv_I; }, false)},
      {"one w for both in b", "b", bodies([](const BodySymbols& b) { return b.w; }, false)},
      {"another arm in J", "J", arm(0, [](Expr, Expr rb) { return rb; })},
      {"half of an arm in J", "J", arm(1, [](Expr rb, Expr) { return Rational(1, 2) * rb; })},
      {"an arm with the wrong sign in K", "K", arm(1, [](Expr rb, Expr) { return -rb; })},
      {"masses for inverse masses", "K", mass([](Expr m) { return pow(m, -1); })},
      {"masses are missing", "K", mass([](Expr m) { return m->pool->number(0); })},
      {"exchanged rows of K", "K", [](const Subject&, Rows& rows) { std::swap(rows.front(), rows.back()); }},
      {"exchanged bodies in J", "J",
       [](const Subject& s, Rows& rows) {
         const std::size_t width = columns_per_body(s.joint.dimension);
         if (s.joint.bodies.size() > 1)
           for (auto& row : rows)
             std::swap_ranges(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(width),
                              row.begin() + static_cast<std::ptrdiff_t>(width));
       }},
      {"w before v in J", "J",
       [](const Subject& s, Rows& rows) {
         const auto width = static_cast<std::ptrdiff_t>(columns_per_body(s.joint.dimension));
         for (auto& row : rows)
           for (auto at = row.begin(); at != row.end(); at += width)
             std::rotate(at, at + s.joint.dimension, at + width);
       }},
  };
  return all;
}

// In space, joints of many rows, or with long formulas, take a second a verdict: each has a few of the mistakes.
const std::vector<std::string> slow = {
    "spatial/universal",   "spatial/revolute_n1",          "spatial/hinge",
    "spatial/fixed",       "spatial/relative_orientation",

    "spatial/cylindrical",

    "spatial/prismatic",   "spatial/planar_joint",         "spatial/screw",
    "spatial/surface",     "spatial/swing_twist",          "spatial/constant_velocity",
    "spatial/rolling_disc"};

bool is_tried(const Subject& s, std::size_t mistake) {
  constexpr std::size_t share = 7;
  const auto place = static_cast<std::size_t>(std::ranges::find(slow, s.name) - slow.begin());
  return place == slow.size() || mistake % share == place % share;
}

// All joints but those made of others here without rows of their own: lesson_example, revolute and slider.
std::vector<std::string> catalogue() {
  std::vector<std::string> names = {"spatial/cone",
                                    "spatial/n1",
                                    "spatial/distance",
                                    "spatial/max_distance",
                                    "spatial/n2",
                                    "spatial/point_on_plane",
                                    "spatial/point_on_line",
                                    "spatial/rack_and_pinion",
                                    "spatial/gear",
                                    "spatial/pulley",
                                    "spatial/spherical_spherical",
                                    "spatial/p1",
                                    "spatial/p2",
                                    "spatial/spherical",
                                    "spatial/driven",
                                    "spatial/rolling_sphere"};
  names.insert(names.end(), slow.begin(), slow.end());
  for (const fs::path& spec : SpecsFolder(specs_folder()).all())
    if (spec.parent_path().filename() == "planar")
      names.push_back(spec.parent_path().filename().string() + "/" + spec.stem().string());
  return names;
}

class Verdicts : public testing::TestWithParam<std::string> {};

TEST_P(Verdicts, AreThoseOfTheOracle) {
  const Subject s = subject_of(GetParam());
  if (s.right.J.empty()) return;
  EXPECT_NE(judged(s.name, entry_of(s, s.right)).agreement, Agreement::differs) << s.name << " as it is";
  Paper expanded = s.right;
  for (Rows* rows : {&expanded.C, &expanded.J, &expanded.K})
    for (auto& row : *rows)
      for (Expr& e : row) e = derive::sum_of(terms_of_expansion(e, s.joint, Opened::everything), *s.joint.pool);
  EXPECT_NE(judged(s.name, entry_of(s, expanded)).agreement, Agreement::differs) << s.name << " expanded";
  EXPECT_NE(judged(s.name, entry_of(s, with_signs(s, s.right, 0x5555u))).agreement, Agreement::differs)
      << s.name << " with signs";
  EXPECT_NE(judged(s.name, entry_of(s, backwards(s.right))).agreement, Agreement::differs) << s.name << " backwards";
  if (is_positional(s)) {
    EXPECT_NE(judged(s.name, entry_of(s, doubled(s.right))).agreement, Agreement::differs) << s.name << " doubled";
  }
  for (const Mistake& mistake : mistakes()) {
    if (!is_tried(s, static_cast<std::size_t>(&mistake - mistakes().data()))) continue;
    Paper wrong = s.right;
    Rows& rows = rows_of(wrong, mistake.in);
    if (*mistake.in == 'C' && !is_positional(s)) continue;
    mistake.make(s, rows);
    Paper as_it_was = s.right;
    const bool right = same_numbers(s, rows, rows_of(as_it_was, mistake.in));
    EXPECT_EQ(judged(s.name, entry_of(s, wrong)).agreement != Agreement::differs, right)
        << s.name << ": " << mistake.name;
    if (*mistake.in == 'C' || *mistake.in == 'b') continue;
    EXPECT_EQ(judged(s.name, entry_of(s, wrong, mistake.in)).agreement != Agreement::differs,
              is_right_alone(s, wrong, mistake.in))
        << s.name << ": " << mistake.name << ", alone";
  }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, Verdicts, testing::ValuesIn(catalogue()),
                         [](const auto& info) { return std::regex_replace(info.param, std::regex("/"), "_"); });

}  // namespace
}  // namespace cdot::test
