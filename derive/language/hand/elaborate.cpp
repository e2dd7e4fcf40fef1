// An entry of a hand derivation: its trees to matrices of expressions.
#include <algorithm>

#include "derive/language/hand/names.hpp"
#include "derive/syntax/lexer.hpp"

namespace cdot::derive {
namespace {

using Kind = HandItemAst::Kind;

// A likely reading of a formula that has no value.
struct OtherAst {
  Ast ast;
  std::string words;   // "with w(b) in place of v(b)"
  std::string column;  // "w_b"
};

// `node` is a part of `whole`.
void exchange(Ast& whole, Ast& node, std::vector<OtherAst>& found) {
  const bool velocity = node.text == "v" || node.text == "w";
  if (node.kind == Ast::Kind::call && velocity && node.args.size() == 1) {
    const std::string written = node.text, of = "(" + node.args[0].text + ")";
    node.text = written == "v" ? "w" : "v";
    found.push_back(
        {whole, "with " + node.text + of + " in place of " + written + of, node.text + "_" + node.args[0].text});
    node.text = written;
  }
  for (Ast& arg : node.args) exchange(whole, arg, found);
}

// The formula with one velocity as an angular velocity, or the other way round, wherever there is one.
std::vector<OtherAst> with_velocities_exchanged(const Ast& ast) {
  std::vector<OtherAst> found;
  Ast whole = ast;
  exchange(whole, whole, found);
  return found;
}

class EntryElaborator {
 public:
  EntryElaborator(const HandEntryAst& ast, const HandFile& file, const ReadResult& read, const GeneratedRows& generated,
                  Diagnostics& diagnostics)
      : ast_(ast),
        file_(file),
        joint_(*read.joint),
        pool_(*read.joint->pool),
        names_(ast, file, read, generated),
        diagnostics_(diagnostics) {
    entry_.id = ast.id;
    entry_.title = ast.title;
    entry_.source = ast.source;
    entry_.note = ast.note;
    entry_.listed = ast.listed;
    entry_.anchors = ast.anchors;
    entry_.immovable = ast.immovable;
    entry_.form = form_named(ast.form);
    entry_.where = ast.where;
  }

  HandEntry run() {
    if (entry_.form != Form::global && joint_.dimension == 2)
      diagnostics_.error(ast_.where, "the form " + quote(ast_.form) + " is one of spatial joints");
    begin_part({});
    for (const HandItemAst& item : ast_.items)
      if (!item.broken) elaborate(item);
    for (Diagnostic& d : findings_.list)
      if (d.severity == Severity::warning) entry_.remarks.push_back(std::move(d));
    std::erase_if(entry_.parts, [](const HandPart& p) { return p.items.empty(); });
    return std::move(entry_);
  }

 private:
  void elaborate(const HandItemAst& item);
  void let(const HandItemAst& item);
  void free(const HandItemAst& item);
  void rows(const HandItemAst& item);
  void assume(const HandItemAst& item);
  void quantity(const HandItemAst& item);
  void update(const HandItemAst& item);
  void claim(const HandItemAst& item);
  void bound(const HandItemAst& item);
  std::vector<HandReading> readings(const Ast& ast);

  void begin_part(std::vector<std::string> rows);
  // Of v and w of each body in a row of J.
  std::vector<int> widths_of_J() const {
    std::vector<int> widths;
    for (std::size_t i = 0; i < joint_.bodies.size(); ++i) {
      widths.push_back(joint_.dimension);
      widths.push_back(joint_.dimension == 2 ? 1 : entry_.form == Form::euler ? 4 : 3);
    }
    return widths;
  }
  Value evaluate(const Ast& ast, bool rows_of_J = false);
  void store(const Value& v, std::optional<Matrix>& matrix, Expr& expression);
  std::string problem(const Ast& ast, std::size_t since) const;
  std::size_t findings() const { return findings_.list.size(); }
  HandItem begin(const HandItemAst& item, HandItem::Kind kind) const;

