// Both sides of a judged formula as tables of MathML, vectors as vectors, with their wrong entries marked.
#include <algorithm>
#include <fmt/format.h>

#include "derive/diff/entry.hpp"
#include "derive/diff/terms.hpp"
#include "derive/explain/formats/mathml.hpp"
#include "runtime/text/html.hpp"

namespace cdot::derive {
namespace {

constexpr int most_leaves = 400;  // of a typeset entry; a longer one is plain text

constexpr int most_opened = 60;  // of one that is tried in components

int leaves_in(const Formula& f) {
  int count = 1;
  for (const Formula& arg : f.args) count += leaves_in(arg);
  return count;
}

bool mentions_world_axis(const Formula& f) {
  if (f.shape == Shape::leaf && f.leaf && f.leaf->vector && !world_axis(f.leaf).empty()) return true;
  return std::ranges::any_of(f.args, mentions_world_axis);
}

// The vector whose component along `axis` is f: u × v of (u × v).x, and of 2 (u × v).x its double.
std::optional<Formula> vector_behind(const Formula& f, const std::string& axis) {
  if (f.shape == Shape::component) return f.name == axis ? std::optional(f.args[0]) : std::nullopt;
  if (f.shape != Shape::sum && f.shape != Shape::quotient && f.shape != Shape::product) return std::nullopt;
  const std::size_t parts = f.shape == Shape::quotient ? 1 : f.args.size();
  Formula whole = f;
  std::size_t found = 0;
  for (std::size_t i = 0; i < parts; ++i) {
    const std::optional<Formula> part = vector_behind(f.args[i], axis);
    if (part) whole.args[i] = *part, ++found;
  }
  return found == (f.shape == Shape::sum ? parts : 1) ? std::optional(std::move(whole)) : std::nullopt;
}

// The components of one vector, side by side, as this vector; none if they are anything else.
std::optional<Formula> vector_of(const std::vector<Formula>& components) {
  if (components.size() < 2 || components.size() > 3) return std::nullopt;
  const bool alike = std::ranges::all_of(components, [&](const Formula& f) { return f == number(0); });
  if (alike) return number(0);
  const std::optional<Formula> first = vector_behind(components[0], "x");
  for (std::size_t k = 1; first && k < components.size(); ++k) {
    if (vector_behind(components[k], std::string(1, "xyz"[k])) != first) return std::nullopt;
  }
  return first ? std::optional(shaped(Shape::transpose, *first)) : std::nullopt;
}

// Columns v_a.x and v_a.y stand under one heading v_a.
std::vector<Group> headings(const std::vector<Group>& columns) {
  std::vector<Group> merged;
  const auto stem = [](const std::string& name) { return name.substr(0, name.find('.')); };
  for (const Group& g : columns) {
    const bool joins = !merged.empty() && g.name.find('.') != g.name.npos && merged.back().name == stem(g.name);
    if (joins) merged.back().count += g.count;
    else merged.push_back({g.first, g.count, stem(g.name)});
  }
  return merged;
}

// Writes the formulas of an entry and collects the names in them.
class Typesetter {
 public:
  explicit Typesetter(Entry& entry) : entry_(entry), notation_(entry.joint) {}

  // (r × world.x).y reads better as r.z.
  Formula formula(Expr e) const {
    const Formula f = notation_.of(e);
    const int leaves = leaves_in(f);
    if (leaves > most_opened || !mentions_world_axis(f)) return f;
    const Formula opened = notation_.of(sum_of(terms_of_expansion(e, entry_.joint, Opened::nothing), *e->pool));
    return leaves_in(opened) < leaves ? opened : f;
  }

  std::string html(Expr e) { return html(formula(e), e); }
  std::string html(const Formula& f, Expr otherwise) {
    if (leaves_in(f) > most_leaves)
      return fmt::format("<code>{}</code>",
                         text::html_escaped(in_names_of_spec(brief_text(otherwise, entry_.joint), entry_.joint)));
    name_all(f);
    return in_mathml(f, entry_.joint.bodies);
  }

 private:
  // "u = pa - pb", once for each name that the formulas need.
  void name_all(const Formula& f) {
    for (const Formula& arg : f.args) name_all(arg);
    if (f.shape != Shape::leaf || !f.leaf || !Notation::has_name(f.leaf)) return;
    const Formula definition = notation_.definition(f.leaf);
    if (definition == f || leaves_in(definition) > most_leaves) return;
    std::vector<std::string>& names = entry_.verdict.names;
    const std::string said = in_mathml(f, entry_.joint.bodies) + " = " + in_mathml(definition, entry_.joint.bodies);
    if (std::ranges::find(names, said) != names.end()) return;
    names.push_back(said);
    name_all(definition);
  }