  const HandEntryAst& ast_;
  const HandFile& file_;
  const Joint& joint_;
  Pool& pool_;
  HandNames names_;
  Diagnostics& diagnostics_;
  HandEntry entry_;
  Diagnostics findings_;
  std::map<std::string, std::string> reasons_;  // why a name of the entry has no value
};

void EntryElaborator::elaborate(const HandItemAst& item) {
  switch (item.kind) {
    case Kind::assume: return assume(item);
    case Kind::let: return let(item);
    case Kind::free: return free(item);
    case Kind::rows: return rows(item);
    case Kind::quantity:
    case Kind::lambda: return quantity(item);
    case Kind::update: return update(item);
    case Kind::bound: return bound(item);
    case Kind::claim: return claim(item);
  }
}

void EntryElaborator::begin_part(std::vector<std::string> rows) {
  names_.begin_part(rows);
  entry_.parts.push_back({std::move(rows), {}});
}

Value EntryElaborator::evaluate(const Ast& ast, bool rows_of_J) {
  Evaluator evaluator(pool_, names_, diagnostics_, findings_);
  if (rows_of_J) evaluator.expect_columns(widths_of_J());
  Value v = evaluator(ast);
  if (v.type != Type::body && v.type != Type::frame) return v;
  findings_.error(ast.where, std::string(in_words(v.type)) + " is not a quantity");
  return {};
}

// The reason for a missing value: the last error among the findings since then, or the problem of a name in it.
std::string EntryElaborator::problem(const Ast& ast, std::size_t since) const {
  for (std::size_t i = findings_.list.size(); i-- > since;) {
    const Diagnostic& d = findings_.list[i];
    if (d.severity != Severity::error) continue;
    const auto length = static_cast<std::size_t>(d.where.end - d.where.begin);
    const std::string_view text = file_.file->text;
    return d.message + ": " + quote(text.substr(static_cast<std::size_t>(d.where.begin), length));
  }
  if (ast.kind == Ast::Kind::name) {
    const auto reason = reasons_.find(ast.text);
    return reason == reasons_.end() ? "" : reason->second;
  }
  for (const Ast& a : ast.args)
    if (const std::string reason = problem(a, findings()); !reason.empty()) return reason;
  return {};
}

void EntryElaborator::store(const Value& v, std::optional<Matrix>& matrix, Expr& expression) {
  if (v.type == Type::scalar || v.type == Type::vector || v.type == Type::point) expression = v.e;
  if (v.type == Type::poison) return;
  matrix = as_matrix(v);
  if (!matrix->any_size()) return;
  const Expr diagonal = matrix->entries[0];
  const int n = pool_.dimension();
  matrix = Matrix{n, n, {}};
  for (int i = 0; i < n * n; ++i) matrix->entries.push_back(i % (n + 1) == 0 ? diagonal : pool_.number(0));
}

HandItem EntryElaborator::begin(const HandItemAst& item, HandItem::Kind kind) const {
  HandItem out;
  out.kind = kind;
  out.what = item.word.text;
  out.where = item.where;
  out.text = item.text;
  return out;
}

// let NAME = expression
void EntryElaborator::let(const HandItemAst& item) {
  const std::size_t before = findings();
  Value v = evaluate(item.right);
  if (v.type == Type::poison) reasons_[item.word.text] = problem(item.right, before);
  if (v.type == Type::point) v = vector(v.e, v.unit);
  if (v.zero) v.unit.reset();
  v.zero = false;
  if (!names_.is_free(item.word, diagnostics_)) return;
  if (v.type == Type::scalar || v.type == Type::vector) pool_.name(v.e, item.word.text, true);
  names_.define(item.word.text, v);
}

void EntryElaborator::free(const HandItemAst& item) {
  for (const Word& word : item.names) {
    if (word.text.empty() || !names_.is_free(word, diagnostics_)) continue;
    entry_.free.push_back(word.text);
    names_.define(word.text, scalar(pool_.symbol(word.text, Role::given), {}));
  }
}

void EntryElaborator::rows(const HandItemAst& item) {
  std::vector<std::string> names, known;
  for (const Row& r : joint_.rows) known.push_back(r.name);
  for (const Coordinate& c : joint_.coordinates) known.push_back(c.name);
  for (const Word& word : item.names) {
    const bool of_row = std::ranges::any_of(joint_.rows, [&](const Row& row) { return is_named(row, word.text); });
    if (of_row || std::find(known.begin(), known.end(), word.text) != known.end()) {
      names.push_back(word.text);
      continue;
    }
    const std::string near = nearest(word.text, known);
    std::string all;
    for (const std::string& k : known) all += (all.empty() ? "" : ", ") + k;
    diagnostics_.error(word.where, "the joint has no row or coordinate " + quote(word.text),
                       near.empty() ? "it has " + all : "did you mean " + quote(near) + "?");
  }
  if (names.size() == item.names.size()) begin_part(std::move(names));
}

void EntryElaborator::assume(const HandItemAst& item) {
  HandAssumption a;
  a.where = item.where;
  a.text = item.text;
  if (!item.body.text.empty()) {
    const bool known_body = item.body.text == "world" || names_.body(item.body.text) >= 0;
    if (!known_body)
      diagnostics_.error(item.body.where, "the joint has no body " + quote(item.body.text), names_.bodies());
    const auto parameter = std::find_if(joint_.parameters.begin(), joint_.parameters.end(),
                                        [&](const Parameter& p) { return p.name == item.word.text; });
    const bool placed = parameter != joint_.parameters.end() && parameter->kind != ParameterKind::scalar;
    if (!item.flag && !placed)
      diagnostics_.error(item.word.where, "the spec has no point or direction " + quote(item.word.text),
                         "only the spec's parameters can be fixed elsewhere");
    return entry_.assumptions.push_back(std::move(a));
  }
  store(evaluate(item.left), a.left, a.left_expression);
  store(evaluate(item.right), a.right, a.right_expression);
  entry_.assumptions.push_back(std::move(a));
}

// C, Cdot, J, K, b or lambda = expression
void EntryElaborator::quantity(const HandItemAst& item) {
  const bool lambda = item.kind == Kind::lambda;
  if (is_of_law(item.word.text) && (!joint_.law || joint_.law->inputs.empty()))
    diagnostics_.error(item.word.where, quote(item.word.text) +
                                            " is a quantity of an effect with a law of forces, and " +
                                            quote(joint_.name) + " has none");
  HandItem out = begin(item, lambda ? HandItem::Kind::lambda : HandItem::Kind::quantity);
  const std::size_t before = findings();
  const Value v = evaluate(item.right, item.word.text == "J");
  if (v.type == Type::poison) {
    out.problem = reasons_[item.word.text] = problem(item.right, before);
    out.readings = readings(item.right);
  }
  store(v, out.value, out.expression);
  if (item.word.text != "b") names_.say(item.word.text, v);
  entry_.parts.back().items.push_back(std::move(out));
}

std::vector<HandReading> EntryElaborator::readings(const Ast& ast) {
  std::vector<HandReading> found;
  for (const OtherAst& other : with_velocities_exchanged(ast)) {
    std::optional<Matrix> value;
    Expr expression;
    store(evaluate(other.ast), value, expression);
    if (value) found.push_back({other.words, other.column, *value});
  }
  return found;
}

void EntryElaborator::update(const HandItemAst& item) {
  HandItem out = begin(item, HandItem::Kind::update);
  out.target = item.word.text == "v"   ? HandItem::Target::velocity
               : item.word.text == "w" ? HandItem::Target::spin
               : item.word.text == "x" ? HandItem::Target::position
                                       : HandItem::Target::angle;
  out.body = names_.body(item.body.text);
  if (out.body < 0)
    return diagnostics_.error(item.body.where, "the joint has no body " + quote(item.body.text), names_.bodies());
  const std::size_t before = findings();
  const Value v = evaluate(item.right);
  store(v, out.value, out.expression);
  const bool linear = item.word.text == "v" || item.word.text == "x";
  const int rows = linear || pool_.dimension() == 3 ? pool_.dimension() : 1;
  if (v.type == Type::poison) out.problem = problem(item.right, before);
  else if (out.value->rows != rows || out.value->columns != 1) {
    out.problem = std::string(in_words(v.type)) + " is added to " + (rows > 1 ? "a vector" : "a number");
    out.value.reset();
  }
  if (item.flag && out.value) {
    for (Expr& e : out.value->entries) e = -e;
    if (out.expression) out.expression = -out.expression;
  }
  entry_.parts.back().items.push_back(std::move(out));
}

void EntryElaborator::bound(const HandItemAst& item) {
  HandItem out = begin(item, HandItem::Kind::bound);
  out.pushes_only = item.flag;
  entry_.parts.back().items.push_back(std::move(out));
}

void EntryElaborator::claim(const HandItemAst& item) {
  HandItem out = begin(item, HandItem::Kind::claim);
  const bool J = item.word.text == "J";
  const std::size_t before = findings();
  const Value left = evaluate(item.left, J), right = evaluate(item.right, J);
  if (!same_unit(left, right, true))
    findings_.warning(item.right.where, "equates " + spoken(*left.unit) + " and " + spoken(*right.unit), "",
                      {item.left.where});
  store(left, out.value, out.expression);
  store(right, out.right, out.right_expression);
  if (!out.value || !out.right) out.problem = problem(out.value ? item.right : item.left, before);
  entry_.parts.back().items.push_back(std::move(out));
}

}  // namespace

HandEntry elaborate_entry(const HandEntryAst& entry, const HandFile& file, const ReadResult& joint,
                          const GeneratedRows& generated, Diagnostics& diagnostics) {
  return EntryElaborator(entry, file, joint, generated, diagnostics).run();
}

}  // namespace cdot::derive