  Entry& entry_;
  Notation notation_;
};

struct Marked {
  const Matrix& matrix;
  const std::vector<bool>& wrong;
  std::string_view mark;  // the class of its wrong entries
};

class Table {
 public:
  Table(Typesetter& typesetter, const Sides& sides, const Marked& m)
      : typesetter_(typesetter), sides_(sides), m_(m), columns_(headings(sides.columns)) {}

  std::string html() const {
    std::string out = "<table class=\"sheet\">" + head();
    for (const Group& rows : sides_.rows) {
      for (int r = rows.first; r < rows.first + rows.count; ++r) out += row(rows, r);
    }
    return out + "</table>";
  }

 private:
  // The only row needs no number.
  bool has_row_names() const {
    const std::string& first = sides_.rows[0].name;
    return m_.matrix.rows > 1 || (!first.empty() && first != "1");
  }

  std::string head() const {
    if (m_.matrix.columns == 1) return "";
    std::string out = has_row_names() ? "<tr><th></th>" : "<tr>";
    const bool velocities = sides_.what == "J" || sides_.what == "update";
    for (const Group& g : columns_) {
      const std::string name = velocities ? in_mathml(leaf({}, g.name), {}) : text::html_escaped(g.name);
      out += fmt::format("<th scope=\"col\"{}>{}</th>", span(g.count), name);
    }
    return out + "</tr>\n";
  }

  std::string row(const Group& rows, int r) const {
    std::string out = "<tr>";
    if (has_row_names() && r == rows.first)
      out +=
          fmt::format("<th scope=\"row\"{}>{}</th>", rows.count > 1 ? fmt::format(" rowspan=\"{}\"", rows.count) : "",
                      text::html_escaped(rows.name));
    for (const Group& columns : columns_) out += cells(r, columns);
    return out + "</tr>\n";
  }

  // One cell for a vector of which all components are right or all wrong.
  std::string cells(int r, const Group& columns) const {
    std::vector<Formula> components;
    int wrong = 0;
    for (int c = columns.first; c < columns.first + columns.count; ++c) {
      components.push_back(typesetter_.formula(m_.matrix.at(r, c)));
      wrong += is_wrong(r, c) ? 1 : 0;
    }
    const bool one_mark = wrong == 0 || wrong == columns.count;
    if (const std::optional<Formula> vector = vector_of(components); vector && one_mark)
      return cell(columns.count, wrong > 0, typesetter_.html(*vector, m_.matrix.at(r, columns.first)));
    std::string out;
    for (int c = columns.first; c < columns.first + columns.count; ++c) {
      out += cell(1, is_wrong(r, c), typesetter_.html(m_.matrix.at(r, c)));
    }
    return out;
  }

  std::string cell(int columns, bool wrong, const std::string& content) const {
    return fmt::format("<td{}{}>{}</td>", wrong ? fmt::format(" class=\"{}\"", m_.mark) : "", span(columns), content);
  }

  bool is_wrong(int r, int c) const { return m_.wrong[static_cast<std::size_t>(r * m_.matrix.columns + c)]; }
  static std::string span(int columns) { return columns > 1 ? fmt::format(" colspan=\"{}\"", columns) : ""; }

  Typesetter& typesetter_;
  const Sides& sides_;
  Marked m_;
  std::vector<Group> columns_;
};

// A matrix without a counterpart, by the numbers of its rows.
std::string plain_table(Typesetter& typesetter, const Matrix& m, bool wrong) {
  const std::vector<bool> marks(m.entries.size(), wrong);
  std::vector<Group> rows, columns;
  for (int r = 0; r < m.rows; ++r) rows.push_back({r, 1, m.rows > 1 ? std::to_string(r + 1) : ""});
  for (int c = 0; c < m.columns; ++c) columns.push_back({c, 1, std::to_string(c + 1)});
  return Table(typesetter, {"", m, m, rows, columns}, {m, marks, "wrong"}).html();
}

}  // namespace

void show(Entry& entry, const Sides& sides, const std::vector<bool>& wrong) {
  if (!entry.with_sheets) return;
  Typesetter typesetter(entry);
  const std::string published = Table(typesetter, sides, {sides.published, wrong, "wrong"}).html();
  const std::string generated = Table(typesetter, sides, {sides.generated, wrong, "right"}).html();
  entry.verdict.sheets.push_back({sides.what, published, generated});
}

void show_apart(Entry& entry, const std::string& what, const HandItem& item, const Matrix* published,
                const Matrix* generated) {
  if (!entry.with_sheets) return;
  Typesetter typesetter(entry);
  const std::string as_written = "<table class=\"sheet\"><tr><td class=\"wrong\"><code>" +
                                 text::html_escaped(item.text) + "</code></td></tr></table>";
  entry.verdict.sheets.push_back({what, published ? plain_table(typesetter, *published, true) : as_written,
                                  generated ? plain_table(typesetter, *generated, false) : ""});
}

}  // namespace cdot::derive
